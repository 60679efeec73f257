"""Bounded Gauss-Newton fit (trust region, reflective) from several starts.

The model is retrained around the fitted values where they reach the edge of its training range, or
where its certified error is not small compared with the meter's error.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import least_squares

from ..arrays import Complex, Mask, Real
from ..fem.factors import one_blas_thread
from ..models.cosine_modes import with_foam_modes, with_sheet_modes
from ..models.parameters import parts_with
from ..press.batch import TouchedCells
from ..progress import ProgressCallback, silent
from ..scene.meter import Readout
from ..scene.parts import SceneParts, Skin
from ..sweeps import InputError
from .fit_options import FitSpec
from .measurements import Measurements
from .problem import CenteredModel, LeastSquaresProblem, centered_model, trainable_factors

Residuals = Callable[[Real], Real]
ROUNDS = 10
EDGE = 0.02
NEAR = 0.1
"""Distances of the logarithm of a factor. EDGE: a value this close to the end of its range is at
its limit. NEAR: retraining this close to the center of the model does not improve it."""
SHARE_OF_NOISE = 0.03
"""Model tolerance over the meter's noise."""
SMALL_AGAINST_NOISE = 0.2
"""Largest certified error of the model at the solution, over the meter's noise."""
CERTIFIED_PRESSES = 8
EXPLAINED = 2.0
"""Chi-squared per number, below which no other start is tried."""
FINEST, COARSEST = 1e-6, 1e-3
CLOSE = 1e-8
MAX_STEPS = 300
INSIDE = 1e-2
"""Smallest distance of an initial unknown from its bound, in standard deviations of its prior: the
solver does not leave a bound that it begins at."""
AT_BOUND = 1e-6
"""Distance in standard deviations of its prior within which an unknown is at its bound."""


@dataclass(frozen=True)
class Fit:
    """A solution of the least-squares problem.

    u: unknowns of the problem. certificate: largest bound on the model's error of Rs and Cp.
    trained: number of times the model was retrained.
    """

    problem: LeastSquaresProblem = field(repr=False)
    u: Real
    certificate: float = 0.0
    trained: int = 0

    @property
    def spec(self) -> FitSpec:
        """The fitted parameters and the measurements."""
        return self.problem.spec

    @property
    def values(self) -> dict[str, float]:
        """Values of all parameters."""
        return self.spec.values(self.u)

    @property
    def cost(self) -> float:
        """The minimized sum: chi-squared and the priors of the parameters."""
        residuals = self.problem.reduced_system(self.u)[0]
        return float(residuals @ residuals)

    @property
    def chi_squared(self) -> float:
        """Chi-squared of all readings.

        It includes the priors of strengths and of the meter's fixed errors, not of parameters.
        Student's t errors weight the readings.
        """
        others, squares = self.u[len(self.spec.fitted) :], self.problem.squares(self.u)
        if self.spec.tail is not None:
            squares = self.spec.tail.weights(squares) * squares
        return float(squares.sum() + others @ others)

    @property
    def rms_error(self) -> float:
        """Rms error of Z or gain relative to its magnitude, without the meter's fixed errors."""
        measured = np.stack([reading.Z for reading in self.spec.measurements.sweeps])
        fitted = self.problem.fitted(self.u)
        if self.spec.measurements.per_reading == 1:
            fitted = np.abs(fitted)
        error = np.abs(fitted / measured - 1)
        return float(np.sqrt(np.mean(error[:, self.spec.measurements.read] ** 2)))


def fitted_parts(parts: SceneParts, values: Mapping[str, float]) -> SceneParts:
    """The parts with the fitted parameters, and with the cosine modes as maps."""
    found = parts_with(parts, values)
    skin = with_sheet_modes(with_foam_modes(found.skin, values), values)
    return replace(found, skin=skin)


def model_tolerance(readout: Readout) -> float:
    """Required tolerance of the model for Rs and Cp."""
    return float(np.clip(SHARE_OF_NOISE * readout.smallest_noise, FINEST, COARSEST))


def best_fit(
    spec: FitSpec,
    model: CenteredModel,
    begin: Mapping[str, float] | None = None,
    progress: ProgressCallback = silent,
) -> Fit:
    """The best fit, with retraining of the model where needed.

    model: the first model. begin: initial values, instead of several starts. Raises InputError
    where the factors do not converge.
    """
    with one_blas_thread():
        for trained in range(ROUNDS):
            problem = LeastSquaresProblem(spec, model)
            begins = initial_values(problem) if begin is None else [begin]
            fit = best_of_starts(problem, begins, progress)
            certificate = largest_certificate(fit)
            if not at_reach_limit(fit) and (
                certificate <= certificate_limit(spec) or trained_nearby(fit)
            ):
                return Fit(problem, fit.u, certificate, trained)
            begin = fit.values
            progress(_retraining_reason(fit, certificate))
            rtol = model_tolerance(spec.readout)
            model = centered_model(spec.measurements.parts, begin, rtol, progress, model.uneven)
    name = spec.measurements.parts.skin.name
    raise InputError(f"{name} differs too much from the measured skin: the fit does not converge")


def best_of_starts(
    problem: LeastSquaresProblem,
    begins: Sequence[Mapping[str, float]],
    progress: ProgressCallback = silent,
) -> Fit:
    """The best of fits from several starts. One that explains the readings ends the search."""
    fits: list[Fit] = []
    for begin in begins:
        fits.append(solve_from(problem, begin, progress))
        if fits[-1].chi_squared < EXPLAINED * problem.spec.measurements.numbers:
            break
    return min(fits, key=lambda fit: fit.cost)


def solve_from(
    problem: LeastSquaresProblem,
    begin: Mapping[str, float],
    progress: ProgressCallback = silent,
    steps: int = MAX_STEPS,
) -> Fit:
    """Fit from one start, within the range of the model. steps: largest number of evaluations."""
    low, high = problem.bounds()
    inside = np.minimum(INSIDE, (high - low) / 4)
    u = np.clip(problem.spec.unknowns(begin), low + inside, high - inside)
    if not len(u):
        return Fit(problem, u)

    def residuals(u: Real) -> Real:
        return problem.reduced_system(u)[0]

    def slopes(u: Real) -> Real:
        return problem.reduced_system(u)[1]

    exact: Any = slopes
    solution = least_squares(
        _with_progress(residuals, progress),
        u,
        exact,
        bounds=(low, high),
        method="trf",
        x_scale="jac",
        ftol=CLOSE,
        xtol=CLOSE,
        gtol=CLOSE,
        max_nfev=steps,
    )
    return Fit(problem, np.where(solution.x - low < AT_BOUND, low, solution.x))


def _with_progress(residuals: Residuals, progress: ProgressCallback) -> Residuals:
    """Residuals that also report progress, by the relative change of the sum of squares."""
    before, share = np.inf, 0.0

    def reporting(u: Real) -> Real:
        nonlocal before, share
        r = residuals(u)
        cost = float(r @ r)
        step = abs(before - cost) / max(cost, np.finfo(float).tiny)
        share = max(share, float(np.clip(np.log(max(step, CLOSE)) / np.log(CLOSE), 0.0, 1.0)))
        before = cost
        progress("fitting", share)
        return r

    return reporting


def at_reach_limit(fit: Fit) -> list[str]:
    """Factors that are at the limit of the model's training range."""
    model = fit.problem.model
    return [
        name
        for name in trainable_factors(
            fit.spec.measurements.parts.skin, fit.spec.measurements.parts.setup
        )
        if name in fit.spec.names
        and abs(fit.values[name] - model.center[name]) > model.reach(name) - EDGE
    ]


def trained_nearby(fit: Fit) -> bool:
    """True if the model was trained so close to the solution that retraining does not help."""
    center = fit.problem.model.center
    return all(abs(fit.values[name] - at) < NEAR for name, at in center.items())


def certificate_limit(spec: FitSpec) -> float:
    """Largest allowed error of the model for Rs and Cp."""
    return SMALL_AGAINST_NOISE * max(spec.readout.smallest_noise, FINEST / SHARE_OF_NOISE)


def largest_certificate(fit: Fit) -> float:
    """Largest certified error of the model over the first CERTIFIED_PRESSES presses."""
    problem, values = fit.problem, fit.values
    share = fit.spec.share_of_rises(fit.u)
    presses = (
        TouchedCells(cells, share * problem.rises(fit.u, k))
        for k, (cells, _) in enumerate(problem.cells[:CERTIFIED_PRESSES])
    )
    found = (problem.model.slopes(press, values, certify=True).error for press in presses)
    return max(error for error in found if error is not None)


def _retraining_reason(fit: Fit, certificate: float) -> str:
    edge = at_reach_limit(fit)
    why = (
        f"{', '.join(edge)} beyond the training range of the model"
        if edge
        else f"the model's error there is up to {certificate:.1e}"
    )
    return f"{why}: retraining it around the fitted values"


SHARES = (0.03, 0.1, 0.3, 1.0)
"""Shares of the largest measured resistance that may be the skin's and not the leads'."""
LOW_FREQUENCY = 3.0
"""Resistance of a line over its Rs at low frequency."""
STEPS = (0.0, -0.5, 0.5)
NEAR_CENTER = 1000.0
"""Chi-squared per number, below which a fit begins at the center of its model."""
FAR = math.log(2)
MIN_INDUCTANCE_SHARE = 1e-4
LOSSY = 0.95


def initial_values(problem: LeastSquaresProblem) -> list[dict[str, float]]:
    """Initial values of all parameters: several for a line, else the best of a coarse grid.

    Evaluating the grid costs less than one fit with a reduced model.
    """
    spec, model = problem.spec, problem.model
    own = spec.values(spec.unknowns({n: p.center for n, p in spec.fitted.items()}))
    if model.unlimited and not spec.measurements.parts.setup.gain:
        return [own, *({**own, **_fitted_only(spec, each)} for each in _of_line(spec))]
    begin = own | {name: at for name, at in model.center.items() if name in spec.fitted}
    if _misfit(problem, begin) < NEAR_CENTER * spec.measurements.numbers:
        return [begin]
    return [min(_grid(begin, spec), key=lambda values: _misfit(problem, values))]


def _grid(values: Mapping[str, float], spec: FitSpec) -> list[dict[str, float]]:
    """Steps up and down of the sheets and of the foam, the values themselves first."""
    steps = [
        STEPS if name in spec.fitted else (0.0,) for name in ("sheet_resistance", "capacitance")
    ]
    return [
        {
            **values,
            "sheet_resistance": values["sheet_resistance"] + sheets,
            "capacitance": values["capacitance"] + foam,
        }
        for sheets, foam in itertools.product(*steps)
    ]


def _misfit(problem: LeastSquaresProblem, values: Mapping[str, float]) -> float:
    residuals = problem.residuals(problem.spec.unknowns(values))
    return float(residuals @ residuals)


def capacitance_offset(measured: Measurements) -> float:
    """Logarithm of the capacitance at the lowest frequency over the scene's; 0 where near."""
    frequency, Z = measured.first
    if measured.parts.setup.gain or Z.imag[0] >= 0:
        return 0.0
    shown = -1 / (2 * np.pi * frequency[0] * Z.imag[0])
    offset = math.log(shown / total_capacitance(measured.parts.skin))
    return offset if abs(offset) > FAR else 0.0


def total_capacitance(skin: Skin) -> float:
    """Capacitance of the unpressed skin, F."""
    return skin.foam.unpressed_capacitance_per_area * skin.length * skin.width


def _fitted_only(spec: FitSpec, values: Mapping[str, float]) -> dict[str, float]:
    return {name: value for name, value in values.items() if name in spec.fitted}


def _of_line(spec: FitSpec) -> list[dict[str, float]]:
    """Initial values of a line, with shares of the resistance from little to all of it."""
    scene, (frequency, Z) = spec.measurements.parts, spec.measurements.first
    omega = 2 * np.pi * frequency
    total, floor = float(Z.real.max()), float(np.abs(Z.real).min())
    skin, edge = scene.skin, scene.skin.contacts[0].edge
    squares = skin.length / skin.width if edge in ("left", "right") else skin.width / skin.length
    sheets = skin.both_sheets * squares
    shown = abs(1 / (omega[0] * Z.imag[0]))
    inductance = max(float(Z.imag[-1]), MIN_INDUCTANCE_SHARE * abs(Z[-1])) / omega[-1]
    return [
        {
            "sheet_resistance": math.log(LOW_FREQUENCY * share * total / sheets),
            "capacitance": math.log(shown / total_capacitance(scene.skin)),
            "lead_resistance": floor / 2,
            "lead_inductance": float(inductance),
            "phase_exponent": exponent,
        }
        for share in SHARES
        for exponent in (1.0, LOSSY)
    ]


class Step(NamedTuple):
    """The amplitude of a change of ln Z that fits best, and the share of chi-squared it leaves."""

    amplitude: float
    left: float


class LinearSteps:
    """Linear fits of a change of the readings along with all unknowns, at a solution.

    Unknowns at a bound stay there. Student's t errors weight the readings as at the solution.
    """

    def __init__(self, fit: Fit, used: Mask | None = None) -> None:
        """used: sweeps that count, shape (sweep,); by default all."""
        problem, u, spec = fit.problem, fit.u, fit.spec
        self._problem = problem
        r, J, squares = problem.residuals(u), problem.jacobian(u), problem.all_squares(u)
        weights = np.ones(squares.shape) if spec.tail is None else spec.tail.weights(squares)
        if used is not None:
            weights = weights * used[:, None]
        self._root = np.concatenate([np.sqrt(np.tile(weights, 2)).ravel(), np.ones(len(u))])
        low, high = problem.bounds()
        inside = (u > low) & (u < high)
        self._basis = np.linalg.qr((self._root[:, None] * J)[:, inside])[0]
        self._counted = np.ones(len(r), dtype=np.bool_)
        first = len(r) - len(u)
        self._counted[first : first + len(spec.fitted)] = False
        self._r = self._free(self._root * r)

    def step(self, change: Complex, low: float = 0.0, high: float = np.inf) -> Step:
        """The best step. change: of ln Z for an amplitude of 1, broadcast to (sweep, interface,
        frequency). low, high: limits of the amplitude."""
        d = np.zeros(len(self._r))
        whitened = self._problem.whitened(change).ravel()
        d[: len(whitened)] = whitened
        d = self._free(self._root * d)
        size = float(d @ d)
        amplitude = float(np.clip(-(d @ self._r) / size, low, high)) if size else low
        after, before = (self._r + amplitude * d)[self._counted], self._r[self._counted]
        return Step(amplitude, float(after @ after) / float(before @ before))

    def _free(self, change: np.ndarray) -> np.ndarray:
        """What no change of the other unknowns removes."""
        return change - self._basis @ (self._basis.T @ change)

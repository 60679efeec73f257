"""Bounded Gauss-Newton fit (trust region, reflective) from several starts.

The model is retrained around the fitted values where they reach the edge of its training range, or
where its certified error is not small compared with the meter's error.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from ...arrays import Real
from ...fem.factors import one_blas_thread
from ...models.cosine_modes import with_foam_modes, with_sheet_modes
from ...models.parameters import parts_with
from ...progress import ProgressCallback, silent
from ...scene.meter import Readout
from ...scene.parts import SceneParts
from ...sweeps import InputError
from .centered_model import CenteredModel, centered_model, trainable_factors
from .fit_options import FitSpec
from .initial_values import initial_values
from .problem import LeastSquaresProblem

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
    return max(
        problem.model.certificate(cells, share * problem.rises(fit.u, k), values)
        for k, (cells, _) in enumerate(problem.cells[:CERTIFIED_PRESSES])
    )


def _retraining_reason(fit: Fit, certificate: float) -> str:
    edge = at_reach_limit(fit)
    why = (
        f"{', '.join(edge)} beyond the training range of the model"
        if edge
        else f"the model's error there is up to {certificate:.1e}"
    )
    return f"{why}: retraining it around the fitted values"

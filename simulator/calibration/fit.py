"""Gauss-Newton within bounds, reflected off them, from several starts and within the model's reach.

Where the fitted factors reach the edge of what the model was trained on, or its certificate is no
longer small beside the meter's error, the model is trained anew about the fitted values.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from ..fem.factors import one_blas_thread
from ..progress import ProgressCallback, silent
from ..scene.meter import Readout
from ..sweeps import InputError
from .centered_model import Around, around, movable
from .initial_values import initial_values
from .problem import FitSpec, LeastSquaresProblem

Residuals = Callable[[NDArray[np.float64]], NDArray[np.float64]]
ROUNDS = 10
EDGE = 0.02
NEAR = 0.1
"""Of the logarithm of a factor: so near the edge of its reach a value is held by it; so near where
the model was trained, training it there again helps nothing."""
SHARE_OF_NOISE = 0.03
"""Of the meter's noise: asked of the model."""
SMALL_BESIDE_NOISE = 0.2
"""Of the meter's noise: what the certificate of the model may be at the solution."""
CERTIFIED_PRESSES = 8
EXPLAINED = 2.0
"""Chi-squared over how many numbers there are, below which no other start is tried."""
FINEST, COARSEST = 1e-6, 1e-3
CLOSE = 1e-8
MAX_STEPS = 300
INSIDE = 1e-2
"""Deviations of its prior from a bound that an unknown begins at; from the bound it does not go."""
AT_BOUND = 1e-6
"""Deviations of its prior within which an unknown is at its bound."""


@dataclass(frozen=True)
class Fit:
    """A solution.

    u: unknowns of the problem. chi_squared: with the priors of strengths and of the meter's fixed
    errors, which the data share, and without those of the parameters. certificate: largest bound
    on what the model leaves out of Rs and Cp. trained: how often it was trained anew.
    """

    problem: LeastSquaresProblem = field(repr=False)
    u: NDArray[np.float64]
    certificate: float = 0.0
    trained: int = 0

    @property
    def spec(self) -> FitSpec:
        """What was fitted to what."""
        return self.problem.spec

    @property
    def values(self) -> dict[str, float]:
        """All parameters."""
        return self.spec.values(self.u)

    @property
    def cost(self) -> float:
        """What is least: chi-squared and the priors of the parameters."""
        residuals = self.problem.residuals(self.u)
        return float(residuals @ residuals)

    @property
    def chi_squared(self) -> float:
        """Of all readings."""
        of_parameters = self.u[: len(self.spec.fitted)]
        residuals = self.problem.residuals(self.u)
        return float(residuals @ residuals - of_parameters @ of_parameters)

    @property
    def rms_error(self) -> float:
        """Of Z, relative to |Z|, without the meter's fixed errors."""
        measured = np.stack([reading.Z for reading in self.spec.measurements.sweeps])
        off = np.abs(self.problem.fitted(self.u) / measured - 1)
        return float(np.sqrt(np.mean(off[:, self.spec.measurements.read] ** 2)))


def model_tolerance(readout: Readout) -> float:
    """Of Rs and Cp, asked of the model."""
    noise = min(readout.magnitude_noise, readout.phase_noise)
    return float(np.clip(SHARE_OF_NOISE * noise, FINEST, COARSEST))


def best_fit(
    spec: FitSpec,
    model: Around,
    begin: Mapping[str, float] | None = None,
    progress: ProgressCallback = silent,
) -> Fit:
    """The best fit. ready: a model to begin with. begin: values to begin at, in place of several.

    Raises InputError where the factors go on and on.
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
            model = around(spec.measurements.scene, begin, rtol, progress, model.uneven)
    raise InputError(
        f"{spec.measurements.scene.name} is too unlike what was measured: its factors run away"
    )


def best_of_starts(
    problem: LeastSquaresProblem,
    begins: Sequence[Mapping[str, float]],
    progress: ProgressCallback = silent,
) -> Fit:
    """From several starts, as many as it takes to explain the readings."""
    fits: list[Fit] = []
    for begin in begins:
        fits.append(solve_from(problem, begin, progress))
        if fits[-1].chi_squared < EXPLAINED * problem.spec.measurements.numbers:
            break
    return min(fits, key=lambda fit: fit.cost)


def solve_from(
    problem: LeastSquaresProblem, begin: Mapping[str, float], progress: ProgressCallback = silent
) -> Fit:
    """From one start, within the model's reach."""
    low, high = problem.bounds()
    inside = np.minimum(INSIDE, (high - low) / 4)
    u = np.clip(problem.spec.unknowns(begin), low + inside, high - inside)
    if not len(u):
        return Fit(problem, u)

    def residuals(u: NDArray[np.float64]) -> NDArray[np.float64]:
        return problem.condensed(u)[0]

    def slopes(u: NDArray[np.float64]) -> NDArray[np.float64]:
        return problem.condensed(u)[1]

    exact: Any = slopes
    found = least_squares(
        _with_progress(residuals, progress),
        u,
        exact,
        bounds=(low, high),
        method="trf",
        x_scale="jac",
        ftol=CLOSE,
        xtol=CLOSE,
        gtol=CLOSE,
        max_nfev=MAX_STEPS,
    )
    return Fit(problem, np.where(found.x - low < AT_BOUND, low, found.x))


def _with_progress(residuals: Residuals, progress: ProgressCallback) -> Residuals:
    """The same, telling how much nearer the fit is to where its sum of squares stays as it is."""
    before, share = np.inf, 0.0

    def watched(u: NDArray[np.float64]) -> NDArray[np.float64]:
        nonlocal before, share
        found = residuals(u)
        cost = float(found @ found)
        step = abs(before - cost) / max(cost, np.finfo(float).tiny)
        share = max(share, float(np.clip(np.log(max(step, CLOSE)) / np.log(CLOSE), 0.0, 1.0)))
        before = cost
        progress("fitting", share)
        return found

    return watched


def at_reach_limit(fit: Fit) -> list[str]:
    """Factors that only the model's reach keeps where they are."""
    around = fit.problem.around
    return [
        name
        for name in movable(fit.spec.measurements.scene)
        if name in fit.spec.names
        and abs(fit.values[name] - around.about[name]) > around.reach(name) - EDGE
    ]


def trained_nearby(fit: Fit) -> bool:
    """Whether the model was trained about the solution, as far as that helps."""
    about = fit.problem.around.about
    return all(abs(fit.values[name] - at) < NEAR for name, at in about.items())


def certificate_limit(spec: FitSpec) -> float:
    """What the model may leave out of Rs and Cp."""
    noise = min(spec.readout.magnitude_noise, spec.readout.phase_noise)
    return SMALL_BESIDE_NOISE * max(noise, FINEST / SHARE_OF_NOISE)


def largest_certificate(fit: Fit) -> float:
    """Largest bound on what the model leaves out, over the first presses."""
    problem, values = fit.problem, fit.values
    return max(
        problem.around.certificate(cells, problem.rises(fit.u, k), values)
        for k, (cells, _) in enumerate(problem.cells[:CERTIFIED_PRESSES])
    )


def _retraining_reason(fit: Fit, certificate: float) -> str:
    edge = at_reach_limit(fit)
    why = (
        f"{', '.join(edge)} beyond the model's reach"
        if edge
        else f"the model leaves out up to {certificate:.1e} there"
    )
    return f"{why}: training it anew about the fitted values"

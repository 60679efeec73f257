"""Trial fits of physics that a scene lacks, where the best fit leaves structure in its residuals.

Noise is independent from one frequency to the next. Residuals that are not have a cause that the
model lacks.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Literal

import numpy as np

from ..arrays import Complex
from ..models.line import tanh_ratio, tanh_ratio_slope
from ..models.parameters import loss_of
from ..models.solution import Response
from ..press.batch import PressBatch, TouchedCells
from ..progress import ProgressCallback, silent
from ..scene.frequency import LOSSLESS, Loss, laplace_variable
from ..sweeps.errors import named
from ..sweeps.units import prefixed
from .fit import EXPLAINED, Fit, LinearSteps, solve_from
from .prior import Noise, Prior, effect_prior
from .problem import CenteredModel, LeastSquaresProblem
from .residual_correlation import neighbour_correlation
from .surroundings_trials import trial_remarks

RESISTANCE, CAPACITANCE = "element_resistance", "element_capacitance"
"""Logarithms of the element's resistance in ohm and capacitance in F, as parameters."""

Element = Literal["line", "film"]


class WithSeriesElement(CenteredModel):
    """A fitted model behind one more element.

    A line, open at its end, has Z = R / (w T(w)), T(q²) = tanh(q)/q, w = s R C, with the losses of
    the foam. A film has Z = R / (1 + j omega R C).
    """

    def __init__(self, inner: CenteredModel, element: Element, loss: Loss) -> None:
        super().__init__(inner.model, inner.center, inner.uneven)
        self._element = element
        frequency = inner.model.setup.frequency
        self._s = laplace_variable(frequency, loss if element == "line" else LOSSLESS)

    def own(self, values: Mapping[str, float]) -> dict[str, float]:
        """Values of the scene's parameters, without those of the element."""
        scene = {name: at for name, at in values.items() if name not in (RESISTANCE, CAPACITANCE)}
        return super().own(scene)

    def slopes(
        self,
        presses: TouchedCells | PressBatch,
        values: Mapping[str, float],
        certify: bool = False,
    ) -> Response:
        """See `CenteredModel.slopes`."""
        response = super().slopes(presses, values, certify)
        R, C = np.exp(values[RESISTANCE]), np.exp(values[CAPACITANCE])
        Z, by_resistance, by_capacitance = self._with_slopes(R, C)
        slopes = {
            RESISTANCE: np.broadcast_to(by_resistance, response.Z.shape),
            CAPACITANCE: np.broadcast_to(by_capacitance, response.Z.shape),
        }
        by_parameter = {**response.by_parameter, **slopes}
        return replace(response, Z=response.Z + Z, by_parameter=by_parameter)

    def added(self, R: float, C: float) -> Complex:
        """Z of the element in ohm, shape (frequency,). R: ohm. C: F."""
        return self._with_slopes(R, C)[0]

    def _with_slopes(self, R: float, C: float) -> tuple[Complex, ...]:
        """Z of the element in ohm, and its derivatives by both parameters; (frequency,)."""
        w = self._s * R * C
        if self._element == "film":
            Z = R / (1 + w)
            return Z, Z / (1 + w), -Z * w / (1 + w)
        T = tanh_ratio(w)
        Z = R / (w * T)
        by_w = -Z * (1 + w * tanh_ratio_slope(w, T) / T)
        return Z, Z + by_w, by_w


STRUCTURED = 0.5
"""Correlation of residuals at neighbouring frequencies from which a fit leaves structure."""
SLOPE = 0.1
"""Prior standard deviation of the change of the exponent in a decade."""
SMALLEST = 1e-3
"""Smallest initial resistance of an element in series, over the smallest |Z|."""
CORNERS = 12
"""Corner frequencies from which a trial of an element may begin."""
STEPS, FEW = 16, 3
"""Evaluations of a trial, which begins near its solution: of the exact line, of a reduced model."""
ELEMENTS: Mapping[Element, str] = {
    "line": "a second line in series",
    "film": "a film in series",
}


def misfit_trials(
    fit: Fit, freedom: float, noise: Noise, progress: ProgressCallback = silent
) -> list[str]:
    """Remarks on physics that the scene lacks and that would explain the remaining misfit."""
    surroundings = [] if noise.guessed else trial_remarks(fit, freedom, progress)
    return [*surroundings, *physics_remarks(fit, freedom, noise.stated)]


def physics_remarks(fit: Fit, freedom: float, stated: bool) -> list[str]:
    """A remark on the structure in the residuals, and on what each trial leaves of chi-squared.

    freedom: degrees of freedom of the fit. stated: True if the noise is known, so that a fit may
    explain the readings although its residuals are correlated. Empty without structure.
    """
    correlation = neighbour_correlation(fit)
    explained = stated and fit.chi_squared < EXPLAINED * freedom
    if correlation < STRUCTURED or explained:
        return []
    elements = () if fit.spec.measurements.parts.setup.gain else ELEMENTS
    trials = [*_losses(fit), *(_element(fit, each) for each in elements)]
    if not trials:
        return []
    left = {text: min(1.0, each.chi_squared / fit.chi_squared) for text, each in trials}
    shares = (
        f"{text} leaves {100 * share:.0f} %" for text, share in sorted(left.items(), key=_share)
    )
    return [
        f"the fit leaves structure: residuals at neighbouring frequencies correlate by "
        f"{correlation:.2f}, and intervals do not include the bias by physics that the scene "
        f"lacks; of chi-squared, in addition, {'; '.join(shares)}"
    ]


def _share(pair: tuple[str, float]) -> float:
    return pair[1]


def _losses(fit: Fit) -> list[tuple[str, Fit]]:
    """Fits with an exponent that depends on frequency, and with a leak, and what was fitted."""
    found = []
    if "phase_exponent" in fit.spec.names:
        slope = _solved(fit, {"exponent_slope": Prior(0.0, SLOPE)}, {"exponent_slope": 0.0})
        change = slope.values["exponent_slope"]
        found.append((f"an exponent that changes by {change:+.2g} in a decade", slope))
    if "leak" not in fit.spec.names:
        leak = _solved(fit, {"leak": effect_prior(fit.spec.measurements, "leak")}, {"leak": 0.0})
        found.append((f"a leak of {leak.values['leak']:.2g} 1/s ({named('also')} leak)", leak))
    return found


def _solved(fit: Fit, priors: Mapping[str, Prior], at: Mapping[str, float]) -> Fit:
    fixed = {name: value for name, value in fit.spec.fixed.items() if name not in priors}
    spec = replace(fit.spec, fitted={**fit.spec.fitted, **priors}, fixed=fixed)
    return solve_from(
        LeastSquaresProblem(spec, fit.problem.model), {**fit.values, **at}, steps=_steps(fit)
    )


def _element(fit: Fit, element: Element) -> tuple[str, Fit]:
    """The fit with an element in series, from the best linear step, and what was fitted."""
    model = WithSeriesElement(fit.problem.model, element, loss_of(fit.values))
    R, C = _best_step(fit, model)
    own = {RESISTANCE: math.log(R), CAPACITANCE: math.log(C)}
    priors = {name: Prior(at, math.log(1e3)) for name, at in own.items()}
    whole = replace(fit.spec, fitted={**fit.spec.fitted, **priors})
    best = solve_from(LeastSquaresProblem(whole, model), {**fit.values, **own}, steps=_steps(fit))
    R, C = (math.exp(best.values[name]) for name in (RESISTANCE, CAPACITANCE))
    return f"{ELEMENTS[element]} of {prefixed(R, 'ohm')} and {prefixed(C, 'F')}", best


def _steps(fit: Fit) -> int:
    return STEPS if fit.problem.model.unlimited else FEW


def _best_step(fit: Fit, model: WithSeriesElement) -> tuple[float, float]:
    """Resistance in ohm and capacitance in F of the element of the best Gauss-Newton step.

    For each corner frequency of a grid over the band, all unknowns and the resistance follow from
    one linear problem. The resistance is at least SMALLEST of |Z|.
    """
    frequency, Z = fit.spec.measurements.first
    smallest = SMALLEST * float(np.abs(Z).min())
    steps, fitted = LinearSteps(fit), fit.problem.fitted(fit.u)
    found: list[tuple[float, float, float]] = []
    for corner in np.geomspace(frequency[0], frequency[-1], CORNERS).tolist():
        RC = 1 / (2 * math.pi * corner)
        R, left = steps.step(model.added(1.0, RC) / fitted, smallest)
        found.append((left, R, RC / R))
    return min(found)[1:]

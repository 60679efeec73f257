"""Explanations of a misfit: single parameters, and the ideal capacitance."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from ..arrays import Complex, Real
from ..fem.factors import one_blas_thread
from ..models.parameters import EFFECTS, own_values
from ..progress import ProgressCallback, silent
from ..scene.parts import SceneParts
from ..sweeps import InputError, ToleranceError
from .command import Options
from .estimates import change_text
from .fit import EXPLAINED, Fit, best_fit, model_tolerance, solve_from
from .fit_options import FitSpec, candidates
from .measurements import measurements_of
from .prior import Prior, effect_prior, noise_of, priors
from .problem import CenteredModel, LeastSquaresProblem, Model, checked_model, difference, model_of
from .surroundings_trials import Trials, addable_effects, effect_text

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class ParameterEffect:
    """Effect of one parameter alone on the misfit.

    value: its best value, as `Forward` counts it. before, after: chi-squared with the scene's value
    and with the best one. description: text of the change, for one of EFFECTS of its best value.
    """

    name: str
    value: float
    before: float
    after: float
    description: str

    @property
    def removed(self) -> float:
        """Share of chi-squared that the parameter removes, from 0 to 1."""
        return max(0.0, 1 - self.after / self.before) if self.before > 0 else 0.0


@dataclass(frozen=True)
class JointEffect:
    """Effect of two parameters together on the misfit.

    names: of the parameters. before, after: see `ParameterEffect`. descriptions: text of each.
    """

    names: tuple[str, str]
    before: float
    after: float
    descriptions: tuple[str, ...]

    @property
    def removed(self) -> float:
        """Share of chi-squared that they remove, from 0 to 1."""
        return max(0.0, 1 - self.after / self.before) if self.before > 0 else 0.0


@dataclass(frozen=True)
class MisfitCauses:
    """Causes of a misfit.

    alone: effect of every parameter that was fitted alone. together: effect of pairs that were
    fitted jointly. Both have the largest effect first. remarks: causes that could not be tried.
    """

    alone: tuple[ParameterEffect, ...] = ()
    together: tuple[JointEffect, ...] = ()
    remarks: tuple[str, ...] = ()


def gap_by_parameter(
    parts: SceneParts,
    sweeps: xr.Dataset,
    options: Options = Options(),  # noqa: B008
    *,
    model: Model | None = None,
    progress: ProgressCallback = silent,
) -> MisfitCauses:
    """Fits every parameter of the scene alone, and the best one jointly with surroundings.

    Strengths of presses and the meter's fixed errors are fitted in all cases, within their own
    spreads. Factors stay within the model's training range. Where there is a misfit, those of
    EFFECTS that the scene lacks are tried too: each alone, and each jointly with the best parameter
    and with the best of EFFECTS. Arguments and errors: see `calibrate`; `options.fit`, where given,
    restricts the parameters.
    """
    data = measurements_of(parts, sweeps, options.frequencies, options.session)
    readout, known = noise_of(data).readout, priors(data, options.prior)
    spec = FitSpec(
        data,
        readout,
        {},
        own_values(data.parts.skin, data.parts.setup),
        not options.fixed_strength,
    )
    own = checked_model(model, data.parts.skin, data.parts.setup) if model else None
    centered = CenteredModel(own or model_of(data.parts, model_tolerance(readout), progress), {})
    unknown = candidates(data, centered.model.free, known, options.fit, options.fix)
    names = unknown.fitted if options.fit else [*unknown.fitted, *unknown.not_fitted]
    with one_blas_thread():
        before = solve_from(LeastSquaresProblem(spec, centered), spec.fixed).chi_squared
        alone = [_alone(spec, centered, name, known[name], before) for name in names]
        if (
            options.fit
            or before <= EXPLAINED * data.numbers
            or not addable_effects(data.parts.skin)
        ):
            return MisfitCauses(_ordered(alone))
        try:
            trials = Trials(spec, {}, progress)
            alone = _ordered([*alone, *_surroundings_effects(trials, before)])
            return MisfitCauses(alone, _together(trials, alone, known, data.numbers))
        except (InputError, ToleranceError) as error:
            return MisfitCauses(
                _ordered(alone), (), (f"surroundings of the skin were not tried: {error}",)
            )


Effect = TypeVar("Effect", ParameterEffect, JointEffect)


def _ordered(found: Sequence[Effect]) -> tuple[Effect, ...]:
    return tuple(sorted(found, key=lambda each: each.after))


def _surroundings_effects(trials: Trials, before: float) -> list[ParameterEffect]:
    """Effect on the misfit of each of EFFECTS that the scene lacks."""
    fits = {name: trials.fit(name) for name in trials.names}
    return [
        ParameterEffect(name, fit.values[name], before, fit.chi_squared, trials.text_of(fit, name))
        for name, fit in fits.items()
    ]


def _together(
    trials: Trials, alone: Sequence[ParameterEffect], known: Mapping[str, Prior], numbers: int
) -> tuple[JointEffect, ...]:
    """Joint effects of the best parameter, and of the best of EFFECTS, with each lacking effect.

    Empty where the best parameter alone explains the readings.
    """
    first = alone[0]
    if first.after <= EXPLAINED * numbers:
        return ()
    best = next(each for each in alone if each.name in trials.names)
    found: dict[frozenset[str], JointEffect] = {}
    for own in (first, best):
        prior = known.get(own.name) or effect_prior(trials.spec.measurements, own.name)
        for name in trials.names:
            both = own.name, name
            if own.name == name or frozenset(both) in found:
                continue
            fit = trials.fit(name, {own.name: prior}, {own.name: own.value})
            words = tuple(_text_of(trials.spec, each, fit.values[each]) for each in both)
            found[frozenset(both)] = JointEffect(both, own.before, fit.chi_squared, words)
    return _ordered(list(found.values()))


def _text_of(spec: FitSpec, name: str, value: float) -> str:
    """Text of the change of a parameter, or of the value of one of EFFECTS."""
    if name in EFFECTS:
        return effect_text(spec.measurements.parts, name, value)
    return change_text(name, value - spec.fixed[name])


def _alone(
    spec: FitSpec, centered: CenteredModel, name: str, prior: Prior, before: float
) -> ParameterEffect:
    alone = replace(spec, fitted={name: prior})
    fit = solve_from(LeastSquaresProblem(alone, centered), spec.fixed)
    value = fit.values[name]
    return ParameterEffect(name, value, before, fit.chi_squared, _text_of(spec, name, value))


IDEAL_CAPACITANCE = {"phase_exponent": 1.0, "loss_tangent": 0.0}
LOW_END = 6
"""The low end of a sweep is its number of frequencies over this."""


@dataclass(frozen=True)
class IdealComparison:
    """Comparison of a fit with the best one of an ideal capacitance, also in sentences."""

    ideal: Fit = field(repr=False)
    rms_error: float
    ideal_rms_error: float
    sentences: tuple[str, ...]


def compare_with_ideal(fit: Fit, progress: ProgressCallback) -> IdealComparison:
    """Compares a fit with one whose exponent is fixed at 1 and whose loss is 0."""
    fixed = {**fit.spec.fixed, **IDEAL_CAPACITANCE}
    others = {
        name: prior for name, prior in fit.spec.fitted.items() if name not in IDEAL_CAPACITANCE
    }
    spec = replace(fit.spec, fitted=others, fixed=fixed)
    ideal = best_fit(spec, fit.problem.model, fit.values, progress)
    sentences = _comparison_sentences(fit, ideal)
    return IdealComparison(ideal, fit.rms_error, ideal.rms_error, sentences)


def _comparison_sentences(fit: Fit, ideal: Fit) -> tuple[str, ...]:
    frequency, Z = fit.spec.measurements.first
    read = fit.spec.measurements.read[0]
    ours, theirs = (each.problem.fitted(each.u)[0, 0, read] for each in (fit, ideal))
    exponent = fit.values["phase_exponent"]
    lines = [
        f"the best fit with an ideal capacitance (exponent 1) has an rms error of Z of "
        f"{100 * ideal.rms_error:.1f} %; with the exponent {exponent:.3f} it is "
        f"{100 * fit.rms_error:.1f} %"
    ]
    if len(frequency) >= 2 * LOW_END:
        lines += [_systematic(theirs, Z), _low_end(frequency, Z, ours, theirs, exponent)]
    return tuple(lines)


def _systematic(fitted: Complex, Z: Complex) -> str:
    phase = np.degrees(difference(fitted[None], Z[None]).reshape(2, -1)[1])
    runs = 1 + int((np.diff(np.sign(phase)) != 0).sum())
    return (
        f"the phase of the ideal fit is off by {phase.min():+.1f} to {phase.max():+.1f} degrees, "
        f"in {runs} runs of one sign over {len(phase)} frequencies (noise would make about "
        f"{(len(phase) + 1) // 2}): the ideal model has the wrong curve"
    )


def _low_end(frequency: Real, Z: Complex, ours: Complex, theirs: Complex, exponent: float) -> str:
    low = slice(0, max(4, len(frequency) // LOW_END))
    read, own, ideal = (_slopes(frequency[low], each[low]) for each in (Z, ours, theirs))
    return (
        f"from {frequency[0]:.3g} to {frequency[low][-1]:.3g} Hz the measured |Z| goes as "
        f"f^{read[0]:.2f} and Rs as f^{read[1]:.2f}, at {read[2]:.1f} degrees. Rs of an ideal line "
        f"is constant where |Z| goes as 1/f: the best ideal fit has f^{ideal[0]:.2f}, "
        f"f^{ideal[1]:.2f} and {ideal[2]:.1f} degrees. Where both |Z| and Rs fall with f, the "
        f"capacitance itself has a loss: exponent {exponent:.3f} gives f^{own[0]:.2f}, "
        f"f^{own[1]:.2f} and {own[2]:.1f} degrees"
    )


def _slopes(frequency: Real, Z: Complex) -> tuple[float, float, float]:
    """Exponents of f in |Z| and Rs, and the mean phase in degrees."""
    logarithm = np.log(frequency)
    magnitude, resistance = (
        float(np.polyfit(logarithm, np.log(np.abs(each)), 1)[0]) for each in (Z, Z.real)
    )
    return magnitude, resistance, math.degrees(float(np.angle(Z).mean()))

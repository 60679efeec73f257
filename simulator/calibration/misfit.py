"""What explains a gap: parameters one by one, and the ideal capacitance."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import NDArray

from ..fem.factors import one_blas_thread
from ..models.effects import EFFECTS, effects_of
from ..models.parameters import own_values
from ..progress import ProgressCallback, silent
from ..scene.scene import Scene
from ..sweeps import InputError, ToleranceError
from .centered_model import Around, Model, checked_model, model_of
from .estimates import changed
from .fit import EXPLAINED, Fit, best_fit, model_tolerance, solve_from
from .fit_options import Options, candidates
from .measurements import measurements_of
from .prior import Prior, effect_prior, noise_of, priors
from .problem import FitSpec, LeastSquaresProblem, difference
from .surroundings_trials import Trials, addable, in_words

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Explained:
    """What one parameter alone does for the misfit.

    value: as `Forward` counts it, at its best. before, after: chi-squared with the scene as it
    stands and with that value. told: the change in words, of one of EFFECTS what it then is.
    """

    name: str
    value: float
    before: float
    after: float
    told: str

    @property
    def removed(self) -> float:
        """Part of chi-squared that it removes, from 0 to 1."""
        return max(0.0, 1 - self.after / self.before) if self.before > 0 else 0.0


@dataclass(frozen=True)
class Together:
    """What two causes do for the misfit when both are fitted.

    names: of the parameters. before, after: as in `Explained`. descriptions: what each then is, in
    words.
    """

    names: tuple[str, str]
    before: float
    after: float
    descriptions: tuple[str, ...]

    @property
    def removed(self) -> float:
        """Part of chi-squared that they remove, from 0 to 1."""
        return max(0.0, 1 - self.after / self.before) if self.before > 0 else 0.0


@dataclass(frozen=True)
class Causes:
    """What explains a misfit.

    alone: every parameter that was fitted alone, the one that removes most first. together: pairs
    that were fitted jointly, the one that removes most first. remarks: what could not be tried.
    """

    alone: tuple[Explained, ...] = ()
    together: tuple[Together, ...] = ()
    remarks: tuple[str, ...] = ()


def gap_by_parameter(
    scene: Scene,
    sweeps: xr.Dataset,
    options: Options = Options(),  # noqa: B008
    *,
    model: Model | None = None,
    progress: ProgressCallback = silent,
) -> Causes:
    """Fits every parameter of the scene alone, and the best of them with what surrounds the skin.

    Strengths of presses and the meter's fixed errors are fitted with each, within their own
    spreads. Factors are looked for within the model's reach. Where there is a misfit, those of
    EFFECTS that the scene has not are tried, too: each alone, and each together with the best
    parameter and with the best of EFFECTS. Arguments, errors: as of `calibrate`; of `options.fit`,
    where given, only those.
    """
    data = measurements_of(scene, sweeps, options.band, options.session)
    effects = effects_of(data.scene) if options.prior == "wide" else ()
    readout, known = noise_of(data).readout, priors(data, options.prior, effects=effects)
    asked = FitSpec(data, readout, {}, own_values(data.scene), options.strengths)
    own = checked_model(model, data.scene) if model else None
    ready = Around(own or model_of(data.scene, model_tolerance(readout), progress), {})
    unknown = candidates(data, ready.model.free, known, options.fit, options.fix)
    names = unknown.fitted if options.fit else [*unknown.fitted, *unknown.held]
    with one_blas_thread():
        before = solve_from(LeastSquaresProblem(asked, ready), asked.fixed).chi_squared
        alone = [_alone(asked, ready, name, known[name], before) for name in names]
        if options.fit or before <= EXPLAINED * data.numbers or not addable(data.scene):
            return Causes(_ordered(alone))
        try:
            trials = Trials(asked, {}, progress)
            alone = _ordered([*alone, *_tried(trials, before)])
            return Causes(alone, _together(trials, alone, known, data.numbers))
        except (InputError, ToleranceError) as error:
            return Causes(_ordered(alone), (), (f"what surrounds the skin was not tried: {error}",))


Found = TypeVar("Found", Explained, Together)


def _ordered(found: Sequence[Found]) -> tuple[Found, ...]:
    return tuple(sorted(found, key=lambda each: each.after))


def _tried(trials: Trials, before: float) -> list[Explained]:
    """What each of EFFECTS alone does that the scene has not."""
    fits = {name: trials.fit(name) for name in trials.names}
    return [
        Explained(name, fit.values[name], before, fit.chi_squared, trials.in_words(fit, name))
        for name, fit in fits.items()
    ]


def _together(
    trials: Trials, alone: Sequence[Explained], known: Mapping[str, Prior], numbers: int
) -> tuple[Together, ...]:
    """Pairs of the first cause, and of the first of EFFECTS, with each of these that the scene has
    not; none where the first cause alone explains the readings."""
    first = alone[0]
    if first.after <= EXPLAINED * numbers:
        return ()
    best = next(each for each in alone if each.name in trials.names)
    found: dict[frozenset[str], Together] = {}
    for own in (first, best):
        prior = known.get(own.name) or effect_prior(trials.asked.measurements, own.name)
        for name in trials.names:
            both = own.name, name
            if own.name == name or frozenset(both) in found:
                continue
            fit = trials.fit(name, {own.name: prior}, {own.name: own.value})
            words = tuple(_in_words(trials.asked, each, fit.values[each]) for each in both)
            found[frozenset(both)] = Together(both, own.before, fit.chi_squared, words)
    return _ordered(list(found.values()))


def _in_words(asked: FitSpec, name: str, value: float) -> str:
    """The change of a parameter; of one of EFFECTS what it then is."""
    if name in EFFECTS:
        return in_words(asked.measurements.scene, name, value)
    return changed(name, value - asked.fixed[name])


def _alone(asked: FitSpec, ready: Around, name: str, prior: Prior, before: float) -> Explained:
    alone = replace(asked, fitted={name: prior})
    fit = solve_from(LeastSquaresProblem(alone, ready), asked.fixed)
    value = fit.values[name]
    return Explained(name, value, before, fit.chi_squared, _in_words(asked, name, value))


IDEAL = {"phase_exponent": 1.0, "loss_tangent": 0.0}
LOW_END = 6
"""Part of the frequencies that are its low end."""


@dataclass(frozen=True)
class Comparison:
    """The fit beside the best one of an ideal capacitance, and what sets them apart."""

    ideal: Fit = field(repr=False)
    rms_error: float
    ideal_rms_error: float
    told: tuple[str, ...]


def compared(fit: Fit, progress: ProgressCallback) -> Comparison:
    """With the exponent held at 1 and without loss, all else fitted alike."""
    fixed = {**fit.spec.fixed, **IDEAL}
    others = {name: prior for name, prior in fit.spec.fitted.items() if name not in IDEAL}
    asked = replace(fit.spec, fitted=others, fixed=fixed)
    ideal = best_fit(asked, fit.problem.around, progress=progress)
    told = _told(fit, ideal)
    return Comparison(ideal, fit.rms_error, ideal.rms_error, told)


def _told(fit: Fit, ideal: Fit) -> tuple[str, ...]:
    frequency, Z = fit.spec.measurements.first
    read = fit.spec.measurements.read[0]
    ours, theirs = (each.problem.fitted(each.u)[0, 0, read] for each in (fit, ideal))
    exponent = fit.values["phase_exponent"]
    lines = [
        f"with an ideal capacitance (exponent 1) the best fit leaves {100 * ideal.rms_error:.1f} % "
        f"rms of Z, with the exponent {exponent:.3f} {100 * fit.rms_error:.1f} %"
    ]
    if len(frequency) >= 2 * LOW_END:
        lines += [_systematic(theirs, Z), _low_end(frequency, Z, ours, theirs, exponent)]
    return tuple(lines)


def _systematic(fitted: NDArray[np.complex128], Z: NDArray[np.complex128]) -> str:
    phase = np.degrees(difference(fitted[None], Z[None]).reshape(2, -1)[1])
    runs = 1 + int((np.diff(np.sign(phase)) != 0).sum())
    return (
        f"the phase of the ideal fit is off by {phase.min():+.1f} to {phase.max():+.1f} degrees, "
        f"in {runs} runs of one sign over {len(phase)} frequencies (chance makes about "
        f"{(len(phase) + 1) // 2}): it is the wrong curve, not noise"
    )


def _low_end(
    frequency: NDArray[np.float64],
    Z: NDArray[np.complex128],
    ours: NDArray[np.complex128],
    theirs: NDArray[np.complex128],
    exponent: float,
) -> str:
    low = slice(0, max(4, len(frequency) // LOW_END))
    read, own, ideal = (_slopes(frequency[low], each[low]) for each in (Z, ours, theirs))
    return (
        f"from {frequency[0]:.3g} to {frequency[low][-1]:.3g} Hz |Z| was measured to go as "
        f"f^{read[0]:.2f}, Rs as f^{read[1]:.2f}, at {read[2]:.1f} degrees. An ideal line's Rs "
        f"levels off where its |Z| nears 1/f: at its best f^{ideal[0]:.2f}, f^{ideal[1]:.2f} and "
        f"{ideal[2]:.1f} degrees. Where |Z| and Rs both go on, the capacitance itself turns the "
        f"phase: exponent {exponent:.3f} gives f^{own[0]:.2f}, f^{own[1]:.2f} and "
        f"{own[2]:.1f} degrees"
    )


def _slopes(
    frequency: NDArray[np.float64], Z: NDArray[np.complex128]
) -> tuple[float, float, float]:
    """Powers of f that |Z| and Rs go as, and the mean phase in degrees."""
    logarithm = np.log(frequency)
    magnitude, resistance = (
        float(np.polyfit(logarithm, np.log(np.abs(each)), 1)[0]) for each in (Z, Z.real)
    )
    return magnitude, resistance, math.degrees(float(np.angle(Z).mean()))

"""Calibration: a scene fitted to measured sweeps, with intervals and remarks."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..arrays import Real
from ..models.cosine_modes import FittedModes
from ..models.mechanics.force_depths import forces_as_depths, pressed_by_factors
from ..models.parameters import READER, own_values
from ..progress import ProgressCallback, silent
from ..report.findings import Findings, Result
from ..scene.parts import Plan, Setup, Skin
from ..scene.scene import Scene
from ..scene.supports import require, supported
from ..sweeps import InputError
from .command import Options
from .connections import Connection, Measure, try_connections
from .distributions import Distributions
from .estimates import FittedQuantity, intervals, quantile, quantities, weakly_identified
from .fit import Fit, best_fit, capacitance_offset, certificate_limit, fitted_parts, model_tolerance
from .fit_options import FitSpec, candidates
from .identifiability import Information, information, with_all_unknown
from .measurements import Measurements, measurements_of
from .misfit import IdealComparison, compare_with_ideal
from .physics_trials import misfit_trials
from .prior import Noise, Prior, display_step, noise_of, priors, sessions_vary_smoothly, with_noise
from .problem import CenteredModel, Model, centered_model, checked_model, model_of
from .sheet_intervals import MISMATCH
from .student import FAR_OFF, StudentT, fitted_tail, likeliest
from .surroundings_trials import with_effects

if TYPE_CHECKING:
    import xarray as xr

ROUNDS = 12
SETTLED = 0.01
"""Relative change of degrees of freedom and scale at which they have converged."""
NAMED = 6
"""Largest number of readings that a remark names."""
FROM_RESIDUALS = "the residuals of the fit"

Refit = Callable[[Noise, StudentT | None], Fit]


def robust_fit(fit: Fit, noise: Noise, requested: bool | None, refit: Refit) -> tuple[Fit, Noise]:
    """The fit with Student's t errors and the noise of it, or the given ones with normal errors.

    fit: with normal errors. requested: True for Student's t, False for normal errors, None for the
    likelier of both. Noise that was estimated is estimated anew from the residuals, because
    readings far off enlarge it.
    """
    if requested is False:
        return fit, noise
    squares, freedom = fit.problem.squares(fit.u), information(fit).freedom
    parts = fit.spec.measurements.per_reading
    chosen = likeliest if requested is None else fitted_tail
    tail = chosen(squares, freedom, parts=parts)
    if tail is None or (requested is None and not _matters(squares, tail, noise)):
        return fit, noise
    if not noise.stated:
        noise = replace(noise, guessed=True, source=FROM_RESIDUALS)
    for _ in range(ROUNDS):
        noise, tail = _rescaled(noise, tail)
        fit, before = refit(noise, tail), tail
        squares, freedom = fit.problem.squares(fit.u), information(fit).freedom
        tail = fitted_tail(squares, freedom, 1.0 if noise.stated else 0.0, parts)
        if _change(before, tail) < SETTLED:
            break
    return fit, noise


def _matters(squares: Real, tail: StudentT, noise: Noise) -> bool:
    """True if some reading is far off in units of the noise, and not only of rounding."""
    if not noise.stated and noise.readout.magnitude_noise <= display_step(noise.readout):
        return False
    scale = max(tail.scale, 1.0) if noise.stated else tail.scale
    return bool((squares > FAR_OFF * scale**2).any())


def _rescaled(noise: Noise, tail: StudentT) -> tuple[Noise, StudentT]:
    """Noise and distribution whose scale is 1 where the residuals determine the noise."""
    if noise.stated:
        return noise, replace(tail, scale=max(tail.scale, 1.0))
    readout = noise.readout
    magnitude = tail.scale * readout.magnitude_noise
    phase = tail.scale * readout.phase_noise
    return replace(noise, readout=with_noise(readout, magnitude, phase)), replace(tail, scale=1.0)


def _change(before: StudentT, after: StudentT) -> float:
    return max(abs(after.freedom / before.freedom - 1), abs(after.scale / before.scale - 1))


def tail_remarks(fit: Fit) -> list[str]:
    """Remarks on the distribution of errors; none where it is normal."""
    tail = fit.spec.tail
    if tail is None:
        return []
    squares = fit.problem.squares(fit.u) / tail.scale**2
    off = np.flatnonzero(squares > FAR_OFF)
    return [
        f"errors of readings have Student's t distribution of {tail.freedom:.2g} degrees of "
        f"freedom; {len(off)} of {len(squares)} readings are more than "
        f"{np.sqrt(FAR_OFF):.0f} times the noise off{_named(fit, off)}"
    ]


def _named(fit: Fit, off: NDArray[np.intp]) -> str:
    """Frequencies of readings far off. off: their numbers among the used readings."""
    measured = fit.spec.measurements
    used = np.stack([measured.read & sweep.known for sweep in measured.sweeps])
    f = measured.parts.setup.frequency[np.nonzero(used)[2][off]]
    if not len(f):
        return ""
    several = f" and {len(set(f)) - NAMED} more" if len(set(f)) > NAMED else ""
    return f", at {', '.join(f'{each:.4g}' for each in sorted(set(f))[:NAMED])} Hz{several}"


NOISE_ROUNDS = 3
ROUNDED = 1e-6
"""Distance of an exponent from 1 within which it counts as 1."""


@dataclass(frozen=True, repr=False)
class Calibration(Result):
    """Result of a calibration.

    values: value of each parameter by name; of a factor on the given scene it is the logarithm.
    intervals: marginal 95 % interval of each unknown parameter. standard_errors: of these.
    identified: for each of them, True if the data determine it, False if its prior does.
    quantities: the fitted quantities in physical units; `calibration["foam capacitance"]` is one of
    them by its name. scene: the calibrated scene. not_fitted: unknown parameters that kept the
    scene's values. noise: the meter's noise. unclear: combinations that the data do not identify, a
    line each. remarks: notes on the fit. left_over: those on readings far off and on physics that
    the scene lacks. ideal: comparison with an ideal capacitance, for an exponent fitted below 1.
    """

    values: dict[str, float]
    intervals: dict[str, tuple[float, float]]
    standard_errors: dict[str, float]
    scene: Scene
    identified: dict[str, bool]
    quantities: tuple[FittedQuantity, ...]
    information: Information
    fit: Fit
    noise: Noise
    unclear: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()
    left_over: tuple[str, ...] = ()
    not_fitted: tuple[str, ...] = ()
    ideal: IdealComparison | None = None

    def __getitem__(self, name: str) -> FittedQuantity:
        """A fitted quantity by its name. Raises InputError that lists the names."""
        names = [quantity.name for quantity in self.quantities]
        if name not in names:
            raise InputError(
                f"a calibration of {self.scene.name} has no quantity {name!r}, "
                f"only {', '.join(names)}"
            )
        return self.quantities[names.index(name)]

    @property
    def chi_squared(self) -> float:
        """Chi-squared per degree of freedom."""
        return self.fit.chi_squared / self.information.freedom

    @property
    def rms_error(self) -> float:
        """Rms error of Z relative to |Z|."""
        return self.fit.rms_error

    @property
    def report(self) -> Findings:
        """The fitted quantities, remarks, and the residuals."""
        from .report import report_of

        return report_of(self, "sweeps")

    @property
    def strengths(self) -> list[Real]:
        """Rises of capacitance (factor - 1) of the touches of each sweep."""
        readings = range(len(self.fit.spec.measurements.sweeps))
        return [self.fit.problem.strengths(self.fit.u, k) for k in readings]


def calibrate(
    scene: Scene,
    sweeps: xr.Dataset,
    options: Options = Options(),  # noqa: B008
    *,
    model: Model | None = None,
    progress: ProgressCallback = silent,
    trials: bool = True,
) -> Calibration:
    """Fits a scene to sweeps, unpressed ones and presses of pixels, at all their interfaces.

    model: a trained model of the scene at the sweeps' interfaces and frequencies, if there is one:
    training is the slow part. progress: see `ProgressCallback`. The result has the remarks of
    `tried` unless `trials` is False.
    Raises InputError where sweeps and scene do not match, ToleranceError where no model reaches its
    tolerance.
    """
    stated = {"force": scene.press.force, "depth": scene.press.depth}
    also = (*options.also, *(name for name in options.fit if name in READER))
    parts = with_effects(forces_as_depths(supported("a calibration", scene.parts)), also)
    pressed_by_factors(parts)

    def measure(setup: Setup) -> Measurements:
        return measurements_of(parts.read(setup), sweeps, options.frequencies, options.session)

    job = _CalibrationRun(measure(parts.setup), options, also, model, progress)
    if model is None and (other := job.connection(parts.setup, measure)):
        parts = parts.read(other.setup(parts.setup))
        data = other.presses(measure(parts.setup))
        job = _CalibrationRun(data, options, also, model, progress, job)
    fit, noise = job.run()
    fitted = fitted_parts(parts, fit.values)
    press = fitted.plan.press.model_copy(update=stated)
    on, info = (parts.skin, parts.setup), information(fit, job.not_fitted)
    degrees = info.variance_freedom(noise)
    unknown = with_all_unknown(fit, job.not_fitted)
    distributions = _distributions(*on, unknown, info, degrees, job.not_fitted)
    bounds = intervals(*on, unknown, info, degrees, distributions, progress)
    deviations = zip(unknown.spec.fitted.items(), info.deviation.tolist(), strict=True)
    left_over = tuple(tail_remarks(fit))
    found = Calibration(
        values=fit.values,
        intervals=bounds,
        standard_errors={name: prior.deviation * own for (name, prior), own in deviations},
        scene=fitted.pressed_by(press).scene,
        identified=info.identified,
        quantities=quantities(*on, unknown, info, degrees, fit.spec.names, distributions),
        information=info,
        fit=fit,
        noise=noise,
        unclear=tuple(weakly_identified(*on, unknown, info)),
        remarks=tuple(dict.fromkeys([*job.remarks, *_left_out(fit), *left_over])),
        left_over=left_over,
        not_fitted=tuple(job.not_fitted),
    )
    return tried(found, progress) if trials else found


def tried(calibration: Calibration, progress: ProgressCallback = silent) -> Calibration:
    """The calibration with remarks on what its scene lacks, and on an ideal capacitance."""
    fit, names = calibration.fit, calibration.fit.spec.names
    gained = misfit_trials(fit, calibration.information.freedom, calibration.noise, progress)
    lossy = "phase_exponent" in names and not fit.spec.measurements.parts.setup.gain
    beaten = lossy and calibration.intervals["phase_exponent"][1] < 1 - ROUNDED
    return replace(
        calibration,
        remarks=tuple(dict.fromkeys([*calibration.remarks, *gained])),
        left_over=(*calibration.left_over, *gained),
        ideal=compare_with_ideal(fit, progress) if beaten else None,
    )


def _distributions(
    skin: Skin,
    setup: Setup,
    unknown: Fit,
    info: Information,
    freedom: float,
    not_fitted: Mapping[str, Prior],
) -> Distributions | None:
    """Profile distributions; None where parameters other than the mismatch were not fitted."""
    if not_fitted.keys() - {MISMATCH}:
        return None
    return Distributions(skin, setup, unknown, info, quantile(freedom))


class _CalibrationRun:
    """A calibration in progress: its current model and its remarks."""

    def __init__(
        self,
        measured: Measurements,
        options: Options,
        also: Sequence[str],
        model: Model | None,
        progress: ProgressCallback,
        before: _CalibrationRun | None = None,
    ) -> None:
        """also: see `priors`. before: one whose `connection` led to this one."""
        self.measured, self.options, self._progress = measured, options, progress
        left_out = [f"left out: {reason}" for reason in measured.left_out]
        self.remarks = before.remarks if before else left_out
        self.noise = noise_of(measured)
        self._uneven = _checked_uneven(measured.parts.skin, measured.parts.plan, options, model)
        self.priors = priors(measured, options.prior, self._uneven, also)
        at_hand = model or model_of(measured.parts, self._tolerance, progress, self._uneven)
        free = (*at_hand.free, *self._uneven.names)
        fit = (*options.fit, *options.also) if options.fit else ()
        chosen = candidates(measured, free, self.priors, fit, options.fix)
        self.names, self.not_fitted = (
            chosen.fitted,
            {name: self.priors[name] for name in chosen.not_fitted},
        )
        self._ready = self._prepared(at_hand, trained=model is not None)
        self._begin: Mapping[str, float] | None = before._begin if before else None
        self._tail: StudentT | None = None

    def connection(self, every: Setup, measure: Measure) -> Connection | None:
        """The connection that explains the readings, where the stated one does not."""
        found = try_connections(self._spec(), self._ready, every, measure, self._progress)
        self._begin = found.begin
        self.remarks += found.remarks
        return found.connection

    def run(self) -> tuple[Fit, Noise]:
        """The fit, and the noise it was made with."""
        if self.noise.guessed:
            for _ in range(NOISE_ROUNDS):
                self.noise = self._from_residuals(self._fit())
        fit, self.noise = robust_fit(self._fit(), self.noise, self.options.robust, self._refit)
        return fit, self.noise

    def _refit(self, noise: Noise, tail: StudentT | None) -> Fit:
        """The fit with Student's t errors; the first begins anew, because a few readings far off
        may have led the one with normal errors elsewhere."""
        self.noise = noise
        if self._tail is None:
            self._begin = None
        self._tail = tail
        return self._fit()

    def _spec(self) -> FitSpec:
        own = own_values(self.measured.parts.skin, self.measured.parts.setup) | dict.fromkeys(
            self._uneven.names, 0.0
        )
        return FitSpec(
            self.measured,
            self.noise.readout,
            {name: self.priors[name] for name in self.names},
            {name: value for name, value in own.items() if name not in self.names},
            not self.options.fixed_strength,
            self._tail,
        )

    def _fit(self) -> Fit:
        fit = best_fit(self._spec(), self._ready, self._begin, self._remark)
        self._ready, self._begin = fit.problem.model, fit.values
        return fit

    def _prepared(self, model: Model, trained: bool) -> CenteredModel:
        """A model around the scene, or around the measured capacitance where that is far off."""
        parts = self.measured.parts
        if trained or math.isinf(model.reach):
            return CenteredModel(
                checked_model(model, parts.skin, parts.setup, self._uneven), {}, self._uneven
            )
        wide = self.options.prior == "wide" and "capacitance" in self.names
        off = capacitance_offset(self.measured) if wide else 0.0
        if not off:
            return CenteredModel(model, {}, self._uneven)
        return centered_model(
            parts, {"capacitance": off}, self._tolerance, self._progress, self._uneven
        )

    @property
    def _tolerance(self) -> float:
        return model_tolerance(self.noise.readout)

    def _from_residuals(self, fit: Fit) -> Noise:
        scale = math.sqrt(fit.chi_squared / information(fit).freedom)
        noise = scale * self.noise.readout.magnitude_noise
        readout = with_noise(self.noise.readout, noise, noise)
        return replace(self.noise, readout=readout, source="the residuals of the fit")

    def _remark(self, work: str, done: float | None = None, total: float = 1.0, /) -> None:
        self._progress(work, done, total)
        if done is None:
            self.remarks.append(work)


def _checked_uneven(skin: Skin, plan: Plan, options: Options, model: Model | None) -> FittedModes:
    """Cosine modes to fit. Raises InputError where the scene has such maps already."""
    drawn = options.prior == "session" and sessions_vary_smoothly(plan) and model is None
    found = FittedModes(options.uneven or drawn, options.uneven_sheets)
    if found.foam:
        require("a calibration of cosine modes of the foam", skin, None, plan)
    if found.sheets:
        require("a calibration of cosine modes of the sheets", skin)
    return found


def _left_out(fit: Fit) -> list[str]:
    """A remark on the model's error, where that is not small compared with the meter's."""
    if fit.certificate <= certificate_limit(fit.spec):
        return []
    return [f"the model's error at the solution is up to {fit.certificate:.1e} of Rs and Cp"]

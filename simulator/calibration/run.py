"""A scene fitted to measured sweeps: its parameters, how surely each is told, and what is left."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..models.cosine_modes.amplitudes import FittedModes
from ..models.cosine_modes.foam_modes import check_uniform_foam, with_foam_modes
from ..models.cosine_modes.sheet_modes import check_uniform_sheets, with_sheet_modes
from ..models.effects import effects_of
from ..models.line_slopes import LineModel
from ..models.mechanics.force_depths import forces_as_depths
from ..models.parameters import own_values, scene_with
from ..models.uniform import folded
from ..progress import ProgressCallback, silent
from ..safe_text import Tabular
from ..scene.scene import Scene
from .centered_model import Around, Model, around, checked_model, model_of
from .estimates import HEADER, Quantity, intervals, quantile, quantities, told_together
from .fit import Fit, best_fit, certificate_limit, model_tolerance
from .fit_options import Options, candidates
from .identifiability import Information, information, with_unknown
from .initial_values import capacitance_off
from .likelihood.distributions import Laws
from .measurements import Measurements, measurements_of
from .misfit import Comparison, compared
from .prior import Noise, Prior, drawn_uneven, noise_of, priors, with_noise
from .problem import FitSpec
from .sheet_intervals import MISMATCH
from .surroundings_trials import gains, surrounded

if TYPE_CHECKING:
    import xarray as xr

NOISE_ROUNDS = 3
ROUNDED = 1e-6
"""Of an exponent: so near to 1 it is 1."""


@dataclass(frozen=True, repr=False)
class Calibration(Tabular):
    """What the sweeps say of a scene.

    values: all parameters as `Forward` counts them about the scene given. intervals: 95 %, of all
    that are not known, each whatever the others are. told: whether the data tell each of them, or
    its prior does. held: parameters that are not known, but left as the scene has them. scene: the
    calibrated one. quantities: the fitted in physical units. strengths: of the touches of each
    press. noise: of the meter. unclear: what the data cannot tell apart. remarks: what was done on
    the way. ideal: where the exponent was fitted, why an ideal capacitance would not do.
    """

    values: dict[str, float]
    intervals: dict[str, tuple[float, float]]
    scene: Scene
    told: dict[str, bool]
    quantities: tuple[Quantity, ...]
    information: Information
    fit: Fit
    noise: Noise
    unclear: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()
    held: tuple[str, ...] = ()
    ideal: Comparison | None = None

    @property
    def chi_squared(self) -> float:
        """Per degree of freedom."""
        return self.fit.chi_squared / self.information.freedom

    @property
    def rms_error(self) -> float:
        """Of Z, relative to |Z|."""
        return self.fit.rms_error

    def _table(self) -> tuple[str, list[tuple[str, ...]]]:
        return f"Calibration of {self.scene.name}", [HEADER, *(q.cells for q in self.quantities)]

    @property
    def strengths(self) -> list[NDArray[np.float64]]:
        """Rise of capacitance (factor - 1) of each touch of each reading."""
        readings = range(len(self.fit.spec.measurements.sweeps))
        return [self.fit.problem.strengths(self.fit.u, k) for k in readings]


def calibrate(
    scene: Scene,
    sweeps: xr.Dataset,
    options: Options = Options(),  # noqa: B008
    *,
    model: Model | None = None,
    progress: ProgressCallback = silent,
) -> Calibration:
    """Fit a scene to sweeps, unpressed ones and presses of pixels, at all their interfaces.

    model: of the scene at the sweeps' interfaces and frequencies, where there is one at hand; its
    training is the slow part. progress: as of `ProgressCallback`.
    Raises InputError where sweeps and scene do not fit, ToleranceError where no model holds.
    """
    scene = forces_as_depths(scene)
    unknown_effects = (*(effects_of(scene) if options.prior == "wide" else ()), *options.also)
    scene = surrounded(scene, options.also)
    folded(scene, "a calibration")
    data = measurements_of(scene, sweeps, options.band, options.session)
    job = _Job(data, options, unknown_effects, model, progress)
    fit, noise = job.done()
    told = information(fit, job.held)
    degrees = told.freedom if noise.guessed else noise.freedom
    unknown = with_unknown(fit, job.held)
    laws = _laws(scene, unknown, told, degrees, job.held)
    bounds = intervals(scene, unknown, told, degrees, laws)
    gained = [] if noise.guessed else gains(fit, told.freedom, progress)
    names = fit.spec.names
    beaten = "phase_exponent" in names and bounds["phase_exponent"][1] < 1 - ROUNDED
    return Calibration(
        values=fit.values,
        intervals=bounds,
        scene=_fitted_scene(scene, fit.values),
        told=told.told,
        quantities=quantities(scene, unknown, told, degrees, names, laws),
        information=told,
        fit=fit,
        noise=noise,
        unclear=tuple(told_together(scene, unknown, told)),
        remarks=tuple(dict.fromkeys([*job.remarks, *_left_out(fit), *gained])),
        held=tuple(job.held),
        ideal=compared(fit, progress) if beaten else None,
    )


def _laws(
    scene: Scene, unknown: Fit, told: Information, freedom: float, held: Mapping[str, Prior]
) -> Laws | None:
    """None where the scene's values were kept that the data may say are others."""
    if held.keys() - {MISMATCH}:
        return None
    return Laws(scene, unknown, told, quantile(freedom))


def _fitted_scene(scene: Scene, values: Mapping[str, float]) -> Scene:
    """The scene with its parameters, and with the slow waves as maps."""
    return with_sheet_modes(with_foam_modes(scene_with(scene, values), values), values)


class _Job:
    """A calibration under way: the model at hand, and what is to be remarked."""

    def __init__(
        self,
        measured: Measurements,
        options: Options,
        effects: Sequence[str],
        model: Model | None,
        progress: ProgressCallback,
    ) -> None:
        """effects: as of `priors`."""
        self.measured, self.options, self._progress = measured, options, progress
        self.remarks = [f"left out: {reason}" for reason in measured.left_out]
        self.noise = noise_of(measured)
        self._uneven = _checked_uneven(measured.scene, options, model)
        self.priors = priors(measured, options.prior, self._uneven, effects)
        at_hand = model or model_of(measured.scene, self._tolerance, progress, self._uneven)
        free = (*at_hand.free, *self._uneven.names)
        fit = (*options.fit, *options.also) if options.fit else ()
        asked = candidates(measured, free, self.priors, fit, options.fix)
        self.names, self.held = asked.fitted, {name: self.priors[name] for name in asked.held}
        self._ready = self._prepared(at_hand, trained=model is not None)
        self._begin: Mapping[str, float] | None = None

    def done(self) -> tuple[Fit, Noise]:
        """The fit, and the noise it was made with."""
        if self.noise.guessed:
            for _ in range(NOISE_ROUNDS):
                self.noise = self._from_residuals(self._fit())
        return self._fit(), self.noise

    def _fit(self) -> Fit:
        own = own_values(self.measured.scene) | dict.fromkeys(self._uneven.names, 0.0)
        asked = FitSpec(
            self.measured,
            self.noise.readout,
            {name: self.priors[name] for name in self.names},
            {name: value for name, value in own.items() if name not in self.names},
            self.options.strengths,
        )
        fit = best_fit(asked, self._ready, self._begin, self._remark)
        self._ready, self._begin = fit.problem.around, fit.values
        return fit

    def _prepared(self, model: Model, trained: bool) -> Around:
        """A model about the scene, or about the capacitance that is seen where that is far off."""
        scene = self.measured.scene
        if trained or isinstance(model, LineModel):
            return Around(checked_model(model, scene, self._uneven), {}, self._uneven)
        wide = self.options.prior == "wide" and "capacitance" in self.names
        off = capacitance_off(self.measured) if wide else 0.0
        if not off:
            return Around(model, {}, self._uneven)
        return around(scene, {"capacitance": off}, self._tolerance, self._progress, self._uneven)

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


def _checked_uneven(scene: Scene, options: Options, model: Model | None) -> FittedModes:
    """What slow waves are fitted; raises InputError where the scene has such maps already."""
    drawn = options.prior == "session" and drawn_uneven(scene) and model is None
    found = FittedModes(options.uneven or drawn, options.uneven_sheets)
    if found.foam:
        check_uniform_foam(scene)
    if found.sheets:
        check_uniform_sheets(scene)
    return found


def _left_out(fit: Fit) -> list[str]:
    """What the model leaves out, where that is not small beside the meter's error."""
    if fit.certificate <= certificate_limit(fit.spec):
        return []
    return [f"the model leaves out up to {fit.certificate:.1e} of Rs and Cp at the solution"]

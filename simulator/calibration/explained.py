"""Which parameter alone would explain most of the misfit between a scene and measured sweeps."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from simulator.calibration.choice import candidates
from simulator.calibration.estimates import changed
from simulator.calibration.fit import Tell, model_tolerance, silent, solved
from simulator.calibration.measured import measured
from simulator.calibration.model import Around, Model, checked_model, model_of
from simulator.calibration.noise import noise_of
from simulator.calibration.prior import Prior, priors
from simulator.calibration.problem import Asked, Problem
from simulator.calibration.run import Options
from simulator.parameters import own_values
from simulator.scene import Scene
from simulator.sheet import one_blas_thread

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Explained:
    """What one parameter alone does for the misfit.

    value: as `Forward` counts it, at its best. before, after: chi-squared with the scene as it
    stands and with that value. told: the change in words.
    """

    name: str
    value: float
    before: float
    after: float
    told: str

    @property
    def removed(self) -> float:
        """Part of chi-squared that it removes."""
        return 1 - self.after / self.before if self.before > 0 else 0.0


def gap_by_parameter(
    scene: Scene,
    sweeps: xr.Dataset,
    options: Options = Options(),  # noqa: B008
    *,
    model: Model | None = None,
    tell: Tell = silent,
) -> tuple[Explained, ...]:
    """Of every parameter of the scene, the one that removes most first.

    All is counted after the strengths of presses and the meter's fixed errors were fitted within
    their own spreads. Factors are looked for within the model's reach. Arguments, errors: as of
    `calibrate`; of `options.fit`, where given, only those.
    """
    data = measured(scene, sweeps, options.band, options.session)
    readout, known = noise_of(data).readout, priors(data, options.prior)
    asked = Asked(data, readout, {}, own_values(data.scene), options.strengths)
    tell("training a model of the scene")
    own = checked_model(model, data.scene) if model else None
    ready = Around(own or model_of(data.scene, model_tolerance(readout)), {})
    names = candidates(ready.model.free, known, options.fit, options.fix)
    with one_blas_thread():
        before = solved(Problem(asked, ready), asked.fixed).chi_squared
        found = [_alone(asked, ready, name, known[name], before) for name in names]
    return tuple(sorted(found, key=lambda each: each.after))


def _alone(asked: Asked, ready: Around, name: str, prior: Prior, before: float) -> Explained:
    alone = replace(asked, fitted={name: prior})
    fit = solved(Problem(alone, ready), asked.fixed)
    value = fit.values[name]
    step = value - asked.fixed[name]
    return Explained(name, value, before, fit.chi_squared, changed(name, step))

"""What surrounds a skin, tried where a scene says nothing of it: a body, the rim and a finger."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

from ..models.effects import EFFECTS, NEEDED, effects_of
from ..models.parameters import scene_with
from ..progress import ProgressCallback, silent
from ..scene.scene import Scene
from ..scene.skin import VACUUM_PERMITTIVITY
from ..scene.surroundings import Body, Rim, Surroundings
from ..surroundings.rim import rim_densities
from ..sweeps import InputError, ToleranceError
from .centered_model import Around, around
from .fit import EXPLAINED, Fit, certificate_limit, solve_from
from .prior import Prior, effect_prior
from .problem import FitSpec, LeastSquaresProblem

BODY = 8e-3
"""m: of a body from the sheet that is not touched, where none is known; a factor of 30 on its
capacitance reaches from 0.3 mm to 0.24 m."""
RIM = 0.6 * VACUUM_PERMITTIVITY
"""F/m: between the sheets, and of each to earth, of a sheet of 0.12 m with 4 mm of foam that a
virtual earth reads: by charges of three-dimensional solves 0.61, 0.62 and 0.62 of vacuum's."""
WORTH = 0.1
"""Of chi-squared: what an effect takes off at least to be named."""
NONE = {"body": -10.0, "rim": -10.0, "finger": 0.0}
"""Values at which an effect is as good as none."""


def surrounded(scene: Scene, names: Sequence[str]) -> Scene:
    """The scene with what it needs to have these of EFFECTS among its parameters.

    Raises InputError for a name that is none of them, or that it cannot have.
    """
    for name in names:
        if name not in EFFECTS:
            raise InputError(f"`also` must be one of {', '.join(EFFECTS)}, got {name!r}")
    missing = [name for name in names if name not in effects_of(scene)]
    if not missing:
        return scene
    own = scene.surroundings or Surroundings()
    opposite = "bottom" if own.touched == "top" else "top"
    added: dict[str, object] = {}
    if "body" in missing and not own.body:
        added["body"] = (Body(side=opposite, distance=BODY),)
    if "rim" in missing and not own.solved:
        added["rim"] = Rim(mutual=RIM, top=RIM, bottom=RIM)
    found = scene.model_copy(update={"surroundings": own.model_copy(update=added)})
    for name in missing:
        if name not in effects_of(found):
            raise InputError(f"{scene.name} cannot have {name}: {NEEDED[name]}")
    return found


def addable(scene: Scene) -> list[str]:
    """Those of EFFECTS that a scene has not and can have."""
    around = scene.surroundings
    solved = around is not None and around.solved
    can = {
        "body": not solved,
        "rim": not solved,
        "finger": not (around and around.no_finger_reason),
    }
    return [name for name in EFFECTS if can[name] and name not in effects_of(scene)]


def in_words(scene: Scene, name: str, value: float) -> str:
    """One of EFFECTS of a scene that has it, at a value."""
    if name == "finger":
        return f"a finger of about {_about(1e12 * value)} pF"
    around = scene_with(scene, {name: value}).surroundings
    assert around is not None
    if name == "rim":
        rim = rim_densities(scene_with(scene, {name: value}))
        return f"a rim of about {_about(1e12 * max(rim.mutual, rim.top, rim.bottom))} pF/m"
    nearest = max(around.body, key=lambda body: body.per_area)
    if nearest.distance is None:
        return f"a body of about {nearest.per_area:.2g} F/m²"
    return f"a body at about {_about(1e3 * nearest.distance)} mm"


def _about(value: float) -> str:
    """To two digits."""
    return f"{float(f'{value:.2g}'):g}"


def gains(fit: Fit, freedom: float, progress: ProgressCallback = silent) -> list[str]:
    """What each of EFFECTS that the scene has not would leave beside what was fitted, a line each.

    freedom: of the fit. Nothing where the fit explains the readings.
    """
    asked, left = fit.spec, fit.chi_squared / freedom
    if left < EXPLAINED or not addable(asked.measurements.scene):
        return []
    try:
        trials = Trials(asked, fit.values, progress)
        found = {name: trials.fit(name) for name in trials.names}
    except (InputError, ToleranceError) as error:
        return [f"what surrounds the skin was not tried: {error}"]
    lines = [
        f"{trials.in_words(each, name)} beside what is fitted would leave "
        f"{each.chi_squared / (freedom - 1):.3g} of chi-squared per degree of freedom in place of "
        f"{left:.3g}; --also {name} fits it"
        for name, each in sorted(found.items(), key=lambda pair: pair[1].chi_squared)
        if each.chi_squared < (1 - WORTH) * fit.chi_squared
    ]
    return lines or ["neither a body near the skin nor its rim nor a finger explains what is left"]


class Trials:
    """Each of EFFECTS that a scene has not, fitted beside what a problem has already."""

    def __init__(
        self, asked: FitSpec, at: dict[str, float], progress: ProgressCallback = silent
    ) -> None:
        """asked: of the scene without them. at: values of its parameters that a fit begins at."""
        self.names = addable(asked.measurements.scene)
        scene = surrounded(asked.measurements.scene, self.names)
        none = {name: NONE[name] for name in self.names}
        self.asked = replace(
            asked,
            measurements=replace(asked.measurements, scene=scene),
            fixed={**asked.fixed, **none},
        )
        self._at = at
        self._ready: Around = around(scene, at, certificate_limit(asked), progress)

    def fit(
        self,
        name: str,
        beside: Mapping[str, Prior] = MappingProxyType({}),
        at: Mapping[str, float] = MappingProxyType({}),
    ) -> Fit:
        """The best fit with one of them. beside: priors of parameters that are fitted with it. at:
        values that these begin at."""
        own = {name: effect_prior(self.asked.measurements, name)}
        both = {**self.asked.fitted, **beside, **own}
        fixed = {n: value for n, value in self.asked.fixed.items() if n not in both}
        asked = replace(self.asked, fitted=both, fixed=fixed)
        return solve_from(LeastSquaresProblem(asked, self._ready), {**self._at, **at, name: 0.0})

    def in_words(self, fit: Fit, name: str) -> str:
        """What it found of one."""
        return in_words(self.asked.measurements.scene, name, fit.values[name])

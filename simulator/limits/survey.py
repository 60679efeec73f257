"""Survey of the bound on position over frequencies, interfaces and sheet resistance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Real
from ..bounds.field_choice import fields_of
from ..bounds.frequency_sets import OPTIMAL, candidates_of, compared, own_band
from ..bounds.full_fields import CELLS_PER_PIXEL
from ..bounds.position_bound import (
    PlaceLikelihood,
    PositionBounds,
    TouchSize,
    errors_of_places,
    place_likelihood,
    places_on,
)
from ..bounds.rasterization_errors import RasterizationErrors
from ..progress import ProgressCallback, silent
from ..scene.parts import SceneParts, Setup, Skin
from ..scene.scene import Scene
from ..sweeps import InputError
from ..sweeps.press_text import parse_touches
from .frequency_design import GRID, best_set, position_criterion, sampled_positions

FREQUENCIES, INTERFACES, SHEETS = "frequencies", "interfaces", "sheets"
FLOATING = "floating"
"""Text of the finger of a person without connection to earth."""


@dataclass(frozen=True)
class Variant:
    """One variant of a comparison: name of the comparison, own name, and bounds.

    frequency: all frequencies of any interface, Hz.
    """

    comparison: str
    name: str
    bounds: PositionBounds
    frequency: Real


@dataclass(frozen=True)
class SurveyOptions:
    """Options of a survey: touch, number of baseline sweeps (`against_rest`), unknown skin.

    by_depth: True if the scene presses by depth, which also changes the foam next to a touch.
    """

    touch: TouchSize
    against_rest: int = 0
    unknown_skin: bool = False
    by_depth: bool = False

    @property
    def assumptions(self) -> str:
        """Text of what the estimate of the bounds knows and what it does not."""
        size = f"{1e3 * self.touch.width:.3g} x {1e3 * self.touch.height:.3g} mm"
        skin = "" if self.unknown_skin else "the skin and "
        by_depth = (
            "; presses by depth: the strength is that under the touch" if self.by_depth else ""
        )
        sought = ["x", "y", "strength"]
        if self.touch.finger:
            sought.append(f"the capacitance of the finger ({1e12 * self.touch.finger:.3g} pF)")
        if self.unknown_skin:
            sought.append("the skin as dataset.session draws it")
        return (
            f"the estimator knows {skin}the sides of the touch, {size}; it estimates "
            f"{', '.join(sought[:-1])} and {sought[-1]} from the sweep alone{by_depth}"
        )


def survey(
    parts: SceneParts,
    options: SurveyOptions,
    sheet_resistances: Sequence[float] = (),
    n: int | None = None,
    progress: ProgressCallback = silent,
) -> list[Variant]:
    """Bounds of all variants of frequencies, interfaces and sheet resistance.

    Frequencies are the scene's, n by Eq. 6, n in logarithmic spacing, and n optimal ones.
    Interfaces are each alone and all together. sheet_resistances: ohm/sq. n: by default the number
    of pixels from the driven edge.
    """
    n = n or _pixels_from_edge(parts.skin, parts.setup)
    slopes = _slopes(
        parts,
        options,
        candidates_of(parts.skin, parts.setup, n, own_band(parts.setup), GRID),
        progress,
    )
    own = parts.setup.frequency
    name = f"the scene's {len(own)}" if parts.setup.taken is None else "the scene's own"
    everything = Variant(FREQUENCIES, name, slopes.bounds(own, taken=parts.setup.taken), own)
    sets = _sets(parts.skin, parts.setup, slopes, n)
    others = (Variant(FREQUENCIES, name, slopes.bounds(f), f) for name, f in sets.items())
    variants = [everything, *others]
    if len(parts.setup.interfaces) > 1:
        for number, interface in enumerate(parts.setup.interfaces):
            its = parts.setup.frequency_at(interface.name)
            alone = slopes.bounds(its, [number])
            variants.append(Variant(INTERFACES, interface.name, alone, its))
        variants.append(Variant(INTERFACES, "all together", everything.bounds, own))
    for resistance in sheet_resistances:
        of_sheets = _slopes(with_sheets(parts, resistance), options, own, progress)
        name, bounds = f"{1e-3 * resistance:g} kohm/sq", of_sheets.bounds(taken=parts.setup.taken)
        variants.append(Variant(SHEETS, name, bounds, own))
    return variants


def survey_rasterization_errors(
    parts: SceneParts, options: SurveyOptions
) -> RasterizationErrors | None:
    """Errors of touches by depth rasterized on cells, for the scene's own variant."""
    if not options.by_depth:
        return None
    fields = fields_of(parts, float(parts.setup.frequency[-1]), options.touch)
    places = places_on(parts.skin, options.touch, CELLS_PER_PIXEL)
    return errors_of_places(fields, places, options.touch)


def with_sheets(parts: SceneParts, sheet_resistance: float) -> SceneParts:
    """The parts with another resistance of the sheets, but not of earth, ohm/sq.

    Raises InputError.
    """
    if not (np.isfinite(sheet_resistance) and sheet_resistance > 0):
        raise InputError(
            f"--sheet-resistance must be finite and > 0 ohm/sq, got {sheet_resistance:g}"
        )
    skin = parts.skin
    names = ("top",) if skin.one_conductor else ("top", "bottom")
    changed = {"sheet_resistance": sheet_resistance}
    sheets = {name: skin.sheet(name).model_copy(update=changed) for name in names}
    return replace(parts, skin=skin.with_parts(**sheets))


def with_factor(parts: SceneParts, factor: float) -> SceneParts:
    """The parts pressed to `factor` times the unpressed capacitance."""
    press = parts.plan.press
    by = {"capacitance_factor": factor} if press.by_factor else {}
    by = by or {"depth": parts.skin.pressed_depth(factor)}
    return parts.pressed_by(press.model_copy(update=by))


def with_finger(scene: Scene, text: str | None) -> Scene:
    """The scene with a finger given as text, as in the text of a press or "floating".

    None keeps the scene's own finger. Raises InputError.
    """
    if text is None:
        return scene
    if text == FLOATING:
        return scene.with_({"press.finger": FLOATING})
    try:
        (touch,) = parse_touches(f"1,1:1:{text}")
    except InputError as error:
        raise InputError(
            "--finger must be finger, floating, rod or a capacitance from 0 to 1e-6 F such as "
            f"5.3pF, got {text}"
        ) from error
    return scene.with_({"press.finger": touch.finger or None})


def with_interfaces(parts: SceneParts, names: Sequence[str]) -> SceneParts:
    """The parts with some of the interfaces; with all of them for no names. Raises InputError."""
    known = parts.setup.names
    for name in names:
        if name not in known:
            raise InputError(f"--interface must be one of {', '.join(known)}, got {name!r}")
    return parts.read(parts.setup.of([name for name in known if name in names])) if names else parts


def _slopes(
    parts: SceneParts, options: SurveyOptions, frequency: Real, progress: ProgressCallback
) -> PlaceLikelihood:
    fields = fields_of(parts, float(frequency[-1]), options.touch)
    return place_likelihood(
        fields,
        places_on(parts.skin, options.touch, CELLS_PER_PIXEL),
        options.touch,
        frequency,
        against_rest=options.against_rest,
        unknown_skin=options.unknown_skin,
        progress=progress,
    )


def _pixels_from_edge(skin: Skin, setup: Setup) -> int:
    edge = skin.contact(setup.interfaces[0].high[0]).edge
    return skin.pixels.columns if edge in ("left", "right") else skin.pixels.rows


def _sets(skin: Skin, setup: Setup, slopes: PlaceLikelihood, n: int) -> dict[str, Real]:
    named = compared(skin, setup, n, own_band(setup))
    try:
        criterion = position_criterion(sampled_positions(slopes))
    except InputError:  # no set resolves the position, so there is no best one
        return {f"{n}, {name}": f for name, f in named.items()}
    every, others = np.arange(len(slopes.frequency)), map(slopes.number, named.values())
    best = best_set(criterion, slopes.frequency, every, n, others)
    return {f"{n}, {name}": f for name, f in (named | {OPTIMAL: slopes.frequency[best]}).items()}

"""Variants of a scene's geometry: other positions and lengths of its foils, graded sheets."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial

from ..scene.design_goals import Design
from ..scene.parts import Skin
from ..scene.scene import Scene
from ..sweeps import InputError
from .reading_pool import terminals

LENGTHS, PLACES = 3, (0.0, 0.5, 1.0)
"""Number of lengths of a foil within its bounds, and its positions between the ends of its edge."""
MIN_GRADING = 1.0 + 1e-9


Others = Callable[[Scene], list[Scene]]
"""Function from a scene to its variants in one property."""


def geometries(skin: Skin, request: Design) -> list[tuple[str, Others]]:
    """Properties of the geometry that may change, by name; empty where all are fixed.

    Foils on one edge with the same span on both sheets move together. Both sheets are graded
    together, along x or y, unless they have maps already.
    """
    found: list[tuple[str, Others]] = []
    if request.foils and skin.rectangular:
        same_span: dict[tuple[str, tuple[float, float]], list[str]] = {}
        for contact in skin.contacts:
            same_span.setdefault((contact.edge, contact.span), []).append(contact.name)
        for (edge, _), names in same_span.items():
            found.append((f"foils on the {edge} edge", partial(moved, names, request.foil_length)))
    uniform = skin.top.map is None and skin.bottom.map is None
    if request.grading > MIN_GRADING and uniform:
        found.append(("graded sheets", partial(graded, request.grading)))
    return found


def moved(names: Sequence[str], bounds: tuple[float, float], scene: Scene) -> list[Scene]:
    """Scenes with these foils at other positions on their edge, all with the same span.

    bounds: of their length over that of the edge. Scenes in which terminals touch are left out.
    """
    own = scene.parts.skin.contact(names[0]).span
    made = [
        _with(scene, {f"contact.{name}.span": list(span) for name in names})
        for span in _spans(bounds)
        if span != own
    ]
    wires = len(terminals(scene.parts.skin))
    return [each for each in made if each is not None and len(terminals(each.parts.skin)) == wires]


def graded(largest: float, scene: Scene) -> list[Scene]:
    """Scenes with both sheets graded along x or y, up or down. largest: ratio of the ends."""
    made = []
    for ratio in (math.sqrt(largest), largest):
        rise = 2 * (ratio - 1) / (ratio + 1)
        for axis, sign in (("x", 1), ("x", -1), ("y", 1), ("y", -1)):
            gradient = {"kind": "gradient", axis: sign * rise}
            made.append(_with(scene, {f"skin.{name}.map": gradient for name in ("top", "bottom")}))
    return [each for each in made if each is not None]


def _spans(bounds: tuple[float, float]) -> list[tuple[float, float]]:
    """Spans on an edge; all foils keep the margin of the longest one from its ends."""
    low, high = bounds
    margin, found = (1 - high) / 2, []
    for k in range(LENGTHS):
        length = low + (high - low) * k / (LENGTHS - 1)
        room = 1 - 2 * margin - length
        for place in PLACES:
            start = round(margin + place * room, 4)
            found.append((start, round(start + length, 4)))
    return list(dict.fromkeys(found))


def _with(scene: Scene, keys: Mapping[str, object]) -> Scene | None:
    """The scene with changed keys; None where foils would overlap or nearly touch."""
    try:
        return scene.with_(keys)
    except InputError:
        return None

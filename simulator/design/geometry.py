"""Skins beside a scene's own: other places and lengths of its foils, graded sheets."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial

from ..scene.design_goals import Design
from ..scene.scene import Scene
from ..sweeps import InputError
from .pool import terminals

LENGTHS, PLACES = 3, (0.0, 0.5, 1.0)
"""Of a foil: how many within its bounds, and where between both ends of its edge."""
UNEVEN = 1.0 + 1e-9


Others = Callable[[Scene], list[Scene]]
"""A scene with one thing in all other ways that are looked at."""


def geometries(scene: Scene, asked: Design) -> list[tuple[str, Others]]:
    """What of a geometry may change, by name; nothing where all of it is to stay.

    Foils on one edge that lie alike on both sheets move together; sheets are graded together, along
    x or y, where they do not vary already.
    """
    found: list[tuple[str, Others]] = []
    if asked.foils and scene.skin.rectangular:
        alike: dict[tuple[str, tuple[float, float]], list[str]] = {}
        for contact in scene.contacts:
            alike.setdefault((contact.edge, contact.span), []).append(contact.name)
        for (edge, _), names in alike.items():
            found.append((f"foils on the {edge} edge", partial(moved, names, asked.foil_length)))
    even = scene.skin.top.map is None and scene.skin.bottom.map is None
    if asked.grading > UNEVEN and even:
        found.append(("graded sheets", partial(graded, asked.grading)))
    return found


def moved(names: Sequence[str], bounds: tuple[float, float], scene: Scene) -> list[Scene]:
    """With foils of these names elsewhere on their edge, all alike. bounds: of their length over
    that of the edge. As many terminals stay apart."""
    own = scene.contact(names[0]).span
    made = [
        _with(scene, {f"contact.{name}.span": list(span) for name in names})
        for span in _spans(bounds)
        if span != own
    ]
    wires = len(terminals(scene))
    return [each for each in made if each is not None and len(terminals(each)) == wires]


def graded(most: float, scene: Scene) -> list[Scene]:
    """With both sheets rising along x or y, or falling. most: of one end over the other."""
    made = []
    for ratio in (math.sqrt(most), most):
        rise = 2 * (ratio - 1) / (ratio + 1)
        for axis, sign in (("x", 1), ("x", -1), ("y", 1), ("y", -1)):
            gradient = {"kind": "gradient", axis: sign * rise}
            made.append(_with(scene, {f"skin.{name}.map": gradient for name in ("top", "bottom")}))
    return [each for each in made if each is not None]


def _spans(bounds: tuple[float, float]) -> list[tuple[float, float]]:
    """Over an edge; foils keep as far from its ends as the longest of them does."""
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
    """The scene with keys changed; None where foils would then overlap or nearly touch."""
    try:
        return scene.with_(keys)
    except InputError:
        return None

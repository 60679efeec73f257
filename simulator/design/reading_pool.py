"""All readings between given wires: any two disjoint sets of terminals, the others floating."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial

from ..scene.contacts import Interface
from ..scene.design_goals import Design
from ..scene.parts import Setup, Skin
from ..scene.scene import Scene
from ..scene.wiring_checks import conductor_groups
from ..sweeps import InputError

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


ALL_SETS = 5
"""Largest number of wires with sets of any size; with more wires, sets have at most two."""

Sets = tuple[frozenset[str], frozenset[str]]


def terminals(skin: Skin) -> list[str]:
    """The first foil of each terminal. Foils that touch are one terminal with one wire."""
    first = conductor_groups(skin.contacts, skin)
    return [skin.contacts[k].name for k in sorted(set(first))]


def wirings(skin: Skin, wires: int) -> list[tuple[str, ...]]:
    """All combinations of terminals with a given number of wires."""
    names = terminals(skin)
    return list(itertools.combinations(names, min(wires, len(names))))


READER = ("reader", "series_resistance", "source_scale", "load", "magnitude_only")
"""Keys of an interface that say how it is read."""


def pool(skin: Skin, setup: Setup, wired: Sequence[str]) -> list[Interface]:
    """Readings between wired terminals; readings of the scene keep their names and readers.

    Others are read as the first one of the scene.
    """
    own = {_sets(skin, each): each for each in setup.interfaces}
    found = []
    for high, low in _disjoint(wired):
        one, other = frozenset(high), frozenset(low)
        known = own.get((one, other)) or own.get((other, one))
        name = known.name if known else f"{'+'.join(high)} to {'+'.join(low)}"
        like = known or setup.interfaces[0]
        reader = {key: getattr(like, key) for key in READER} if setup.gain else {}
        found.append(Interface(name=name, high=high, low=low, **reader))
    return found


def own_readings(skin: Skin, setup: Setup, of: Sequence[Interface]) -> list[int]:
    """Indices of the scene's own readings in a pool, without those that need other wires."""
    indices = {frozenset(_sets(skin, each)): k for k, each in enumerate(of)}
    sets = [frozenset(_sets(skin, each)) for each in setup.interfaces]
    return [indices[each] for each in dict.fromkeys(sets) if each in indices]


def _disjoint(wired: Sequence[str]) -> Iterator[tuple[tuple[str, ...], tuple[str, ...]]]:
    largest = len(wired) if len(wired) <= ALL_SETS else 2
    sets = [s for n in range(1, largest + 1) for s in itertools.combinations(wired, n)]
    for high, low in itertools.combinations(sets, 2):
        if not set(high) & set(low):
            yield high, low


def _sets(skin: Skin, reading: Interface) -> Sets:
    """Both sides of a reading, each as the first foils of its terminals."""
    first = conductor_groups(skin.contacts, skin)
    leader = {c.name: skin.contacts[k].name for c, k in zip(skin.contacts, first, strict=True)}
    high, low = (frozenset(leader[name] for name in side) for side in (reading.high, reading.low))
    return high, low

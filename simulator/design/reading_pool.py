"""All readings between given wires: any two disjoint sets of terminals, the others floating."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

from ..scene.parts import Setup, Skin
from ..scene.readings.contacts import Interface
from ..scene.readings.wiring_checks import conductor_groups
from ..sweeps import InputError

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


def check_readers(skin: Skin, setup: Setup) -> None:
    """Raises InputError for readers whose wires cannot be chosen."""
    if skin.one_conductor:
        raise InputError(
            f"{skin.name}: a design chooses the wires of two sheets; a skin of one conductor has "
            "one sheet"
        )
    if any(each.driven_with for each in setup.interfaces):
        raise InputError(
            f"{skin.name}: a design chooses readings with one source each: leave out "
            "`driven_with` of the interfaces"
        )


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

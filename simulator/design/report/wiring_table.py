"""Wiring table: the wires that a switch connects to H and to L for each reading."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from ...scene.parts import Skin
from ...scene.readings.contacts import Interface
from ...scene.readings.wiring_checks import conductor_groups


class WiringRow(NamedTuple):
    """One reading: its name, wires on the high and the low side, and open wires."""

    reading: str
    high: str
    low: str
    open: str


def rows(skin: Skin, wired: Sequence[str], readings: Sequence[Interface]) -> list[WiringRow]:
    """A row for each reading. wired: first foils of the terminals that have a wire."""
    first = conductor_groups(skin.contacts, skin)
    leader = {c.name: skin.contacts[k].name for c, k in zip(skin.contacts, first, strict=True)}
    found = []
    for each in readings:
        high, low = ({leader[name] for name in side} for side in (each.high, each.low))
        sides = (
            [name for name in wired if name in high],
            [name for name in wired if name in low],
            [name for name in wired if name not in high | low],
        )
        found.append(WiringRow(each.name, *map(" + ".join, sides)))
    return found

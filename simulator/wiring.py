"""Whether the contacts of a scene can be where they are and be connected as its interfaces say."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from simulator.scene import Contact, Scene, Skin


LEAST_GAP = 5e-6


def touch(first: Contact, second: Contact, skin: Skin) -> bool:
    """Whether two foils of one electrode meet end to end: on one edge, or at a corner."""
    return any(touch_at(end, first, second, skin) for end in first.ends(skin))


def touch_at(end: tuple[float, float], first: Contact, second: Contact, skin: Skin) -> bool:
    """Whether two foils of one electrode meet at that end of the first."""
    near = 1e-9 * max(skin.length, skin.width)
    return first.electrode == second.electrode and any(
        math.dist(end, other) <= near for other in second.ends(skin)
    )


def joined(contacts: Sequence[Contact], skin: Skin) -> list[int]:
    """For each contact the index of the first one it is one conductor with.

    Ideal foils that touch carry any current between them (the sheet's current density between two
    potentials that meet at a point diverges), so they are one terminal.
    """
    group = list(range(len(contacts)))
    for i, j in itertools.combinations(range(len(contacts)), 2):
        if contacts[i].ideal and contacts[j].ideal and touch(contacts[i], contacts[j], skin):
            merged, kept = max(group[i], group[j]), min(group[i], group[j])
            group = [kept if member == merged else member for member in group]
    return group


def check_wiring(scene: Scene) -> None:
    """Raise ValueError for names that repeat or do not exist, foils that overlap, and shorts."""
    _check_distinct("contact", [contact.name for contact in scene.contacts])
    _check_distinct("interface", [interface.name for interface in scene.interfaces])
    for first, second in itertools.combinations(scene.contacts, 2):
        if _overlap(first, second):
            raise ValueError(f"contacts {first.name!r} and {second.name!r} overlap")
        if _nearly_touch(first, second, scene.skin):
            raise ValueError(
                f"contacts {first.name!r} and {second.name!r} must touch, or end at least "
                f"{LEAST_GAP:g} of the skin's longer side apart"
            )
    names = [contact.name for contact in scene.contacts]
    terminal = dict(zip(names, joined(scene.contacts, scene.skin), strict=True))
    for interface in scene.interfaces:
        for name in (*interface.high, *interface.low):
            if name not in terminal:
                raise ValueError(
                    f"interface {interface.name!r} names the contact {name!r}; "
                    f"there are {', '.join(names)}"
                )
        high, low = ({terminal[name] for name in side} for side in (interface.high, interface.low))
        if high & low:
            raise ValueError(f"interface {interface.name!r} shorts its high and low side")


def _check_distinct(kind: str, names: Sequence[str]) -> None:
    repeated = {name for name in names if names.count(name) > 1}
    if repeated:
        raise ValueError(f"{kind} name {min(repeated)!r} is used more than once")


def _nearly_touch(first: Contact, second: Contact, skin: Skin) -> bool:
    """A gap too narrow to be resolved in double precision."""
    return (
        first.electrode == second.electrode
        and not touch(first, second, skin)
        and any(
            math.dist(a, b) < LEAST_GAP * max(skin.length, skin.width)
            for a, b in itertools.product(first.ends(skin), second.ends(skin))
        )
    )


def _overlap(first: Contact, second: Contact) -> bool:
    return (
        (first.electrode, first.edge) == (second.electrode, second.edge)
        and first.span[0] < second.span[1]
        and second.span[0] < first.span[1]
    )

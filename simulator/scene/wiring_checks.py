"""Checks of the positions of contacts and of their connection by interfaces.

A scene with `bottom = "earth"` has one conductor: earth, without resistance, below the one sheet.
It has a contact below each contact of that sheet, so that all models of two sheets apply; the scene
file names none of them.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from pydantic import BaseModel

from ..arrays import Mask, Real
from .contacts import check_edge, curve_section
from .mesh_file import foil_lines
from .readers import check_readers
from .skin import EARTH, Earth
from .validation import short

if TYPE_CHECKING:
    from .contacts import Contact, Interface
    from .skin import SheetsAndFoam

MIN_GAP = 5e-6
"""Smallest length of a gap between foils, and of a foil, over the skin's longer side. Shorter ones
are not resolved in double precision."""


def touch(first: Contact, second: Contact, skin: SheetsAndFoam) -> bool:
    """True if two foils of one electrode meet end to end: on one edge, or at a corner."""
    if skin.mesh is not None:
        a, b = _lines(first, skin), _lines(second, skin)
        return first.electrode == second.electrode and len(np.intersect1d(a, b)) > 0
    return any(touch_at(end, first, second, skin) for end in first.ends(skin))


def touch_at(
    end: tuple[float, float], first: Contact, second: Contact, skin: SheetsAndFoam
) -> bool:
    """True if two foils of one electrode meet at a given end of the first one."""
    near = 1e-9 * max(skin.length, skin.width)
    return first.electrode == second.electrode and any(
        math.dist(end, other) <= near for other in second.ends(skin)
    )


def conductor_groups(contacts: Sequence[Contact], skin: SheetsAndFoam) -> list[int]:
    """Index of the first contact of the conductor to which each contact belongs.

    Ideal foils that touch are one terminal, because the current between them has no limit: the
    current density of the sheet diverges between two potentials that meet at a point.
    """
    group = list(range(len(contacts)))
    for i, j in itertools.combinations(range(len(contacts)), 2):
        if contacts[i].ideal and contacts[j].ideal and touch(contacts[i], contacts[j], skin):
            merged, kept = max(group[i], group[j]), min(group[i], group[j])
            group = [kept if member == merged else member for member in group]
    return group


class DrivenByTouch(NamedTuple):
    """Contacts that float at an interface although they are one terminal with driven ones.

    floating, driven: names; each driven contact touches one of the floating ones.
    """

    interface: str
    floating: tuple[str, ...]
    driven: tuple[str, ...]

    def __str__(self) -> str:
        s, es = ("s", "es") if len(self.floating) == 1 else ("", "")
        are = "is" if len(self.driven) == 1 else "are"
        both = "both" if len(self.floating + self.driven) == 2 else "all"
        return (
            f"contact{'' if s else 's'} {_listed(self.floating)} float{s} at interface "
            f"{self.interface!r} but touch{es} {_listed(self.driven)}, which {are} driven: "
            f"{both} are one terminal"
        )


def driven_by_touch(
    contacts: Sequence[Contact], interfaces: Sequence[Interface], skin: SheetsAndFoam
) -> list[DrivenByTouch]:
    """Floating contacts that are driven because they touch driven ones, for each interface."""
    group = conductor_groups(contacts, skin)
    terminals = [
        [c for c, own in zip(contacts, group, strict=True) if own == leader]
        for leader in sorted(set(group))
    ]
    each = itertools.product(interfaces, terminals)
    found = [_driven_by_touch(interface, foils, skin) for interface, foils in each]
    return [one for one in found if one.driven]


def _driven_by_touch(
    interface: Interface, foils: Sequence[Contact], skin: SheetsAndFoam
) -> DrivenByTouch:
    """Floating foils of one terminal, and the driven ones that touch them."""
    named = {*interface.high, *interface.low}
    floating = [foil for foil in foils if foil.name not in named]
    driven = tuple(
        foil.name
        for foil in foils
        if foil.name in named and any(touch(foil, other, skin) for other in floating)
    )
    return DrivenByTouch(interface.name, tuple(foil.name for foil in floating), driven)


def check_wiring(
    contacts: Sequence[Contact], interfaces: Sequence[Interface], skin: SheetsAndFoam
) -> None:
    """Raises ValueError for invalid contacts or interfaces.

    They are invalid if names are repeated or unknown, if foils overlap, nearly touch, or do not
    fit the skin, and if an interface shorts its high and low side.
    """
    _check_distinct("contact", [contact.name for contact in contacts])
    _check_distinct("interface", [interface.name for interface in interfaces])
    _check_edges(contacts, skin)
    for first, second in itertools.combinations(contacts, 2):
        if _overlap(first, second, skin):
            raise ValueError(f"contacts {first.name!r} and {second.name!r} overlap")
        if skin.mesh is None and _nearly_touch(first, second, skin):
            raise ValueError(
                f"contacts {first.name!r} and {second.name!r} must touch, or end at least "
                f"{MIN_GAP:g} of the skin's longer side apart"
            )
    check_widths(contacts, skin)
    names = [contact.name for contact in contacts]
    terminal = dict(zip(names, conductor_groups(contacts, skin), strict=True))
    for interface in interfaces:
        for name in (*interface.high, *interface.low):
            if name not in terminal:
                raise ValueError(
                    f"interface {interface.name!r} names the contact {name!r}; "
                    f"there are {', '.join(names)}"
                )
        high, low = ({terminal[name] for name in side} for side in (interface.high, interface.low))
        if high & low:
            raise ValueError(f"interface {interface.name!r} shorts its high and low side")
    check_readers(interfaces, terminal)


def _listed(names: Sequence[str]) -> str:
    *most, last = map(repr, names)
    return f"{', '.join(most)} and {last}" if most else last


def _check_distinct(kind: str, names: Sequence[str]) -> None:
    repeated = {name for name in names if names.count(name) > 1}
    if repeated:
        raise ValueError(f"{kind} name {min(repeated)!r} is used more than once")


def _nearly_touch(first: Contact, second: Contact, skin: SheetsAndFoam) -> bool:
    """True if the gap between two foils is too narrow for double precision."""
    return (
        first.electrode == second.electrode
        and not touch(first, second, skin)
        and any(
            math.dist(a, b) < MIN_GAP * max(skin.length, skin.width)
            for a, b in itertools.product(first.ends(skin), second.ends(skin))
        )
    )


def _overlap(first: Contact, second: Contact, skin: SheetsAndFoam) -> bool:
    if first.electrode != second.electrode:
        return False
    if skin.mesh is not None:
        both = np.concatenate([_lines(first, skin), _lines(second, skin)], axis=1)
        return np.unique(both, axis=1).shape[1] < both.shape[1]
    a, b = curve_section(first, skin), curve_section(second, skin)
    rounding = 1e-9 * max(skin.length, skin.width)
    return a.curve == b.curve and min(a.stop, b.stop) - max(a.start, b.start) > rounding


def _check_edges(contacts: Sequence[Contact], skin: SheetsAndFoam) -> None:
    for number, contact in enumerate(contacts):
        if skin.mesh is None:
            allowed = check_edge(contact.edge, skin)
            if allowed is not None:
                raise ValueError(f"`contact[{number + 1}].edge` {allowed}, got {contact.edge!r}")
            _check_length(number, contact, skin)
        elif contact.span != (0, 1):
            raise ValueError(
                f"`contact[{number + 1}].span` must be [0, 1] on a mesh, got {contact.span}"
            )
        else:
            _lines(contact, skin)


def _check_length(number: int, contact: Contact, skin: SheetsAndFoam) -> None:
    """Raises ValueError for a foil that is too short for double precision."""
    along, smallest = curve_section(contact, skin), MIN_GAP * max(skin.sides)
    if along.stop - along.start < smallest:
        raise ValueError(
            f"`contact[{number + 1}].span` must leave a foil of at least {short(smallest)} m, "
            f"{MIN_GAP:g} of the skin's longer side, got {short(along.stop - along.start)} m"
        )


def check_widths(contacts: Sequence[Contact], skin: SheetsAndFoam) -> None:
    """Raises ValueError for a foil that is wider than the skin, and for two foils that overlap."""
    for number, contact in enumerate(contacts):
        across = min(skin.sides) if contact.edge not in ACROSS else skin.sides[ACROSS[contact.edge]]
        if not contact.width < across:
            raise ValueError(
                f"`contact[{number + 1}].width` must be < {short(across)} m, the skin's extent "
                f"from that edge, got {short(contact.width)} m"
            )
    group = conductor_groups(contacts, skin)
    for (i, first), (j, second) in itertools.combinations(enumerate(contacts), 2):
        separate = first.electrode != second.electrode or group[i] == group[j]
        wide = skin.rectangular and max(first.width, second.width) > 0
        if wide and not separate and _meet(first, second, skin):
            raise ValueError(
                f"contacts {first.name!r} and {second.name!r} overlap by `contact.width`: "
                f"{short(first.width)} and {short(second.width)} m"
            )


ACROSS = {"left": 0, "right": 0, "bottom": 1, "top": 1}
"""Axis of a rectangle along which a foil's width is measured, by the edge of the foil."""


def strip(contact: Contact, skin: SheetsAndFoam) -> Real:
    """Part of a rectangle that a foil covers: its lowest and highest corner (x, y), m."""
    axis = ACROSS[contact.edge]
    inwards = contact.width if contact.edge in ("left", "bottom") else -contact.width
    ends = np.array(contact.ends(skin))
    ends[:, axis] += [0.0, inwards]
    return np.sort(ends, axis=0)


def under_foil(contact: Contact, skin: SheetsAndFoam, x: Real) -> Mask:
    """True where a wide foil covers positions x of a rectangle, m, shape (2, ...) to (...)."""
    if not contact.width:
        return np.zeros(x.shape[1:], dtype=bool)
    low, high = (corner.reshape(2, *(1,) * (x.ndim - 1)) for corner in strip(contact, skin))
    return ((low < x) & (x < high)).all(axis=0)


def _meet(first: Contact, second: Contact, skin: SheetsAndFoam) -> bool:
    """True if two foils on a rectangle overlap, or are closer than MIN_GAP allows."""
    one, other = strip(first, skin), strip(second, skin)
    gaps = np.maximum(one[0], other[0]) - np.minimum(one[1], other[1])
    return bool((gaps < MIN_GAP * max(skin.sides)).all())


def _lines(contact: Contact, skin: SheetsAndFoam) -> np.ndarray:
    """Facets of a foil on a mesh as numbers of points, shape (2, facet)."""
    assert skin.mesh is not None
    return foil_lines(skin.mesh.surface, contact.edge, skin.mesh.source)


BELOW = "earth below "
"""Start of the name of a contact of earth, before the name of the contact above it."""
NEEDS_EARTH = 'needs `skin.bottom = "earth"`, a skin of one conductor'


def with_earth(tables: Mapping[str, Any]) -> dict[str, Any]:
    """Tables of a scene with contacts of earth, and interfaces that name them.

    Raises ValueError naming a key that suits no skin of one conductor, and for an interface to
    earth in a skin of two sheets.
    """
    interfaces = [_table(each) for each in _as_list(tables.get("interface"))]
    if not _on_earth(tables.get("skin")):
        for number, each in enumerate(interfaces):
            if _names_earth(each):
                raise ValueError(f"`interface[{number + 1}].low` = {EARTH!r} {NEEDS_EARTH}")
        return dict(tables)
    for key in ("readings", "surroundings"):
        if tables.get(key) is not None:
            raise ValueError(
                f'`{key}` describes skins of two sheets: leave it out with `skin.bottom = "earth"`'
            )
    contacts = [{"electrode": "top", **_table(c)} for c in _as_list(tables.get("contact"))]
    for number, each in enumerate(contacts):
        if each.get("electrode") == "bottom":
            raise ValueError(
                f'`contact[{number + 1}].electrode` must be "top": the bottom sheet is earth'
            )
    for number, each in enumerate(interfaces):
        if any(name.startswith(BELOW) for name in _high(each)):
            raise ValueError(f"`interface[{number + 1}].high` must not name contacts of earth")
        if not _names_earth(each):
            raise ValueError(
                f'`interface[{number + 1}].low` must be "earth" in a skin of one conductor, '
                f"got {each.get('low')!r}"
            )
    below = [_below(each) for each in contacts if isinstance(each.get("name"), str)]
    to_earth = [_to_earth(each) for each in interfaces]
    return {**tables, "contact": [*contacts, *below], "interface": to_earth}


def without_earth(tables: dict[str, Any]) -> dict[str, Any]:
    """Tables of a skin of one conductor as in its file: the inverse of `with_earth`."""
    kept = dict(tables)
    for name in ("contact", "contacts"):
        if name in kept:
            kept[name] = type(kept[name])(c for c in kept[name] if c["electrode"] != "bottom")
    for name in ("interface", "interfaces"):
        if name in kept:
            kept[name] = type(kept[name])(_as_given(each) for each in kept[name])
    return kept


def _as_given(interface: dict[str, Any]) -> dict[str, Any]:
    """An interface as in its file, with the sources that are on at the same time."""
    on = interface.get("driven_with", ())
    others = [_as_given(each) if isinstance(each, dict) else each for each in on]
    return {**interface, "low": EARTH, **({"driven_with": others} if others else {})}


def _to_earth(interface: Mapping[str, Any]) -> dict[str, Any]:
    """An interface, or a source, with the contacts of earth below its own ones as its low side."""
    below = [f"{BELOW}{name}" for name in _high(interface)]
    on = interface.get("driven_with")
    if not isinstance(on, list | tuple):
        return {**interface, "low": below}
    others = [_to_earth(each) if isinstance(each, Mapping) else each for each in on]
    return {**interface, "low": below, "driven_with": others}


def _on_earth(skin: Any) -> bool:
    bottom = skin.get("bottom") if isinstance(skin, dict) else getattr(skin, "bottom", None)
    return isinstance(bottom, Earth | str)


def _names_earth(interface: Mapping[str, Any]) -> bool:
    return interface.get("low") in (EARTH, [EARTH], (EARTH,))


def _below(contact: Mapping[str, Any]) -> dict[str, Any]:
    return {**contact, "name": f"{BELOW}{contact['name']}", "electrode": "bottom", "resistance": 0}


def _high(interface: Mapping[str, Any]) -> list[str]:
    high = interface.get("high")
    return (
        [name for name in high if isinstance(name, str)] if isinstance(high, list | tuple) else []
    )


def _as_list(given: Any) -> Sequence[Any]:
    return given if isinstance(given, list | tuple) else ()


def _table(given: Any) -> dict[str, Any]:
    if isinstance(given, BaseModel):
        return given.model_dump(by_alias=True, exclude_unset=True)
    return given if isinstance(given, dict) else {}

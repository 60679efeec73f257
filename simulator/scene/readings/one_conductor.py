"""Skins of one conductor: the contacts and interfaces that a scene with `bottom = "earth"` has.

Earth is a conductor without resistance below the one sheet. It has a contact below each contact of
that sheet, so that all models of two sheets apply; the scene file names none of them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from pydantic import BaseModel

from ..skin import EARTH, Earth

BELOW = "earth below "
"""Start of the name of a contact of earth, before the name of the contact above it."""
NEEDS_EARTH = 'needs `skin.bottom = "earth"`, a skin of one conductor'


def with_earth(tables: Mapping[str, Any]) -> dict[str, Any]:
    """Tables of a scene with contacts of earth, and interfaces that name them.

    Raises ValueError naming a key that suits no skin of one conductor, and for an interface to
    earth in a skin of two sheets.
    """
    interfaces = [_table(each) for each in _listed(tables.get("interface"))]
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
    contacts = [{"electrode": "top", **_table(c)} for c in _listed(tables.get("contact"))]
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


def _listed(given: Any) -> Sequence[Any]:
    return given if isinstance(given, list | tuple) else ()


def _table(given: Any) -> dict[str, Any]:
    if isinstance(given, BaseModel):
        return given.model_dump(by_alias=True, exclude_unset=True)
    return given if isinstance(given, dict) else {}

"""Whether sweeps are of the skin they are asked of, by what no session and no calibration changes.

These are size, outline, pixels, foils and how they are driven. Resistances, capacitance, loss,
leads, what is around the skin and the meter may differ.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Any

from . import inputs
from .errors import InputError


def check_same_skin(recorded: str, asked: str, source: str, how: str = "recorded") -> None:
    """Raises InputError in one line where two scenes are of different skins.

    recorded, asked: TOML texts of scenes; nothing is compared where one of them says no skin.
    source: what the former belongs to, as its user calls it. how: what was done for that scene.
    """
    told = difference(recorded, asked)
    if told is not None:
        names = f"{how} for {_name(recorded)}, asked of {_name(asked)}"
        raise InputError(f"{source}: {names}: {told}; --anyway insists")


def difference(recorded: str, asked: str) -> str | None:
    """The first thing that sets two scenes' skins apart, in words; None where there is none.

    recorded, asked: as of `check_same_skin`. Interfaces that only one of them has do not count.
    """
    ours, theirs = _traits(recorded), _traits(asked)
    for key in ours:
        if key in theirs and ours[key] != theirs[key]:
            written = isinstance(ours[key], str) and isinstance(theirs[key], str)
            return f"{key} {ours[key]}, not {theirs[key]}" if written else f"another {key}"
    return None


def _name(text: str) -> str:
    return str(inputs.tables(text).get("name", "an unnamed scene"))


def _traits(text: str) -> dict[str, Any]:
    """By what they are called; none of a text that is no scene."""
    try:
        return _of_table(inputs.tables(text))
    except (KeyError, TypeError, ValueError, AttributeError):
        return {}


def _of_table(scene: Mapping[str, Any]) -> dict[str, Any]:
    skin, pixels = scene["skin"], scene["pixels"]
    foils = {each["name"]: _foil(each) for each in scene["contact"]}
    return {
        "pixels": f"{pixels['rows']}x{pixels['columns']}",
        "length": f"{skin['length']:.9g} m",
        "width": f"{skin['width']:.9g} m",
        "outline": skin.get("outline"),
        "mesh": _mesh(skin.get("mesh")),
        "grouping of pixels": pixels.get("groups"),
        "foils": _listed(foils.values()),
        **{
            f"interface {each['name']}": " against ".join(
                sorted(_listed(foils[name] for name in each[side]) for side in ("high", "low"))
            )
            for each in scene["interface"]
        },
    }


def _mesh(given: Any) -> str | None:
    """The name of the mesh's file: of one that is named, and of one that goes along."""
    source = given["source"] if isinstance(given, dict) else given
    return None if source is None else re.split(r"[/\\]", str(source))[-1]


def _foil(contact: Mapping[str, Any]) -> str:
    low, high = contact.get("span", (0, 1))
    part = "" if (low, high) == (0, 1) else f" {low:.9g}-{high:.9g}"
    return f"{contact['electrode']} {contact['edge']}{part}"


def _listed(foils: Iterable[str]) -> str:
    return " and ".join(sorted(foils))

"""Checks that two scenes describe the same skin.

Compared are the properties that neither a session nor a calibration changes: size, outline, pixels,
foils and how they are driven. Resistances, capacitance, loss, leads, surroundings and the meter may
differ.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Mask, Real
from . import inputs
from .errors import InputError, named

SAME_FREQUENCY = 1e-6
"""Relative difference below which two frequencies are always the same."""
DIGITS = (4, 5, 6)
"""Numbers of digits at which a file was rounded; with fewer, frequencies are round numbers."""


def tolerance(frequency: ArrayLike) -> Real:
    """Relative difference at which another frequency may be the same as each of these.

    It is SAME_FREQUENCY, or half of the last digit if they are written with 4 to 6 digits.
    """
    f = np.asarray(frequency, dtype=np.float64)
    for digits in range(1, DIGITS[-1] + 1):
        rounded = np.array([float(f"{each:.{digits - 1}e}") for each in f.ravel()])
        if np.allclose(f.ravel(), rounded, rtol=1e-9, atol=0):
            if digits not in DIGITS:
                break
            last = 10.0 ** (np.floor(np.log10(rounded)) - digits + 1)
            return np.maximum(SAME_FREQUENCY, 0.501 * last / rounded).reshape(f.shape)
    return np.full(f.shape, SAME_FREQUENCY)


def same_frequencies(one: ArrayLike, other: ArrayLike) -> Mask:
    """True where two arrays of frequencies in Hz, of one shape, have the same one."""
    f, g = np.asarray(one, dtype=np.float64), np.asarray(other, dtype=np.float64)
    return np.abs(f - g) <= np.maximum(tolerance(f), tolerance(g)) * np.minimum(f, g)


def check_same_skin(recorded: str, requested: str, source: str, how: str = "recorded") -> None:
    """Raises InputError in one line if two scenes describe different skins.

    recorded, requested: TOML texts of scenes; a text without a skin is not compared. source: what
    the first belongs to, in the user's words. how: what was done for that scene.
    """
    differing = difference(recorded, requested)
    if differing is not None:
        names = f"{how} for {_name(recorded)}, but used for {_name(requested)}"
        raise InputError(
            f"{source}: {names}: {differing}; {named('anyway', flag=True)} ignores this"
        )


def difference(recorded: str, requested: str) -> str | None:
    """The first difference between two scenes' skins in words; None if they are equal.

    recorded, requested: as in `check_same_skin`. Interfaces that only one has are ignored.
    """
    ours, theirs = _properties(recorded), _properties(requested)
    for key in ours:
        if key in theirs and ours[key] != theirs[key]:
            written = isinstance(ours[key], str) and isinstance(theirs[key], str)
            return f"{key} {ours[key]}, not {theirs[key]}" if written else f"another {key}"
    return None


def _name(text: str) -> str:
    return str(inputs.tables(text).get("name", "an unnamed scene"))


def _properties(text: str) -> dict[str, Any]:
    """Properties of a skin by name; empty for a text that is no scene."""
    try:
        return _skin_properties(inputs.tables(text))
    except (KeyError, TypeError, ValueError, AttributeError):
        return {}


def _skin_properties(scene: Mapping[str, Any]) -> dict[str, Any]:
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
    """Name of the mesh's file, whether the mesh is named or embedded."""
    source = given["source"] if isinstance(given, dict) else given
    return None if source is None else re.split(r"[/\\]", str(source))[-1]


def _foil(contact: Mapping[str, Any]) -> str:
    low, high = contact.get("span", (0, 1))
    part = "" if (low, high) == (0, 1) else f" {low:.9g}-{high:.9g}"
    return f"{contact['electrode']} {contact['edge']}{part}"


def _listed(foils: Iterable[str]) -> str:
    return " and ".join(sorted(foils))

"""Changes keys of a scene file by name."""

from __future__ import annotations

from typing import Any

from ...sweeps import InputError


def put(table: Any, key: str, value: object) -> None:
    """Changes a key of nested tables, such as "contact.left-top.resistance"; None removes it.

    Raises InputError naming the key.
    """
    *parents, last = key.split(".")
    for part in parents:
        place = _place(table, part, key)
        table = table.setdefault(place, {}) if isinstance(table, dict) else table[place]
    place = _place(table, last, key)
    if value is None and isinstance(table, dict):
        table.pop(place, None)
    else:
        table[place] = value


def _place(table: Any, part: str, key: str) -> str | int:
    """Position of a part of a key: a name in a table; in a list a number from 1 or a name."""
    if isinstance(table, dict):
        return part
    for number, item in enumerate(table if isinstance(table, list) else ()):
        if part == str(number + 1) or (isinstance(item, dict) and part == item.get("name")):
            return number
    raise InputError(f"`{key}`: there is no {part!r}")

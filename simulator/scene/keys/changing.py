"""Keys of a scene file changed by their names."""

from __future__ import annotations

from typing import Any

from ...sweeps import InputError


def put(table: Any, key: str, value: object) -> None:
    """Change a key of nested tables, "contact.left-top.resistance"; None takes it away.

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
    """Where a part of a key stands: in a table by name, in a list by number from 1 or by name."""
    if isinstance(table, dict):
        return part
    for number, item in enumerate(table if isinstance(table, list) else ()):
        if part == str(number + 1) or (isinstance(item, dict) and part == item.get("name")):
            return number
    raise InputError(f"`{key}`: there is no {part!r}")

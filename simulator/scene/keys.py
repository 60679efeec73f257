"""Tables and keys of a scene file, derived from their models: their names, changes, suggestions."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from os.path import commonprefix
from typing import Any, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from ..sweeps import InputError

Location = tuple[int | str, ...]
"""Position of a key: names of tables and keys, and numbers of list items from 0."""


@dataclass(frozen=True)
class OrTable:
    """Marks a key that may also be written as such a table."""

    table: type[BaseModel]


@dataclass(frozen=True)
class OrText:
    """Marks a table that may also be written as text, with the kind of the text."""

    text: str = "name"


def keys(table: type[BaseModel]) -> dict[str, FieldInfo]:
    """Fields of a table by their names in the file."""
    return {field.alias or name: field for name, field in table.model_fields.items()}


def inner(field: FieldInfo) -> Iterator[tuple[type[BaseModel], bool]]:
    """Yields the tables that a key may hold, with True if they are in a list."""
    yield from _within(field.annotation, False)
    yield from ((each.table, False) for each in field.metadata if isinstance(each, OrTable))


def _within(annotation: Any, listed: bool) -> Iterator[tuple[type[BaseModel], bool]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation, listed
    for part in get_args(annotation):
        yield from _within(part, listed or get_origin(annotation) is tuple)


def at(table: type[BaseModel], location: Location) -> list[type[BaseModel]]:
    """Tables that may be at a location relative to `table`; empty for an unknown key."""
    found = [table]
    for part in location:
        if isinstance(part, str):
            known = [keys(each)[part] for each in found if part in keys(each)]
            found = [inner_table for field in known for inner_table, _ in inner(field)]
    return found


def required(table: type[BaseModel], location: Location) -> list[Location]:
    """Locations missing with a key: the required keys of the table it holds, or the key itself."""
    fields = [keys(each).get(str(location[-1])) for each in at(table, location[:-1])]
    for kind in (field.annotation for field in fields if field):
        if isinstance(kind, type) and issubclass(kind, BaseModel):
            needed = [name for name, field in keys(kind).items() if field.is_required()]
            return [k for name in needed for k in required(table, (*location, name))] or [location]
    return [location]


def paths(table: type[BaseModel], place: Location = ()) -> Iterator[Location]:
    """Yields the location of every key; tables in lists count as first items."""
    for name, field in keys(table).items():
        yield (*place, name)
        for inner_table, listed in inner(field):
            yield from paths(inner_table, (*place, name, 0) if listed else (*place, name))


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


MAX_SUGGESTIONS = 2
SIMILAR, SIMILAR_ELSEWHERE = 0.6, 0.8


def likely_keys(
    table: type[BaseModel], unknown: Location, missing: Sequence[Location]
) -> list[Location]:
    """Likely corrections of an unknown key, the best first, at most MAX_SUGGESTIONS.

    Keys that are missing in the same table come first, then other keys of that table, then keys of
    other tables, the nearest first.
    """
    *place, name = unknown
    lacking = [str(each[-1]) for each in missing if each[:-1] == tuple(place)]
    allowed = [key for each in at(table, tuple(place)) for key in keys(each)]
    for known in (lacking, allowed):
        close = similar_names(str(name), known, SIMILAR)
        if close:
            return [(*place, each) for each in close[:MAX_SUGGESTIONS]]
    elsewhere = list(dict.fromkeys(paths(table)))
    close = similar_names(str(name), {str(each[-1]) for each in elsewhere}, SIMILAR_ELSEWHERE)[:1]
    found = [each for each in elsewhere if each[-1] in close]
    return sorted(found, key=lambda each: -len(commonprefix([each, unknown])))[:MAX_SUGGESTIONS]


def similar_names(name: str, known: Iterable[str], min_similarity: float) -> list[str]:
    """Names that contain all words of this name, else the name with the most similar spelling."""
    known = list(known)
    if name in known:
        return [name]
    words = {*name.split("_")}
    return [each for each in known if words <= {*each.split("_")}] or get_close_matches(
        name, known, 1, min_similarity
    )

"""Tables and keys of a scene file, derived from their models."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

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

"""The tables of a scene file and what may stand in them, as their models have it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

Location = tuple[int | str, ...]
"""Where a key stands: names of tables and keys, and numbers of items from 0."""


@dataclass(frozen=True)
class OrTable:
    """Says of a key that it may be written as such a table, too."""

    table: type[BaseModel]


@dataclass(frozen=True)
class OrText:
    """Says of a table that it may be written as text, too, and what that is."""

    text: str = "name"


def keys(table: type[BaseModel]) -> dict[str, FieldInfo]:
    """The keys of a table by the names that its file has them under."""
    return {field.alias or name: field for name, field in table.model_fields.items()}


def inner(field: FieldInfo) -> Iterator[tuple[type[BaseModel], bool]]:
    """The tables that a key may hold, and whether in a list; none for plain values."""
    yield from _within(field.annotation, False)
    yield from ((each.table, False) for each in field.metadata if isinstance(each, OrTable))


def _within(annotation: Any, listed: bool) -> Iterator[tuple[type[BaseModel], bool]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation, listed
    for part in get_args(annotation):
        yield from _within(part, listed or get_origin(annotation) is tuple)


def at(table: type[BaseModel], location: Location) -> list[type[BaseModel]]:
    """The tables that may stand there, from a table on; none where no such key is known."""
    found = [table]
    for part in location:
        if isinstance(part, str):
            known = [keys(each)[part] for each in found if part in keys(each)]
            found = [held for field in known for held, _ in inner(field)]
    return found


def required(table: type[BaseModel], location: Location) -> list[Location]:
    """What is missing where that key is: the keys without default of the table it is, or itself."""
    fields = [keys(each).get(str(location[-1])) for each in at(table, location[:-1])]
    for held in (field.annotation for field in fields if field):
        if isinstance(held, type) and issubclass(held, BaseModel):
            needed = [name for name, field in keys(held).items() if field.is_required()]
            return [k for name in needed for k in required(table, (*location, name))] or [location]
    return [location]


def paths(table: type[BaseModel], place: Location = ()) -> Iterator[Location]:
    """Where every key stands, those of tables in lists as of their first item's."""
    for name, field in keys(table).items():
        yield (*place, name)
        for held, listed in inner(field):
            yield from paths(held, (*place, name, 0) if listed else (*place, name))

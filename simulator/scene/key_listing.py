"""Generates the page of all keys of a scene file: type, unit, default, range and meaning."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from .factor_maps import Grid
from .keys import Location, OrTable, OrText, inner, keys
from .map_file import MapFile
from .randomisation import Fixed
from .scene import Scene
from .validation import NumberRange, constraints_of, unit_of

HEAD = """# Every key of a scene file

`rcskin keys` prints this page from the models that check scene files. A scene is a TOML file in SI
units. [Describe a skin](../how-to/describe-a-skin.md) explains the keys, and
[Formulas](formulas.md) states what they compute.
"""
COLUMNS = ("key", "type", "unit", "default", "range", "meaning")
PLAIN = {float: "number", int: "whole number", bool: "true or false", str: "text"}
BOUNDS = {"gt": "> {:g}", "ge": ">= {:g}", "lt": "< {:g}", "le": "<= {:g}"}
LENGTHS = {"min_length": "length >= {}", "max_length": "length <= {}"}
CHOSEN_BY = ("kind", "distribution")
READ_FIRST: dict[type[BaseModel], type[BaseModel]] = {Grid: MapFile}
"""Kinds that are converted to others before validation."""
MAX_PLACES = 3


def page() -> str:
    """The whole page, in Markdown."""
    return "\n".join([HEAD, *(_section(table, places) for table, places in _places().items())])


def _places() -> Mapping[type[BaseModel], list[str]]:
    """Models of tables and their positions, in the order of a file."""
    found: dict[type[BaseModel], list[str]] = {Scene: [""]}

    def look(table: type[BaseModel], place: Location) -> None:
        for name, field in keys(table).items():
            for inner_table, listed in _also_read(inner(field)):
                header = ".".join(map(str, (*place, name)))
                found.setdefault(inner_table, []).append(
                    f"[[{header}]]" if listed else f"[{header}]"
                )
                look(inner_table, (*place, name))

    look(Scene, ())
    return found


def _also_read(
    tables: Iterable[tuple[type[BaseModel], bool]],
) -> Iterator[tuple[type[BaseModel], bool]]:
    for table, listed in tables:
        yield table, listed
        if table in READ_FIRST:
            yield READ_FIRST[table], listed


def _section(table: type[BaseModel], places: Sequence[str]) -> str:
    paragraphs, meanings = _described(table)
    fields = {name: field for name, field in keys(table).items() if not _chosen(name, field)}
    rows = [
        (*_row(name, field), meanings.get(name) or _of_table(field))
        for name, field in fields.items()
    ]
    used = [k for k in range(len(COLUMNS)) if any(row[k] for row in rows)]
    grid = "\n".join(
        f"| {' | '.join(_escaped(row[k]) for k in used)} |"
        for row in (COLUMNS, ("---",) * len(COLUMNS), *rows)
    )
    return "\n\n".join([f"## {_heading(table, places)}", *paragraphs, f"{grid}\n"])


def _described(table: type[BaseModel]) -> tuple[list[str], dict[str, str]]:
    """Paragraphs on the whole table, and the meaning of each key that its docstring explains."""
    first, *rest = inspect.cleandoc(table.__doc__ or "").split("\n\n")
    name = rf"(?:{'|'.join(keys(table))})(?: \[[^\]]+\])?"
    starts = re.compile(rf"(?:^|(?<=\. ))(?={name}(?:, {name})*: )")
    paragraphs, meanings = [" ".join(first.split())], {}
    for paragraph in rest:
        general, *explained = starts.split(" ".join(paragraph.split()))
        paragraphs += [general.strip()] if general else []
        for each in explained:
            names, _, meaning = each.partition(": ")
            meanings |= dict.fromkeys(
                re.sub(r" \[[^\]]+\]", "", names).split(", "), meaning.strip()
            )
    return paragraphs, meanings


def _of_table(field: FieldInfo) -> str:
    """What the table that a key holds is; empty if it holds none, or one of several."""
    tables = [table for table, _ in inner(field)]
    said = _described(tables[0])[0][0] if len(tables) == 1 else ""
    return said[:1].lower() + said[1:]


def _escaped(cell: str) -> str:
    return cell.replace("|", "\\|")


def _heading(table: type[BaseModel], places: Sequence[str]) -> str:
    chosen = [f"`{n} = {_toml(f.default)}`" for n, f in keys(table).items() if _chosen(n, f)]
    if len(places) > MAX_PLACES:
        return ", ".join(chosen)
    return ", ".join([*(f"`{place}`" if place else "The scene" for place in places), *chosen])


def _chosen(name: str, field: FieldInfo) -> bool:
    """True if the key selects among several kinds of a table."""
    kinds = get_args(field.annotation) if get_origin(field.annotation) is Literal else ()
    return name in CHOSEN_BY and len(kinds) == 1


def _row(name: str, field: FieldInfo) -> tuple[str, ...]:
    constraints = constraints_of(field)
    return (
        f"`{name}`",
        _type(field),
        unit_of(field).strip("()"),
        _default(field),
        _range(constraints),
    )


def _type(field: FieldInfo) -> str:
    also = ["table" for each in field.metadata if isinstance(each, OrTable)]
    also += [each.text for each in field.metadata if isinstance(each, OrText)]
    return " or ".join(dict.fromkeys([*_kinds(field.annotation), *also]))


def _kinds(annotation: Any) -> list[str]:
    origin, parts = get_origin(annotation), get_args(annotation)
    if annotation is NoneType:
        return []
    if annotation in PLAIN:
        return [PLAIN[annotation]]
    if annotation is Fixed:
        return ["number"]
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return ["distribution" if _drawn(annotation) else "table"]
    if origin is Literal:
        return [f"`{_toml(each)}`" for each in parts]
    if origin is tuple:
        each = [" or ".join(_kinds(part)) for part in parts if part is not ...]
        return [f"list of {_plural(each[0])}" if parts[-1] is ... else f"[{', '.join(each)}]"]
    if origin in (Union, UnionType):
        return [kind for part in parts for kind in _kinds(part)]
    return _kinds(parts[0])


def _plural(kind: str) -> str:
    return f"{kind}s" if kind.isalpha() else kind


def _default(field: FieldInfo) -> str:
    if field.is_required() or field.default is None:
        return "must be given" if field.is_required() else "none"
    if isinstance(field.default, BaseModel) and not _drawn(type(field.default)):
        return "its own defaults"
    return f"`{_toml(field.default)}`"


def _drawn(table: type[BaseModel]) -> bool:
    """True if the table is a distribution."""
    return any(name == "distribution" and _chosen(name, f) for name, f in keys(table).items())


def _toml(value: object) -> str:
    """A value in TOML on one line."""
    if isinstance(value, BaseModel):
        given = value.model_dump(exclude_unset=True)
        table = {"distribution": getattr(value, "distribution", None), **given}
        return f"{{{', '.join(f'{key} = {_toml(each)}' for key, each in table.items())}}}"
    if isinstance(value, tuple):
        return f"[{', '.join(map(_toml, value))}]"
    if isinstance(value, bool):
        return str(value).lower()
    return f'"{value}"' if isinstance(value, str) else repr(value)


def _range(constraints: Sequence[Any]) -> str:
    texts = [
        words.format(getattr(each, name))
        for each in constraints
        for name, words in {**BOUNDS, **LENGTHS}.items()
        if getattr(each, name, None) is not None
    ]
    bounds = [getattr(each, "func", None) for each in constraints]
    texts += [each.text for each in bounds if isinstance(each, NumberRange)]
    return ", ".join(dict.fromkeys(texts))

"""Reads map files of a scene, tables of factors and pictures, into grids."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, ValidationError, model_validator

from ..arrays import Real
from ..sweeps import InputError, inputs
from ..sweeps.units import plain_number
from .factor_maps import MAX_VALUES, Factor
from .mesh_data import file_of_scene, names_a_file
from .planar import shared
from .validation import Table, Whole, one_line

Count = Annotated[Whole, Field(ge=1, le=MAX_VALUES)]
MAPPED = {"top", "bottom", "foam"}


class MapFile(Table):
    """A CSV file of factors, or a picture with factors from `low` (black) to `high` (white).

    The first line of a CSV is row 1, along the bottom edge, as for rows of pixels; the lower side
    of a picture is at the bottom edge. Colours count by their lightness. path: of the file, from
    the folder of the scene file. low: factor of black, for a picture. high: factor of white, for a
    picture. rows, columns: size to which the values are reduced by averaging; by default they are
    unchanged.
    """

    kind: Literal["file"] = "file"
    path: str
    low: Factor | None = None
    high: Factor | None = None
    rows: Count | None = None
    columns: Count | None = None

    @property
    def table(self) -> bool:
        """True if the file is a table of factors."""
        return Path(self.path).suffix.lower() == ".csv"

    @model_validator(mode="after")
    def _range_of_a_picture(self) -> Self:
        given = [self.low, self.high].count(None)
        if self.table and given != 2:
            raise ValueError("low and high are for pictures; a CSV holds the factors themselves")
        if not self.table and given:
            raise ValueError("low and high must be given, the factors at black and at white")
        return self


def with_grids(tables: dict[str, Any], folder: Path | None) -> dict[str, Any]:
    """The tables of a scene with maps of the kind "file" converted to grids.

    folder: base of relative paths; None refuses files. Raises InputError naming the key.
    """
    skin = tables.get("skin")
    if not isinstance(skin, dict):
        return tables
    read = {
        name: _with_grid(skin[name], f"skin.{name}.map", folder) for name in MAPPED & skin.keys()
    }
    return {**tables, "skin": {**skin, **read}}


def _with_grid(part: Any, key: str, folder: Path | None) -> Any:
    of_place = part.get("map") if isinstance(part, dict) else None
    if not isinstance(of_place, dict) or of_place.get("kind") != "file":
        return part
    if folder is None:
        raise InputError(f"`{key}` {names_a_file(of_place.get('path'))}")
    try:
        map_file = MapFile.model_validate(of_place)
    except ValidationError as error:
        raise InputError(f"`{key}` {one_line(error, MapFile)}") from error
    return {**part, "map": {"kind": "grid", "values": _grid(map_file, key, folder).tolist()}}


def _grid(map_file: MapFile, key: str, folder: Path) -> Real:
    path = Path(map_file.path)
    try:
        path = file_of_scene(map_file.path, folder)
        values = _table(path) if map_file.table else _picture(path, map_file)
    except InputError as error:
        raise InputError(f"`{key}.path` {error}") from None
    except (OSError, ValueError, SyntaxError, csv.Error) as error:
        raise InputError(f"`{key}.path` {path}: cannot be read: {error}") from error
    reduced = _reduced(values, map_file.rows or len(values), map_file.columns or len(values[0]))
    if max(reduced.shape) > MAX_VALUES:
        raise InputError(
            f"`{key}.path` {path} has {len(values)} rows of {len(values[0])} values; at most "
            f"{MAX_VALUES} rows and {MAX_VALUES} columns are supported: give `rows` and `columns` "
            "to reduce it"
        )
    return reduced


def _table(path: Path) -> Real:
    lines = csv.reader(inputs.text(path, inputs.MAP).splitlines())
    rows = [
        [_factor(cell, lines.line_num, place) for place, cell in enumerate(row, start=1)]
        for row in lines
        if row
    ]
    if not rows or len({len(row) for row in rows}) > 1:
        raise ValueError("must be lines of equally many numbers, separated by commas")
    return np.array(rows)


def _factor(cell: str, line: int, place: int) -> float:
    value = plain_number(cell)
    if not 0 < value < np.inf:
        raise ValueError(
            f"line {line}, column {place}: all factors must be finite and > 0, got {cell!r}"
        )
    return value


def _picture(path: Path, map_file: MapFile) -> Real:
    assert map_file.low is not None and map_file.high is not None
    with inputs.picture(path) as picture:
        if picture.mode.startswith("I"):
            lightness = np.asarray(picture, dtype=np.float64) / np.iinfo(np.uint16).max
        else:
            lightness = np.asarray(picture.convert("L"), dtype=np.float64) / np.iinfo(np.uint8).max
    return map_file.low + (map_file.high - map_file.low) * lightness[::-1]


def _reduced(values: Real, rows: int, columns: int) -> Real:
    """Averages over the cells of another uniform grid."""
    if values.shape == (rows, columns):
        return values
    old = [np.linspace(0, 1, n + 1) for n in values.shape]
    new = [np.linspace(0, 1, n + 1) for n in (rows, columns)]
    return shared(old[0], new[0]).T @ values @ shared(old[1], new[1])

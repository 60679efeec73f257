"""Scenes on disk: TOML files, the grids their maps name, and the scenes of the package."""

from __future__ import annotations

import csv
import json
import re
import tomllib
from difflib import get_close_matches
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
import tomli_w
from numpy.typing import NDArray
from pydantic import Field, ValidationError, model_validator

from ..sweeps import InputError, checked_output, whole_file
from ..sweeps.builtin import BUILTIN, builtin_names
from ..sweeps.file_kinds import check_file_kind
from ..sweeps.units import in_si, plain_number
from .form.mesh_data import names_a_file
from .maps import MOST_VALUES, Factor
from .planar import shared
from .scene import Scene
from .validation import Table, Whole, one_line

Count = Annotated[Whole, Field(ge=1, le=MOST_VALUES)]

NAME = re.compile(r'^name = "[^"]*"\ndescription = "[^"]*"', flags=re.MULTILINE)
AT_LINE = re.compile(r"at line (\d+)")
WHOLE_LINE = re.compile(r"\s*(?P<key>[\w.\-]+)\s*=(?P<value>[^#]*)(#.*)?")
PART_OF_LINE = re.compile(r"(?P<key>[\w.\-]+)\s*=(?P<value>[^#,={}\[\]]+)")
MAPPED = {"top", "bottom", "foam"}


class MapFile(Table):
    """A CSV file, or a picture from dark, `low`, to light, `high`; colours by their lightness.

    The first line of a CSV is row 1, along the bottom edge, as rows of pixels are counted; a
    picture lies on the skin as it is seen, its lower side along the bottom edge. rows, columns: to
    which the values are reduced, by their means; by default they are taken as they are.
    """

    kind: Literal["file"] = "file"
    path: str
    low: Factor | None = None
    high: Factor | None = None
    rows: Count | None = None
    columns: Count | None = None

    @property
    def table(self) -> bool:
        """Whether it is a table of factors."""
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
    """The tables of a scene, with maps of the kind "file" read into grids.

    folder: what paths are relative to; None reads none. Raises InputError that names the key.
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
        asked = MapFile.model_validate(of_place)
    except ValidationError as error:
        raise InputError(f"`{key}` {one_line(error, MapFile)}") from error
    return {**part, "map": {"kind": "grid", "values": _grid(asked, key, folder).tolist()}}


def _grid(asked: MapFile, key: str, folder: Path) -> NDArray[np.float64]:
    path = folder / asked.path
    try:
        values = _table(path) if asked.table else _picture(path, asked)
    except FileNotFoundError:
        raise InputError(f"`{key}.path` {path}: no such file") from None
    except (OSError, ValueError, SyntaxError, csv.Error) as error:
        raise InputError(f"`{key}.path` {path}: cannot be read: {error}") from error
    reduced = _reduced(values, asked.rows or len(values), asked.columns or len(values[0]))
    if max(reduced.shape) > MOST_VALUES:
        raise InputError(
            f"`{key}.path` {path} holds {len(values)} rows of {len(values[0])} values; at most "
            f"{MOST_VALUES} each way are taken: give `rows` and `columns` to have it reduced"
        )
    return reduced


def _table(path: Path) -> NDArray[np.float64]:
    with path.open(newline="", encoding="utf-8-sig") as file:
        lines = csv.reader(file)
        rows = [
            [_factor(cell, lines.line_num, place) for place, cell in enumerate(row, start=1)]
            for row in lines
            if row
        ]
    if not rows or len({len(row) for row in rows}) > 1:
        raise ValueError("must be lines of equally many numbers, parted by commas")
    return np.array(rows)


def _factor(cell: str, line: int, place: int) -> float:
    value = plain_number(cell)
    if not 0 < value < np.inf:
        raise ValueError(
            f"line {line}, column {place}: all factors must be finite and > 0, got {cell!r}"
        )
    return value


def _picture(path: Path, asked: MapFile) -> NDArray[np.float64]:
    from PIL import Image

    assert asked.low is not None and asked.high is not None
    with Image.open(path) as picture:
        if picture.mode.startswith("I"):
            lightness = np.asarray(picture, dtype=np.float64) / np.iinfo(np.uint16).max
        else:
            lightness = np.asarray(picture.convert("L"), dtype=np.float64) / np.iinfo(np.uint8).max
    return asked.low + (asked.high - asked.low) * lightness[::-1]


def _reduced(values: NDArray[np.float64], rows: int, columns: int) -> NDArray[np.float64]:
    """Means over the cells of another even grid."""
    if values.shape == (rows, columns):
        return values
    old = [np.linspace(0, 1, n + 1) for n in values.shape]
    new = [np.linspace(0, 1, n + 1) for n in (rows, columns)]
    return shared(old[0], new[0]).T @ values @ shared(old[1], new[1])


def builtin_text(name: str) -> str:
    """The file of a built-in scene, comments and all. Raises InputError where there is none."""
    if name not in builtin_names():
        raise InputError(f"{name}: no built-in scene; {_likely_scene(name)}")
    return (BUILTIN / f"{name}.toml").read_text(encoding="utf-8")


def _likely_scene(name: str) -> str:
    close = get_close_matches(name, builtin_names(), 1)
    meant = f"did you mean {close[0]}? " if close else ""
    return f"{meant}there are {', '.join(builtin_names())}"


def write_new(path: Path, like: str) -> None:
    """Begin a scene file with that of a built-in scene, under the name of the file.

    Its description says what it was begun from.

    Raises InputError for another ending, an absent folder, a file that is there, and another scene.
    """
    text = builtin_text(like)
    if checked_output(path, (".toml",)).exists():
        raise InputError(f"{path}: is there already, and is not overwritten")
    with whole_file(path) as unfinished:
        name = json.dumps(path.stem, ensure_ascii=False)
        own = f'name = {name}\ndescription = "begun from {like}"'
        unfinished.write_text(NAME.sub(lambda _: own, text, count=1), encoding="utf-8")


def load_scene(name_or_path: str | Path) -> Scene:
    """The built-in scene of that name, or the one in the file at that path.

    Raises InputError in one line naming the file, the key, the value and what is allowed.
    """
    if str(name_or_path) in builtin_names():
        return read_scene(BUILTIN / f"{name_or_path}.toml")
    path = Path(name_or_path)
    if not path.exists() and path.suffix != ".toml" and path.parent == Path("."):
        likely = _likely_scene(str(name_or_path))
        raise InputError(f"{name_or_path}: no such file, and no built-in scene; {likely}")
    return read_scene(path)


def read_scene(path: Path) -> Scene:
    """The scene in a TOML file; raises InputError as `load_scene` does."""
    check_file_kind(path, "scene")
    try:
        return parse_scene(path.read_text(encoding="utf-8-sig"), str(path), path.parent)
    except FileNotFoundError:
        raise InputError(f"{path}: no such file") from None
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: cannot be read: not text in UTF-8 ({error.reason})") from error
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error}") from error


def parse_scene(text: str, source: str, folder: Path | None = None) -> Scene:
    """The scene written in TOML; `source` names it in errors. Raises InputError.

    folder: what the paths of maps and of a mesh, which are read, are relative to. None is of a
    scene that travels inside another file: it opens none, and one that names any is refused.
    """
    try:
        tables = with_grids(tomllib.loads(text), folder)
        return Scene.model_validate(tables, context={"folder": folder})
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{source}: not valid TOML: {error}{_slip(text, error)}") from error
    except InputError as error:
        raise InputError(f"{source}: {error}") from error
    except ValidationError as error:
        raise InputError(f"{source}: {one_line(error, Scene)}") from error


def _slip(text: str, error: tomllib.TOMLDecodeError) -> str:
    """What was likely meant in the line that is not TOML."""
    number = AT_LINE.search(str(error))
    line = text.splitlines()[int(number[1]) - 1] if number else ""
    whole = WHOLE_LINE.fullmatch(line)
    for given in [*([whole] if whole else []), *PART_OF_LINE.finditer(line)]:
        key, value = given["key"], given["value"].strip()
        plain = in_si(value)
        if plain is not None:
            return f": `{key} = {value}`; numbers stand without a unit, with a point: {plain}"
        if value.isidentifier() and value not in ("true", "false", "inf", "nan"):
            return f": `{key} = {value}`; text stands in quotes"
    return f": {line.strip()}" if line.strip() else ""


def scene_text(scene: Scene) -> str:
    """The scene as TOML; `parse_scene` gives the same scene back."""
    return tomli_w.dumps(scene.model_dump(by_alias=True, exclude_none=True))

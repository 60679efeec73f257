"""Reads and writes scenes as TOML files, with map files and built-in scenes."""

from __future__ import annotations

import json
import re
import tomllib
from difflib import get_close_matches
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, get_args

import tomli_w
from pydantic import ValidationError

from ..sweeps import InputError, checked_output, inputs, whole_file
from ..sweeps.builtin import BUILTIN, builtin_names
from ..sweeps.csv_cells import printable
from ..sweeps.inputs import check_file_kind
from ..sweeps.units import in_si
from .map_file import with_grids
from .scene import Scene
from .surroundings import LowTerminal
from .validation import one_line

if TYPE_CHECKING:
    import xarray as xr

NAME = re.compile(r'^name = "[^"]*"\ndescription = "[^"]*"', flags=re.MULTILINE)
AROUND = """
[surroundings]                           # rcskin describe shows how much each part matters
low = "{low}"                    # of an LCR meter; "floating": of a meter without earth
"""
"""Text added to a new scene, because the meters of built-in scenes float."""
GRID = re.compile(r"(?m)^(frequencies *= *\{.*?) *\}")
DIGITS = 4
"""Significant digits of frequencies that every LCR meter sets: the E4980A has no more."""
MAX_SHOWN = 200
"""Number of characters shown of a line that is no TOML."""
AT_LINE = re.compile(r"at line (\d+)")
WHOLE_LINE = re.compile(r"\s*(?P<key>[\w.\-]+)\s*=(?P<value>[^#]*)(#.*)?")
PART_OF_LINE = re.compile(r"(?P<key>[\w.\-]+)\s*=(?P<value>[^#,={}\[\]]+)")


def builtin_text(name: str) -> str:
    """The file of a built-in scene with its comments. Raises InputError for an unknown name."""
    if name not in builtin_names():
        raise InputError(f"{name}: no built-in scene; {_likely_scene(name)}")
    return (BUILTIN / f"{name}.toml").read_text(encoding="utf-8")


def _likely_scene(name: str) -> str:
    close = get_close_matches(name, builtin_names(), 1)
    hint = f"did you mean {close[0]}? " if close else ""
    return f"{hint}there are {', '.join(builtin_names())}"


def checked_low(text: str) -> LowTerminal:
    """The low terminal with this name (spaces or dashes); raises InputError for other names."""
    for known in get_args(LowTerminal):
        if text.strip().replace("-", " ") == known:
            return known
    allowed = " or ".join(map(repr, get_args(LowTerminal)))
    raise InputError(f"the meter's low terminal must be {allowed}, got {text!r}")


def write_new(path: Path, like: str, low: LowTerminal) -> None:
    """Writes a new scene file that starts from a built-in scene and is named after the file.

    Its description names the built-in scene. low: low terminal of the meter.

    Raises InputError for another ending, a missing folder, a file that may not be overwritten, and
    an unknown scene.
    """
    text = new_text(like, low)
    with whole_file(checked_output(path, (".toml",))) as unfinished:
        name = json.dumps(path.stem, ensure_ascii=False)
        own = f'name = {name}\ndescription = "started from {like}"'
        unfinished.write_text(NAME.sub(lambda _: own, text, count=1), encoding="utf-8")


def new_text(like: str, low: LowTerminal) -> str:
    """A built-in scene with surroundings, and with frequencies as meters set them."""
    text = builtin_text(like) + AROUND.format(low=low)
    return GRID.sub(rf"\1, digits = {DIGITS} }}", text)


def write_scene(path: str | Path, scene: Scene) -> None:
    """Writes a scene. Raises InputError for another ending, a missing folder, a protected file."""
    with whole_file(checked_output(path, (".toml",))) as unfinished:
        unfinished.write_text(scene_text(scene), encoding="utf-8")


def load_scene(name_or_path: str | Path) -> Scene:
    """The built-in scene with a name, or the scene in the file at a path.

    Raises InputError with one line naming file, key, value and allowed range.
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
    return parse_scene(inputs.text(path, inputs.SCENE), str(path), path.parent)


def parse_scene(text: str, source: str, folder: Path | None = None) -> Scene:
    """The scene written in TOML; `source` names it in errors. Raises InputError.

    folder: base of the paths of maps and meshes, which are read. None is for a scene inside another
    file: it opens no files, and one that names a file is refused.
    """
    try:
        tables = with_grids(inputs.tables(text), folder)
        return Scene.model_validate(tables, context={"folder": folder})
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{source}: not valid TOML: {error}{_toml_hint(text, error)}") from error
    except InputError as error:
        raise InputError(f"{source}: {error}") from error
    except ValidationError as error:
        raise InputError(f"{source}: {one_line(error, Scene)}") from error


@lru_cache(maxsize=8)
def carried_scene(text: str, source: str = "the scene of the sweeps") -> Scene | None:
    """Parses a scene that a file carries as text, with a cache; None for an empty text.

    Arguments and errors as in `parse_scene`.
    """
    return parse_scene(text, source) if text else None


def scene_of_sweeps(sweeps: xr.Dataset) -> Scene | None:
    """The scene that sweeps carry, None if there is none; raises as `carried_scene`."""
    return carried_scene(str(sweeps.attrs.get("scene", "")))


def _toml_hint(text: str, error: tomllib.TOMLDecodeError) -> str:
    """Hint at the likely mistake in the line that is not valid TOML."""
    number = AT_LINE.search(str(error))
    line = text.splitlines()[int(number[1]) - 1][:MAX_SHOWN] if number else ""
    whole = WHOLE_LINE.fullmatch(line)
    for given in [*([whole] if whole else []), *PART_OF_LINE.finditer(line)]:
        key, value = given["key"], given["value"].strip()
        plain = in_si(value)
        if plain is not None:
            return f": `{key} = {value}`; write numbers without a unit and with a point: {plain}"
        if value.isidentifier() and value not in ("true", "false", "inf", "nan"):
            return f": `{key} = {value}`; write text in quotes"
    return f": {line.strip()}" if line.strip() else ""


def scene_text(scene: Scene) -> str:
    """The scene as TOML; `parse_scene` gives the same scene back."""
    return printable(tomli_w.dumps(scene.model_dump(by_alias=True, exclude_none=True)))

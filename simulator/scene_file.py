"""Scenes on disk: TOML files, and those that come with the package, addressable by name."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import tomli_w
from pydantic import ValidationError

from simulator.contour import check_simple
from simulator.grid import SAME_LINE
from simulator.map_file import with_grids
from simulator.press import (
    Depth,
    Disc,
    Force,
    Polygon,
    Press,
    Rectangle,
    Strength,
    Touch,
    place_of,
    touch_at,
)
from simulator.scene import Pressing, Scene
from simulator.sweeps import InputError
from simulator.validation import one_line

BUILTIN = Path(__file__).parent / "scenes"
LEAST_SIZE = 1e-6
"""Of a touch, over that of the skin: a thousand times what lines are told apart by."""


def builtin_names() -> list[str]:
    """The names of the scenes that come with the package."""
    return sorted(path.stem for path in BUILTIN.glob("*.toml"))


def load_scene(name_or_path: str | Path) -> Scene:
    """The built-in scene of that name, or the one in the file at that path.

    Raises InputError in one line naming the file, the key, the value and what is allowed.
    """
    if str(name_or_path) in builtin_names():
        return read_scene(BUILTIN / f"{name_or_path}.toml")
    path = Path(name_or_path)
    if not path.exists() and path.suffix != ".toml" and path.parent == Path("."):
        raise InputError(
            f"{name_or_path}: no such file, and no built-in scene; "
            f"there are {', '.join(builtin_names())}"
        )
    return read_scene(path)


def read_scene(path: Path) -> Scene:
    """The scene in a TOML file; raises InputError as `load_scene` does."""
    try:
        return parse_scene(path.read_text(encoding="utf-8"), str(path), path.parent)
    except FileNotFoundError:
        raise InputError(f"{path}: no such file") from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read: {error}") from error


def parse_scene(text: str, source: str, folder: Path = Path()) -> Scene:
    """The scene written in TOML; `source` names it in errors. Raises InputError.

    folder: what the paths of maps and of a mesh are relative to; the maps are read.
    """
    try:
        tables = with_grids(tomllib.loads(text), folder)
        return Scene.model_validate(tables, context={"folder": folder})
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{source}: not valid TOML: {error}") from error
    except InputError as error:
        raise InputError(f"{source}: {error}") from error
    except ValidationError as error:
        raise InputError(f"{source}: {one_line(error)}") from error


def scene_text(scene: Scene) -> str:
    """The scene as TOML; `parse_scene` gives the same scene back."""
    return tomli_w.dumps(scene.model_dump(by_alias=True, exclude_none=True))


def strength_of(pressing: Pressing) -> Strength:
    """How strongly a touch presses that does not say so."""
    if pressing.depth is not None:
        return Depth(pressing.depth)
    return pressing.capacitance_factor if pressing.force is None else Force(pressing.force)


def pixel_by_pixel(scene: Scene) -> list[Press]:
    """The skin at rest, then every pixel alone, row by row."""
    strength = strength_of(scene.press)
    pixels = [Touch(i + 1, j + 1, 1.0) for i, j in np.ndindex(*scene.pixels.shape)]
    return [Press(), *(Press((touch_at(pixel, strength),)) for pixel in pixels)]


def check_press(press: Press, scene: Scene) -> Press:
    """The same press, if it lies on the scene's skin; raises InputError."""
    for place in map(place_of, press.touches):
        if isinstance(place, Touch):
            _check_pixel(place, press, scene)
        else:
            _check_place(place, press, scene)
        if isinstance(place, Polygon):
            _check_polygon(place, press, scene)
    if press.indented and scene.skin.foam.mechanics is None:
        raise InputError(
            f"press {press}: depth and force need the table skin.foam.mechanics in {scene.name}"
        )
    return press


def _check_polygon(touch: Polygon, press: Press, scene: Scene) -> None:
    least = LEAST_SIZE * max(scene.skin.length, scene.skin.width)
    try:
        check_simple("poly", np.array(touch.points), least)
    except ValueError as error:
        raise InputError(f"press {press}: {error}") from error


def _check_pixel(touch: Touch, press: Press, scene: Scene) -> None:
    for axis, index, count in (
        ("row", touch.row, scene.pixels.rows),
        ("column", touch.column, scene.pixels.columns),
    ):
        if not 1 <= index <= count:
            raise InputError(
                f"press {press}: {axis} must be in 1..{count} on {scene.name}, got {index}"
            )


def _check_place(touch: Rectangle | Disc | Polygon, press: Press, scene: Scene) -> None:
    box, skin = touch.box, scene.skin
    for axis, length, low, high in (
        ("x", skin.length, box.left, box.right),
        ("y", skin.width, box.bottom, box.top),
    ):
        rounding = SAME_LINE * length
        if low < -rounding or high > length + rounding:
            raise InputError(
                f"press {press}: touches must lie within {axis} = 0..{length:g} m on {scene.name}, "
                f"got {low:g}..{high:g} m"
            )
        if not high - low >= LEAST_SIZE * length:
            raise InputError(
                f"press {press}: touches must be at least {LEAST_SIZE * length:g} m large along "
                f"{axis} on {scene.name}, got {high - low:g} m"
            )

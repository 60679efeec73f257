"""The triangles of a skin as numbers in its scene, so that sweeps and models carry them.

A mesh whose extent is not that of the grid of pixels, such as one in mm, is refused.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, Field, ValidationInfo, model_validator

from ..arrays import Integer
from .mesh_file import MeshSurface, read_surface
from .validation import Table, single_line

ON_ANOTHER_COMPUTER = re.compile(r"[\\/]{2}")
"""Start of the path \\\\computer\\folder, with which Windows calls that computer."""
Rows = Annotated[str, Field(description="Rows of numbers, separated by commas.")]


class MeshGroup(Table):
    """A named group of a mesh: numbers of its lines and of its triangles, both counted from 0.

    name: by which contacts and pixels refer to the group. lines, triangles: rows of those that
    belong to it.
    """

    name: Annotated[str, Field(min_length=1), AfterValidator(single_line)]
    lines: Rows = ""
    triangles: Rows = ""


class MeshData(Table):
    """A mesh as text: rows of numbers, separated by commas; `mesh = "FILE"` is converted to this.

    source: name of the original file. points: x y or x y z in m. triangles, lines: numbers of
    points, counted from 0; -1 is a point of no triangle.
    """

    source: Annotated[str, Field(min_length=1), AfterValidator(single_line)]
    points: Rows
    triangles: Rows
    lines: Rows = ""
    groups: Annotated[tuple[MeshGroup, ...], Field(alias="group")] = ()

    @property
    def surface(self) -> MeshSurface:
        """The mesh as arrays."""
        return _surface(self.points, self.triangles, self.lines, self.groups)

    @classmethod
    def of(cls, surface: MeshSurface, source: str) -> Self:
        """Converts arrays to text; numbers are equal to the last bit."""
        names = dict.fromkeys([*surface.line_groups, *surface.triangle_groups])
        members = surface.line_groups, surface.triangle_groups
        groups = [(name, *(_listed(kind, name) for kind in members)) for name in names]
        return cls.model_validate(
            {
                "source": source,
                "points": _rows(surface.p),
                "triangles": _rows(surface.t),
                "lines": _rows(surface.lines),
                "group": [
                    {"name": name, "lines": lines, "triangles": triangles}
                    for name, lines, triangles in groups
                    if lines or triangles
                ],
            }
        )

    @model_validator(mode="after")
    def _numbers_agree(self) -> Self:
        assert self.surface.t.size
        return self


def read_along(given: object, info: ValidationInfo) -> object:
    """Reads a mesh file that a scene names; paths are relative to the scene file's folder.

    Raises ValueError if a scene inside another file names one.
    """
    if not isinstance(given, str):
        return given
    folder = (info.context or {"folder": Path()})["folder"]
    if folder is None:
        raise ValueError(names_a_file(given))
    path = file_of_scene(single_line(given), folder).absolute()
    return MeshData.of(read_surface(str(path)), path.name)


def file_of_scene(given: str, folder: Path) -> Path:
    """Path of a file that a scene names, from the scene's folder.

    Raises ValueError for a path on another computer: Windows would log in there to look for it, and
    scenes come from others.
    """
    if ON_ANOTHER_COMPUTER.match(given):
        raise ValueError(
            f"names a file on another computer, {given!r}: copy it into the folder of the scene"
        )
    return folder / given


def names_a_file(path: object) -> str:
    """Message for a scene inside another file that names a file."""
    return (
        f"names the file {path!r}, which a scene stored in another file cannot open; give the "
        "command the scene's own file, or write this file again from it, with its maps and meshes"
    )


@functools.lru_cache(maxsize=4)
def _surface(
    points: str, triangles: str, lines_of: str, groups: tuple[MeshGroup, ...]
) -> MeshSurface:
    """Parses a mesh. Raises ValueError naming a key with malformed or out-of-range numbers."""
    p = _array("points", points, float, (2, 3))
    t = _array("triangles", triangles, int, (3,))
    lines = _array("lines", lines_of, int, (2,))
    if not (p.size and t.size):
        raise ValueError("must have points and triangles")
    _check_below("triangles", t, p.shape[1])
    _check_below("lines", lines, p.shape[1], minimum=-1)
    return MeshSurface(
        p,
        np.sort(t, axis=0),
        np.sort(lines, axis=0),
        {each.name: _members(each, "lines", lines) for each in groups},
        {each.name: _members(each, "triangles", t) for each in groups},
    )


def _members(group: MeshGroup, kind: str, of: Integer) -> Integer:
    found = _array(f"group {group.name!r} {kind}", getattr(group, kind), int, (1,))[0]
    _check_below(f"group {group.name!r} {kind}", found, of.shape[1])
    return found


def _check_below(name: str, numbers: Integer, count: int, minimum: int = 0) -> None:
    if numbers.size and not (numbers.min() >= minimum and numbers.max() < count):
        raise ValueError(f"{name} must be numbers from {minimum} to {count - 1}")


def _array(name: str, text: str, kind: type, sizes: tuple[int, ...]) -> NDArray:
    """Parses rows of text to shape (size, row); the size must be one of `sizes`."""
    rows = [row.split() for row in text.split(",")] if text.strip() else []
    size = len(rows[0]) if rows else sizes[0]
    if size not in sizes or any(len(row) != size for row in rows):
        expected = " or ".join(map(str, sizes))
        raise ValueError(f"{name} must be rows of {expected} numbers, separated by commas")
    try:
        found = np.array([list(map(kind, row)) for row in rows], dtype=kind)
    except (ValueError, OverflowError):
        raise ValueError(f"{name} must be rows of numbers, separated by commas") from None
    return np.ascontiguousarray(found.reshape(-1, size).T)


def _rows(columns: NDArray) -> str:
    """Writes shape (size, row) as rows of text; floats with the fewest exact digits."""
    return ", ".join(" ".join(map(repr, row)) for row in columns.T.tolist())


def _listed(groups: Mapping[str, Integer], name: str) -> str:
    return ", ".join(map(str, groups[name].tolist())) if name in groups else ""


LARGEST = 10.0
"""Factor between the sides of a mesh and of the grid of pixels beyond which a unit is wrong."""
UNITS = {1e3: "mm", 1e2: "cm", 1 / 0.0254: "inches", 1e6: "um", 1e-3: "km"}
"""Numbers of units in 1 m."""
NEAR = 0.05
"""Relative deviation of the sides from such a factor that still suggests the unit."""
OFF = 0.1
"""Distance between edges of mesh and grid, over the sides of the grid, above which it warns."""


def check_extent(surface: MeshSurface, length: float, width: float) -> None:
    """Raises ValueError if a mesh is far larger or smaller than length and width [m]."""
    spans = np.ptp(surface.p[:2], axis=1)
    factor = float(np.exp(np.mean(np.log(np.maximum(spans, 1e-300) / [length, width]))))
    if not (factor <= 1 / LARGEST or factor >= LARGEST):
        return
    units = [unit for number, unit in UNITS.items() if abs(factor / number - 1) < NEAR]
    hint = f"; did you mean {units[0]}?" if units else ""
    raise ValueError(
        f"has a mesh of {spans[0]:.4g} x {spans[1]:.4g} m and a grid of pixels of {length:g} x "
        f"{width:g} m (`length`, `width`), a factor of {factor:.4g}; points of a mesh are in "
        f"m{hint}"
    )


def off_grid(surface: MeshSurface, length: float, width: float) -> Iterator[str]:
    """A warning if a mesh is off the grid of pixels, whose corner is at x = y = 0."""
    low, high = surface.p[:2].min(axis=1), surface.p[:2].max(axis=1)
    sides = np.array([length, width])
    if (np.maximum(np.abs(low), np.abs(high - sides)) > OFF * sides).any():
        spans = [
            f"{name} = {1e3 * a:.4g} to {1e3 * b:.4g} mm"
            for name, a, b in zip("xy", low, high, strict=True)
        ]
        yield (
            f"`skin.mesh` lies at {', '.join(spans)}, the grid of pixels at x = 0 to "
            f"{1e3 * length:.4g} mm, y = 0 to {1e3 * width:.4g} mm; move its points, or change "
            "`length` and `width`"
        )

"""Reads triangles and named groups of a mesh file of gmsh, VTK or Abaqus by meshio.

Quadrilaterals are halved, and second-order elements are split at their midside nodes, into straight
triangles and lines. Groups are gmsh's physical groups, any format's named sets of elements, and
`NAME=VALUE` for elements whose data NAME is the whole number VALUE.
"""

from __future__ import annotations

import contextlib
import functools
import io
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Integer, Mask, Real
from ..sweeps import InputError, inputs, require_packages

if TYPE_CHECKING:
    import meshio


FORMATS = {".msh": "gmsh", ".vtk": "vtk", ".vtu": "vtu", ".inp": "abaqus"}
"""Names of formats in meshio by file ending."""
MAX_GROUP_VALUES = 1000
"""Largest number of distinct whole numbers in element data that form groups."""
BYTES_OF_POINT = 200
"""Memory of a point of a grid, with its cells."""
MAX_NUMBER = 10**8
"""Largest number of a node or an element; meshio reserves memory by it."""
LARGE_NUMBER = re.compile(r"(?<![\w.+/=-])[1-9]\d{8,}(?![\w.+/=])")
LINES = {"line": [(0, 1)], "line3": [(0, 2), (2, 1)]}
CORNERS = [(0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)]
TRIANGLES = {
    "triangle": [(0, 1, 2)],
    "triangle6": CORNERS,
    "triangle7": CORNERS,
    "quad": [(0, 1, 2), (0, 2, 3)],
    "quad8": [(0, 4, 7), (1, 5, 4), (2, 6, 5), (3, 7, 6), (4, 5, 6), (4, 6, 7)],
    "quad9": [(0, 4, 8), (0, 8, 7), (1, 5, 8), (1, 8, 4)]
    + [(2, 6, 8), (2, 8, 5), (3, 7, 8), (3, 8, 6)],
}


@dataclass(frozen=True, eq=False)
class MeshSurface:
    """A triangle mesh with named groups.

    p: points in m, shape (2 or 3, point). t, lines: ascending numbers of points, shapes (3,
    triangle) and (2, line). line_groups, triangle_groups: members of each group.
    """

    p: Real
    t: Integer
    lines: Integer
    line_groups: dict[str, Integer]
    triangle_groups: dict[str, Integer]

    @functools.cached_property
    def boundary(self) -> Integer:
        """Edges of exactly one triangle, shape (2, edge)."""
        every = np.concatenate([self.t[[0, 1]], self.t[[0, 2]], self.t[[1, 2]]], axis=1)
        edges, count = np.unique(every, axis=1, return_counts=True)
        return edges[:, count == 1]

    def area(self, group: str | None = None) -> float:
        """Area of the triangles of a group, or of all for None, in the plane or in space, m²."""
        some = slice(None) if group is None else self.triangle_groups[group]
        corners = self.p[:, self.t[:, some]]
        one, other = (corners[:, k] - corners[:, 0] for k in (1, 2))
        product = (one * other).sum(axis=0) ** 2
        square = (one**2).sum(axis=0) * (other**2).sum(axis=0) - product
        return float(np.sqrt(np.maximum(square, 0.0)).sum() / 2)


def read_surface(path: str) -> MeshSurface:
    """Reads a mesh file; raises InputError if it cannot be read or has no triangles."""
    if not Path(path).exists():
        raise InputError(f"{path}: no such file, needed as `skin.mesh`")
    inputs.check_input(Path(path), inputs.MESH)
    mesh = _parsed(path)
    for block in mesh.cells:
        if block.type not in (*TRIANGLES, *LINES, "vertex"):
            raise InputError(
                f"{path}: `skin.mesh` must hold triangles, quadrilaterals and lines of first or "
                f"second order, got {block.type}"
            )
    t, t_cells = _pieces(mesh, TRIANGLES)
    lines, line_cells = _pieces(mesh, LINES)
    if not t.size:
        raise InputError(f"{path}: `skin.mesh` must hold triangles or quadrilaterals, got none")
    t, t_same = _distinct(t)
    lines, line_same = _distinct(lines)
    used, t = np.unique(t, return_inverse=True)
    number = np.full(len(mesh.points), -1, dtype=np.int64)
    number[used] = np.arange(len(used))
    groups = dict(_groups(mesh))
    return MeshSurface(
        _flat(np.asarray(mesh.points, dtype=float)[used]),
        t.reshape(3, -1),
        number[lines],
        {name: _members(cells, line_cells, line_same) for name, cells in groups.items()},
        {name: _members(cells, t_cells, t_same) for name, cells in groups.items()},
    )


def foil_lines(surface: MeshSurface, group: str, source: str) -> Integer:
    """Facets of a group as numbers of points, ascending in each column, shape (2, facet).

    Raises InputError for an unknown group, and for a group with lines off the boundary.
    """
    lines = surface.lines[:, surface.line_groups.get(group, [])]
    if not lines.size:
        there = [name for name, found in surface.line_groups.items() if len(found)]
        raise InputError(
            f"contact edge {group!r} must be a group of boundary lines of {source}; "
            f"there are {', '.join(map(repr, there)) or 'none'}"
        )
    if not np.isin(_keys(lines), _keys(surface.boundary)).all():
        raise InputError(
            f"contact edge {group!r} must be a group of boundary lines of {source}; "
            "some of its lines are not edges of exactly one triangle"
        )
    return lines


def _keys(lines: Integer) -> Integer:
    return lines[0] * (1 << 32) + lines[1]


def _parsed(path: str) -> meshio.Mesh:
    ending = Path(path).suffix.lower()
    if ending not in FORMATS:
        raise InputError(f"{path}: must end in {', '.join(FORMATS)}, got {ending!r}")
    require_packages(path, "mesh", "meshio")
    _check_declared(Path(path), inputs.content(Path(path), inputs.MESH).decode("latin-1"), ending)
    import meshio

    quiet = io.StringIO()
    try:
        with contextlib.redirect_stdout(quiet), contextlib.redirect_stderr(quiet):
            return meshio.read(path, file_format=FORMATS[ending])
    except (Exception, SystemExit) as error:
        text = quiet.getvalue() if isinstance(error, SystemExit) else f"{error}"
        reason = " ".join(text.split()) or type(error).__name__
        raise InputError(f"{path}: cannot be read by meshio: {reason}") from error


def _check_declared(path: Path, text: str, ending: str) -> None:
    """Raises InputError for a short text of more nodes, elements, points of grids (VTK) or members
    of sets (Abaqus) than memory holds, and as `_declared_members`."""
    for found in LARGE_NUMBER.finditer(text):
        if float(found[0]) > max(MAX_NUMBER, len(text)):
            raise InputError(
                f"{path}: has the number {found[0][:20]}; nodes and elements must be numbered up "
                f"to {MAX_NUMBER} at most"
            )
    count = 0.0
    if ending == ".vtk":
        grids = re.findall(r"^\s*DIMENSIONS\s+(\d+)\s+(\d+)\s+(\d+)", text, re.I | re.M)
        count = sum(math.prod(map(float, grid)) for grid in grids)
    elif ending == ".inp":
        count = _declared_members(path, text)
    inputs.check_memory(path, BYTES_OF_POINT * count)


def _declared_members(path: Path, text: str) -> float:
    """Number of members of the sets that an Abaqus file gives by their first and last one.

    Raises InputError if it includes another file; meshio would open whatever it names.
    """
    count, generated = 0.0, False
    for number, line in enumerate(text.splitlines(), 1):
        if line.partition(",")[0].replace("*", "").strip().upper() == "INCLUDE":
            raise InputError(f"{path}: line {number} includes another file; save the mesh as one")
        if line.lstrip().startswith("*"):
            generated = "GENERATE" in line.upper()
        elif generated and (ends := re.match(r"\s*(\d+)\s*,\s*(\d+)", line)):
            count += max(float(ends[2]) - float(ends[1]), 0.0)
    return count


def _pieces(mesh: Any, patterns: dict[str, list[tuple[int, ...]]]) -> tuple[Integer, Integer]:
    """Straight pieces of all elements of some types as numbers of points, and their elements.

    Shape (point, piece) and (piece,); elements are numbered through all blocks.
    """
    size = len(next(iter(patterns.values()))[0])
    pieces, cells = [np.empty((0, size), dtype=np.int64)], [np.empty(0, dtype=np.int64)]
    first = 0
    for block in mesh.cells:
        data = np.asarray(block.data, dtype=np.int64)
        for pattern in patterns.get(block.type, ()):
            pieces.append(data[:, pattern])
            cells.append(first + np.arange(len(data)))
        first += len(data)
    return np.concatenate(pieces).T, np.concatenate(cells)


def _distinct(pieces: Integer) -> tuple[Integer, Integer]:
    """Pieces without duplicates, and for every piece the number of the one kept.

    Point numbers are ascending in each column.
    """
    kept, same = np.unique(np.sort(pieces, axis=0), axis=1, return_inverse=True)
    return kept, same.ravel()


def _members(cells: Mask, of_piece: Integer, same: Integer) -> Integer:
    return np.unique(same[cells[of_piece]])


def _groups(mesh: Any) -> Iterator[tuple[str, Mask]]:
    """Yields the name of every group with a mask of its elements."""
    sizes = [len(block.data) for block in mesh.cells]
    for key, by_block in mesh.cell_data.items():
        values = np.concatenate([np.asarray(part) for part in by_block])
        if values.ndim == 1 and np.issubdtype(values.dtype, np.integer):
            for value in np.unique(values)[:MAX_GROUP_VALUES]:
                yield f"{key}={value}", values == value
    for name, by_block in mesh.cell_sets.items():
        if not name.startswith("gmsh:"):
            yield (
                name,
                np.concatenate(
                    [np.isin(np.arange(n), part) for n, part in zip(sizes, by_block, strict=True)]
                ),
            )
    yield from _physical(mesh, sizes)


def _physical(mesh: Any, sizes: list[int]) -> Iterator[tuple[str, Mask]]:
    """Yields gmsh's physical groups: elements of the group's dimension with its number."""
    tags = mesh.cell_data.get("gmsh:physical")
    if tags is None:
        return
    kinds = [0 if block.type == "vertex" else 1 + (block.type in TRIANGLES) for block in mesh.cells]
    dimension = np.repeat(kinds, sizes)
    for name, (tag, of_dimension) in mesh.field_data.items():
        members = (np.concatenate(tags) == tag) & (dimension == of_dimension)
        if not mesh.cell_sets.get(name):
            yield name, members


def _flat(points: Real) -> Real:
    """Points as rows (x, y) if all have the same z, otherwise (x, y, z)."""
    if points.shape[1] == 3 and (points[:, 2] == points[0, 2]).all():
        points = points[:, :2]
    return np.ascontiguousarray(points.T)

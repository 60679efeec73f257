"""Mesh files written for the campaign: quadrilaterals on a lattice, shaken, whole or in halves."""

from __future__ import annotations

import hashlib
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

import meshio
import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.accuracy.campaign_parts.draws import Rng
from rcskin.simulator.sweeps import whole_file

FOLDER = Path(tempfile.gettempdir()) / "rcskin-campaign"
SHAKEN = 0.25
"""Of the distance to neighbours, inner points at most."""


@dataclass(frozen=True)
class Lattice:
    """Cells between points of a lattice. p: m, shape (point, 2 or 3). cells: corners, shape (cell,
    4 or 3). lines: by name, shape (line, 2). groups: by name numbers of cells."""

    p: NDArray[np.float64]
    cells: NDArray[np.int64]
    lines: dict[str, NDArray[np.int64]]
    groups: dict[str, NDArray[np.int64]]


def lattice(x: NDArray[np.float64], y: NDArray[np.float64], around: bool = False) -> Lattice:
    """Between lines of x and y, its edges by name; around: the last line of x is the first."""
    columns, rows = len(x) - 1, len(y) - 1
    stride = columns if around else columns + 1
    i, j = np.meshgrid(np.arange(columns), np.arange(rows))
    i, j = i.ravel(), j.ravel()
    right = (i + 1) % stride if around else i + 1
    cells = np.stack([j * stride + i, j * stride + right, (j + 1) * stride + right])
    cells = np.vstack([cells, (j + 1) * stride + i]).T
    along, up = np.meshgrid(x[:stride], y)
    lines = {"bottom": cells[j == 0][:, :2], "top": cells[j == rows - 1][:, [3, 2]]}
    if not around:
        lines |= {"left": cells[i == 0][:, [0, 3]], "right": cells[i == columns - 1][:, [1, 2]]}
    p = np.stack([along.ravel(), up.ravel()], axis=1)
    return Lattice(p, cells, lines, {})


def shaken(rng: Rng, known: Lattice, fixed: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Points of a lattice in the plane, those not fixed moved a part of the way to a neighbour."""
    free = np.flatnonzero(~fixed)
    corner = known.cells
    across = np.linalg.norm(known.p[corner] - known.p[np.roll(corner, 1, axis=1)], axis=2)
    reach = np.full(len(known.p), np.inf)
    np.minimum.at(reach, corner.ravel(), np.repeat(across.min(axis=1), 4))
    moved = known.p.copy()
    moved[free] += SHAKEN * reach[free, None] * rng.uniform(-1, 1, (len(free), 2)) / 2**0.5
    return moved


def halved(rng: Rng, known: Lattice) -> Lattice:
    """Triangles, along one diagonal of each cell or the other."""
    turn = rng.integers(0, 2, len(known.cells))[:, None]
    a, b, c, d = (np.take_along_axis(known.cells, (k + turn) % 4, axis=1)[:, 0] for k in range(4))
    halves = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    count = len(known.cells)
    groups = {name: np.r_[each, each + count] for name, each in known.groups.items()}
    return replace(known, cells=halves, groups=groups)


def quartered(known: Lattice) -> Lattice:
    """Each triangle in four, without groups: the same surface, whether flat or not."""
    corners = known.cells
    sides = np.sort(np.stack([corners, np.roll(corners, -1, axis=1)], axis=2), axis=2)
    keys, number = np.unique(sides.reshape(-1, 2), axis=0, return_inverse=True)
    middle = len(known.p) + number.reshape(-1, 3)
    (a, b, c), (ab, bc, ca) = corners.T, middle.T
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    cells = np.concatenate([np.stack(part, axis=1) for part in parts])
    at = {(int(i), int(j)): len(known.p) + k for k, (i, j) in enumerate(keys)}
    lines = {
        name: np.array([(i, m) for i, j in each for m in [at[min(i, j), max(i, j)]]])
        for name, each in known.lines.items()
    }
    second = {
        name: np.array([(at[min(i, j), max(i, j)], j) for i, j in each])
        for name, each in known.lines.items()
    }
    both = {name: np.concatenate([lines[name], second[name]]) for name in lines}
    return Lattice(np.concatenate([known.p, known.p[keys].mean(axis=1)]), cells, both, {})


def written(known: Lattice) -> str:
    """The path of a file of it as gmsh writes them; the same path again for the same mesh."""
    kind = "triangle" if known.cells.shape[1] == 3 else "quad"
    names = {name: (number + 1, 1) for number, name in enumerate(known.lines)}
    tags = [np.full(len(lines), names[name][0]) for name, lines in known.lines.items()]
    of_cells = np.full(len(known.cells), len(names) + 1)
    for number, (name, members) in enumerate(known.groups.items()):
        of_cells[members] = len(tags) + 2 + number
        names[name] = len(tags) + 2 + number, 2
    p = np.pad(known.p, ((0, 0), (0, 3 - known.p.shape[1])))
    mesh = meshio.Mesh(
        p,
        [*(("line", lines) for lines in known.lines.values()), (kind, known.cells)],
        cell_data={name: [*tags, of_cells] for name in ("gmsh:physical", "gmsh:geometrical")},
        field_data={name: np.array(value) for name, value in names.items()},
    )
    content = [
        p.tobytes(),
        known.cells.tobytes(),
        repr(names).encode(),
        *(each.tobytes() for each in known.lines.values()),
    ]
    path = FOLDER / f"{hashlib.sha256(b''.join(content)).hexdigest()[:16]}.msh"
    if not path.exists():
        FOLDER.mkdir(exist_ok=True)
        with whole_file(path) as unfinished:
            meshio.write(unfinished, mesh, file_format="gmsh22", binary=False)
    return str(path)

"""Skins that are no rectangles, mesh files as gmsh has them, and measures of meshes."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from rcskin.simulator.mesh.arcs import arc_length, edge_numbers, edges_of
from rcskin.simulator.scene.planar import distance
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene

SCENES = Path(__file__).parent / "scenes"
FOOT = 0.05
"""Width of both arms of the L, m."""
L_AREA = 0.12 * 0.05 + 0.05 * 0.07


def altered(name, skin=(), **tables):
    """A scene of this folder with other tables, and other keys in its skin; None removes one."""
    data = load_scene(SCENES / f"{name}.toml").model_dump(by_alias=True, exclude_none=True)
    data.update(tables)
    data["skin"].update(skin)
    data["skin"] = {key: value for key, value in data["skin"].items() if value is not None}
    return Scene.model_validate(data)


def on_mesh(path, contacts=("feed", "far"), **tables):
    """The L as a mesh file has it, its foils at the named groups of boundary lines."""
    high, low = (
        {"name": f"{electrode}-{edge}", "electrode": electrode, "edge": edge}
        for electrode, edge in zip(("top", "bottom"), contacts, strict=True)
    )
    interface = {"name": "through", "high": [high["name"]], "low": [low["name"]]}
    skin = {"outline": None, "mesh": str(path)}
    return altered("l-shape", skin, contact=[high, low], interface=[interface], **tables)


def write_l(path, *, version=4.1, order=1, quadrilaterals=False):
    """The L as gmsh's files have it, irregular within: boundary groups `feed` and `far`, groups
    `arm` and `foot` of elements.

    `arm` is what lies above y = 0.05, `foot` the rest; `seam` are the lines between them.
    """
    p, cells = _l_of_quadrilaterals()
    kind = "quad"
    if not quadrilaterals:
        kind, cells = "triangle", np.concatenate([cells[:, :3], cells[:, [0, 2, 3]]])
    above = p[cells, 1].max(axis=1) > FOOT
    groups = [(kind, 2, "foot", cells[~above]), (kind, 2, "arm", cells[above])]
    for name, axis, line in (("feed", 1, 0.12), ("far", 0, 0.12), ("seam", 1, FOOT)):
        along = np.flatnonzero((p[:, axis] == line) & (p[:, 0] <= (0.12 if axis == 0 else FOOT)))
        along = along[np.argsort(p[along, 1 - axis])]
        groups.append(("line", 1, name, np.stack([along[:-1], along[1:]], axis=1)))
    if order == 2:
        p, groups = _second_order(p, groups)
    _write_groups(path, p, groups, {2.2: "gmsh22", 4.1: "gmsh"}[version])
    return path


def _l_of_quadrilaterals():
    """Points of the L in m, shape (point, 2), and cells, shape (cell, 4)."""
    along = np.concatenate([np.linspace(0, FOOT, 5), np.linspace(FOOT, 0.12, 6)[1:]])
    y, x = (each.ravel() for each in np.meshgrid(along, along, indexing="ij"))
    p, row = np.stack([x, y], axis=1), len(along)
    low = np.arange(row * (row - 1))
    low = low[low % row < row - 1]
    cells = np.stack([low, low + 1, low + row + 1, low + row], axis=1)
    cells = cells[(p[cells].min(axis=1) < FOOT - 1e-9).any(axis=1)]
    used = np.unique(cells)
    p, cells = p[used], np.searchsorted(used, cells)
    x, y = p.T
    inside = (x > 0) & (y > 0) & ((x < FOOT) & (y < 0.12) | (y < FOOT) & (x < 0.12)) & (y != FOOT)
    moved = np.random.default_rng(2).uniform(-0.003, 0.003, p.shape)
    return p + inside[:, None] * moved, cells


def _second_order(p, groups):
    """With points in the middle of edges, and of quadrilaterals."""
    middles = {}

    def middle(*corners):
        return middles.setdefault(tuple(sorted(corners)), len(p) + len(middles))

    kinds = {"line": "line3", "triangle": "triangle6", "quad": "quad9"}
    found = []
    for kind, dimension, name, cells in groups:
        turns = 1 if kind == "line" else cells.shape[1]
        rows = [
            [*cell, *(middle(cell[k], cell[(k + 1) % len(cell)]) for k in range(turns))]
            + ([middle(*cell)] if kind == "quad" else [])
            for cell in cells.tolist()
        ]
        found.append((kinds[kind], dimension, name, np.array(rows)))
    new = [p[list(corners)].mean(axis=0) for corners in middles]
    return np.concatenate([p, new]), found


def _write_groups(path, p, groups, file_format):
    import meshio

    of_points = np.zeros((len(p), 2), dtype=int)
    for number, (_, dimension, _, cells) in enumerate(groups):
        of_points[cells] = dimension, number + 1
    tags = [np.full(len(cells), number + 1) for number, (*_, cells) in enumerate(groups)]
    meshio.Mesh(
        np.pad(p, ((0, 0), (0, 1))),
        [(kind, cells) for kind, *_, cells in groups],
        point_data={"gmsh:dim_tags": of_points} if file_format == "gmsh" else None,
        cell_data={name: tags for name in ("gmsh:physical", "gmsh:geometrical")},
        field_data={
            name: np.array([number + 1, dimension])
            for number, (_, dimension, name, _) in enumerate(groups)
        },
    ).write(path, file_format=file_format)


def edges(t):
    """Every edge once, shape (2, edge), and how many triangles have it."""
    every = np.sort(np.hstack([t[[0, 1]], t[[1, 2]], t[[0, 2]]]), axis=0)
    return np.unique(every, axis=1, return_counts=True)


def lengths(domain, lines):
    """Lengths of edges, straight or bent, m."""
    straight = np.linalg.norm(domain.p[:, lines[0]] - domain.p[:, lines[1]], axis=0)
    every, _ = edges_of(domain.t)
    curvature = domain.arcs.of(every)[edge_numbers(lines, every)]
    return arc_length(straight, curvature)


def length_along(domain, segment, same=1e-9):
    """How much of a segment edges of the domain lie along, m."""
    lines, _ = edges(domain.t)
    ends = [distance(domain.p[:2, end].T, np.array([segment], dtype=float)) for end in lines]
    return lengths(domain, lines[:, (np.max(ends, axis=0)[:, 0] < same)]).sum()


def least_angle(domain):
    """Angles of all triangles, degrees."""
    corners = [domain.p[:, number] for number in domain.t]
    cosines = []
    for turn in range(3):
        a, b, c = (corners[(turn + k) % 3] for k in range(3))
        u, v = b - a, c - a
        cosines.append((u * v).sum(axis=0) / np.linalg.norm(u, axis=0) / np.linalg.norm(v, axis=0))
    return float(np.degrees(np.arccos(np.clip(cosines, -1, 1).max())))


def euler(domain):
    """Points - edges + triangles: 1 - holes for triangles that meet edge to edge."""
    lines, count = edges(domain.t)
    assert count.max() <= 2
    assert np.unique(domain.t).size == domain.p.shape[1]
    return domain.p.shape[1] - lines.shape[1] + domain.t.shape[1]


@pytest.fixture(scope="session")
def tools():
    """The functions of this file by name."""
    return SimpleNamespace(
        SCENES=SCENES,
        L_AREA=L_AREA,
        altered=altered,
        edges=edges,
        euler=euler,
        least_angle=least_angle,
        length_along=length_along,
        lengths=lengths,
        on_mesh=on_mesh,
        write_l=write_l,
    )

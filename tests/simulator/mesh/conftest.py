"""Skins that are no rectangles, mesh files as gmsh writes them, and measures of meshes."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from rcskin.simulator.mesh.arcs import arc_length
from rcskin.simulator.mesh.triangles import edge_numbers, edges_of
from rcskin.simulator.scene.files import load_scene
from rcskin.simulator.scene.planar import distance
from rcskin.simulator.scene.scene import Scene

SCENES = Path(__file__).parent / "scenes"
L_CORNERS = [(0, 0), (0.12, 0), (0.12, 0.05), (0.05, 0.05), (0.05, 0.12), (0, 0.12)]
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


def write_l(path, *, version=4.1, order=1, quadrilaterals=False, size=0.015):
    """The L meshed by gmsh: boundary groups `feed` and `far`, groups `arm` and `foot` of elements.

    `arm` is what lies above y = 0.05, `foot` the rest.
    """
    import gmsh

    gmsh.initialize([], readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("Mesh.MshFileVersion", version)
        geo = gmsh.model.geo
        for number, (x, y) in enumerate([*L_CORNERS, (0, 0.05)]):
            geo.addPoint(x, y, 0, size, number + 1)
        for start, stop in [(1, 2), (2, 3), (3, 4), (4, 7), (7, 1), (4, 5), (5, 6), (6, 7)]:
            geo.addLine(start, stop)
        geo.addCurveLoop([1, 2, 3, 4, 5], 1)
        geo.addCurveLoop([6, 7, 8, -4], 2)
        geo.addPlaneSurface([1], 1)
        geo.addPlaneSurface([2], 2)
        geo.synchronize()
        for dimension, members, name in [
            (1, [7], "feed"),
            (1, [2], "far"),
            (1, [4], "seam"),
            (2, [1], "foot"),
            (2, [2], "arm"),
        ]:
            gmsh.model.addPhysicalGroup(dimension, members, -1, name)
        if quadrilaterals:
            for surface in (1, 2):
                gmsh.model.mesh.setRecombine(2, surface)
        gmsh.model.mesh.generate(2)
        gmsh.model.mesh.setOrder(order)
        gmsh.write(str(path))
    finally:
        gmsh.finalize()
    return path


def edges(t):
    """Every edge once, shape (2, edge), and how many triangles have it."""
    every = np.sort(np.hstack([t[[0, 1]], t[[1, 2]], t[[0, 2]]]), axis=0)
    return np.unique(every, axis=1, return_counts=True)


def lengths(domain, lines):
    """Of edges, straight or bent, m."""
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
    """Of all triangles, degrees."""
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

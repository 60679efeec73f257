"""Skins of every kind that is not plain, coarse in pixels and frequencies, to be cheap."""

import meshio
import numpy as np
import pytest
from rcskin.simulator.scene.scene import Scene

SIDE, HALF = 0.12, 0.06
HEXAGON = [[0.03, 0], [0.09, 0], [SIDE, HALF], [0.09, SIDE], [0.03, SIDE], [0, HALF]]
L = [[0, 0], [SIDE, 0], [SIDE, HALF], [HALF, HALF], [HALF, SIDE], [0, SIDE]]
GRID = {"rows": 2, "columns": 2}
READOUT = dict.fromkeys(("magnitude_noise", "phase_noise"), 1e-3)


def uneven(seed):
    return {"map": {"kind": "random", "deviation": 0.2, "correlation_length": 0.06, "seed": seed}}


def build(name, skin, edges, *, top=(), bottom=(), foam=(), pixels=GRID, film=0.0):
    foils = zip(("top", "bottom"), edges, strict=True)
    return Scene.model_validate(
        {
            "name": name,
            "skin": {
                "length": SIDE,
                "width": SIDE,
                "top": {"sheet_resistance": 50e3, **dict(top)},
                "bottom": {"sheet_resistance": 40e3, **dict(bottom)},
                "foam": {"capacitance_per_area": 4.861e-9, **dict(foam)},
                **skin,
            },
            "contact": [
                {"name": sheet, "electrode": sheet, "edge": edge, "resistance": film}
                for sheet, edge in foils
            ],
            "interface": [{"name": "meter", "high": ["top"], "low": ["bottom"]}],
            "pixels": pixels,
            "press": {"factor_spread": 0.1},
            "sweep": {"frequencies": [1e3, 1e4, 1e5]},
            "readout": READOUT,
        }
    )


def written_mesh(path):
    """Triangles of an oblong: groups `near` and `far`, to be pixels, and others between them."""
    lines = np.linspace(0, SIDE, 7), np.linspace(0, HALF, 4)
    x, y = (each.ravel() for each in np.meshgrid(*lines))
    i, j = (each.ravel() for each in np.meshgrid(np.arange(6), np.arange(3)))
    low = 7 * j + i
    cells = np.concatenate([[low, low + 1, low + 8], [low, low + 8, low + 7]], axis=1).T
    column = np.tile(i, 2)
    blocks, tags = [], []
    for tag, members in enumerate((column < 2, (column > 1) & (column < 4), column > 3), 1):
        blocks.append(("triangle", cells[members]))
        tags.append(np.full(members.sum(), tag))
    for tag, line in ((4, 0.0), (5, SIDE)):
        along = np.flatnonzero(x == line)
        blocks.append(("line", np.stack([along[:-1], along[1:]], axis=1)))
        tags.append(np.full(len(along) - 1, tag))
    points = np.stack([x, y, np.zeros_like(x)], axis=1)
    names = {"near": [1, 2], "far": [3, 2], "left": [4, 1], "right": [5, 1]}
    mesh = meshio.Mesh(
        points,
        blocks,
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data={name: np.array(each) for name, each in names.items()},
    )
    meshio.write(path, mesh, file_format="gmsh22", binary=False)
    return str(path)


def every_kind(folder):
    """A scene of each kind by name. folder: for the file of a mesh."""
    path = written_mesh(folder / "oblong.msh")
    hole = {"circle": [0.03, 0.03, 0.012]}
    groups = {"rows": 1, "columns": 2, "groups": [["near", "far"]]}
    scenes = (
        build("hexagon", {"outline": {"points": HEXAGON}}, ("outline.2", "outline.5"), film=20.0),
        build("l with a hole", {"outline": {"points": L, "holes": [hole]}}, ("outline.6", "hole1")),
        build("uneven", {}, ("left", "left"), top=uneven(1), bottom=uneven(2), foam=uneven(3)),
        build(
            "piezoresistive",
            {"stretch": {"x": 1.2}, "width": 0.03},
            ("left", "left"),
            top={"piezoresistance": 2.0},
            pixels={"rows": 1, "columns": 2},
        ),
        build("mesh", {"mesh": path, "width": HALF}, ("left", "right"), pixels=groups),
        build("draped", {"shape": {"kind": "sphere", "radius": 0.1}}, ("left", "bottom")),
    )
    return {scene.name: scene for scene in scenes}


@pytest.fixture(scope="session")
def kinds(tmp_path_factory):
    """A scene of each kind by name."""
    return every_kind(tmp_path_factory.mktemp("mesh"))


@pytest.fixture(scope="session")
def check_slopes():
    """A function: slopes of a pressed pixel and of parameters are differences of a model's Z."""
    cells, rises, step = np.array([1]), np.array([0.8]), 1e-4

    def check_slopes(forward, *parameters, rtol):
        found = forward.respond(cells, rises)
        by_rise = (found.by_cell + found.by_gauge)[..., cells[0]]
        ahead, behind = (forward.respond(cells, rises + turn).Z for turn in (step, -step))
        slope, atol = (ahead - behind) / (2 * step), 0.1 * rtol * np.abs(by_rise).max()
        np.testing.assert_allclose(by_rise, slope, rtol=rtol, atol=atol)
        for name in parameters:
            ahead, behind = (
                forward.respond(cells, rises, {name: turn}).Z for turn in (step, -step)
            )
            slope, atol = (ahead - behind) / (2 * step), 1e-4 * np.abs(found.Z).max()
            np.testing.assert_allclose(found.by_parameter[name], slope, rtol=1e-3, atol=atol)

    return check_slopes

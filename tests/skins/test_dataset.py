"""Data sets of skins that are not plain: what is pressed, where it lies, and how near it is."""

import meshio
import numpy as np
import pytest
from rcskin.simulator.dataset.dataset_plan import DatasetPlan
from rcskin.simulator.dataset.drawn_presses import drawn_presses
from rcskin.simulator.dataset.generation import generate
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.mesh.pixel_coverage import pixel_coverage
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.skin_region import on_skin
from rcskin.simulator.sweeps import InputError, impedance, open_zarr
from rcskin.tests.library.scenes import ALIKE

RTOL = 1e-3
ANYWHERE = {"dataset.press.place": "anywhere", "dataset.press.cells_per_pixel": 4}


def made(scene, path, sweeps=40):
    generate(DatasetPlan(scene.parts, sweeps, 1, RTOL), path)
    return open_zarr(path).load()


HOLED = pytest.param("l with a hole", marks=pytest.mark.slow)


def fed_at(edge):
    return {"contact.top-left.edge": edge, "contact.bottom-left.edge": edge}


def as_outline(_):
    corners = [[0, 0], [0.12, 0], [0.12, 0.12], [0, 0.12]]
    return {"skin.outline": {"points": corners}, **fed_at("outline.4")}


def as_even_map(_):
    """Even but for what no meter sees, so that it is no plain scene."""
    return {"skin.top.map": {"kind": "grid", "values": [[1.0, 1.0], [1.0, 1.0 + 1e-9]]}}


def as_mesh(folder):
    x, y = (each.ravel() for each in np.meshgrid(*[np.linspace(0, 0.12, 5)] * 2))
    i, j = (each.ravel() for each in np.meshgrid(np.arange(4), np.arange(4)))
    low, rim = 5 * j + i, np.flatnonzero(x == 0)
    cells = np.concatenate([[low, low + 1, low + 6], [low, low + 6, low + 5]], axis=1).T
    blocks = [("triangle", cells), ("line", np.stack([rim[:-1], rim[1:]], axis=1))]
    tags = [np.full(len(block), k) for k, (_, block) in enumerate(blocks, 1)]
    mesh = meshio.Mesh(
        np.stack([x, y, np.zeros_like(x)], axis=1),
        blocks,
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data={"skin": np.array([1, 2]), "rim": np.array([2, 1])},
    )
    meshio.write(folder / "square.msh", mesh, file_format="gmsh22", binary=False)
    return {"skin.mesh": str(folder / "square.msh"), **fed_at("rim")}


@pytest.fixture(scope="module")
def plain_set(make_scene, tmp_path_factory):
    """A plain rectangle, and what its data set holds."""
    plain = make_scene(rows=2, columns=2, length=0.12, width=0.12)
    assert plain.parts.skin.uniform
    return plain, made(plain, tmp_path_factory.mktemp("plain") / "set.zarr")


@pytest.mark.parametrize("drawn", [as_outline, as_even_map, as_mesh])
def test_a_rectangle_by_any_route_gives_the_data_of_a_rectangle(plain_set, tmp_path, drawn):
    """Sweep by sweep, and so in every statistic, in single precision."""
    plain, one = plain_set
    scene = plain.with_(drawn(tmp_path))
    assert not scene.parts.skin.uniform
    other = made(scene, tmp_path / "set.zarr")
    assert one["press"].values.tolist() == other["press"].values.tolist()
    for name in ("Rs", "Cp"):
        np.testing.assert_allclose(one[name], other[name], rtol=2 * RTOL)
        for statistic in ("mean", "std"):
            known, found = (getattr(each[name], statistic)("sweep") for each in (one, other))
            np.testing.assert_allclose(known, found, rtol=2 * RTOL)
    for name in ("touch_x", "touch_y"):
        np.testing.assert_allclose(one[name], other[name], atol=1e-7)


def test_pixels_are_placed_at_the_middle_of_their_skin(kinds):
    scene = kinds["mesh"]
    presses = drawn_presses(scene.parts, np.random.default_rng(1), 100, (1, 2))
    single = presses.touches == 1
    expected = np.where(presses.column[single] == 1, 0.02, 0.10)
    np.testing.assert_allclose(presses.x[single, 0], expected)
    np.testing.assert_allclose(presses.y[single, 0], 0.03)


def test_touches_anywhere_have_their_middles_on_the_skin(kinds):
    scene = kinds["l with a hole"].with_(ANYWHERE)
    presses = drawn_presses(scene.parts, np.random.default_rng(1), 300, (8, 8))
    there = np.arange(2) < presses.touches[:, None]
    x = np.stack([presses.x[there], presses.y[there]])
    within = on_skin(scene.skin, x)
    assert 0.8 < within.mean()  # the others lie in cells that are partly skin
    assert pixel_coverage(scene.parts.skin, (8, 8)).part.sum() < 0.75 * 64
    assert len({str(each) for each in presses.text}) > 250


@pytest.mark.slow
def test_touches_anywhere_are_as_near_as_the_error_of_their_cells(kinds, tmp_path):
    scene = kinds["draped"].with_({**ALIKE, **ANYWHERE})
    data = made(scene, tmp_path / "out.zarr", 8)
    solver, Z = Solver(scene.parts, RTOL / 10), impedance(data)
    truth = solver.solve(parse_press(str(data["press"].values[5]), np.nan)).Z
    off = relative_difference(Z[5], truth).max()
    assert RTOL < data.attrs["cells_error"] < 0.1
    assert off <= 2 * data.attrs["cells_error"] + RTOL


def test_a_hand_beside_pixels_that_are_groups_is_refused(kinds):
    scene = kinds["mesh"].with_({"dataset.press.offset": 0.1})
    told = "`dataset.press.offset` must be 0 where `pixels.groups` says what pixels are, got 0.1"
    with pytest.raises(InputError, match=told):
        DatasetPlan(scene.parts, 10, 1, RTOL)

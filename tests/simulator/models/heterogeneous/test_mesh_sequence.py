"""How few meshes of triangles a tolerance takes, and what they are made for."""

from pathlib import Path

import numpy as np
import pytest
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.models.heterogeneous import triangle_meshes as of_triangles
from rcskin.simulator.models.heterogeneous.discretised import indicators
from rcskin.simulator.models.heterogeneous.elements import raising, triangles
from rcskin.simulator.models.heterogeneous.elements_model import circuit_of
from rcskin.simulator.models.heterogeneous.triangle_meshes import Triangles
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.scene.scene_files import load_scene

SCENES = Path(__file__).parents[2] / "mesh" / "scenes"
FEW_CELLS = 600


@pytest.fixture(scope="module")
def l_shape():
    return load_scene(SCENES / "l-shape.toml")


def finer(scene, press, rtol):
    """Cells and answer of each mesh until a tolerance is kept."""
    meshes, found = (
        Triangles(scene.parts.skin, circuit_of(scene.parts.skin, scene.parts.setup), press, rtol),
        [],
    )
    while True:
        mesh = meshes.finer(scene.frequencies)
        rung = mesh.result(scene.frequencies, rtol)
        assert not found or mesh.coarse.elements.cells > found[-1][0]
        found.append((mesh.coarse.elements.cells, rung))
        if rung.error.max() <= rtol:
            return found


@pytest.mark.parametrize("rtol", [1e-3, 1e-4, 1e-5])
def test_around_a_corner_two_meshes_are_enough(l_shape, rtol):
    """Each level towards the corner gains a factor of 2.5: one a mesh would take six or seven."""
    *_, (cells, rung) = found = finer(l_shape, parse_press("2,1", 2.0), rtol)
    assert len(found) <= 2
    assert cells < FEW_CELLS
    *_, (_, close) = finer(l_shape, parse_press("2,1", 2.0), rtol / 100)
    assert (relative_difference(rung.Z, close.Z) <= rung.error).all()


@pytest.mark.parametrize("rtol", [1e-3, 1e-4])
def test_halved_towards_a_corner_beforehand_one_mesh_is_enough(l_shape, rtol):
    ((cells, rung),) = finer(l_shape, parse_press("2,1", 2.0), rtol)
    assert cells < FEW_CELLS / 2
    *_, (_, close) = finer(l_shape, parse_press("2,1", 2.0), rtol / 100)
    true = relative_difference(rung.Z, close.Z)
    assert (true <= rung.error).all() and rung.error.max() <= 10 * true.max()


@pytest.mark.parametrize("share", [0.99, 0.8, 0.4])
@pytest.mark.parametrize("order", [2, 3])
def test_a_mesh_that_just_does_not_serve_is_followed_by_a_finer_one(
    l_shape, order, share, monkeypatch
):
    """Also if the second mesh is expected to have a smaller estimate. All tolerances begin
    on the same mesh here."""
    monkeypatch.setattr(of_triangles, "SECOND", np.inf)
    loose = {2: 1.0, 3: 1e-3}[order]
    first = Triangles(
        l_shape.parts.skin, circuit_of(l_shape.parts.skin, l_shape.parts.setup), Press(), loose
    ).finer(l_shape.frequencies)
    rtol = share * float(first.result(l_shape.frequencies, loose).error.max())
    meshes = Triangles(
        l_shape.parts.skin, circuit_of(l_shape.parts.skin, l_shape.parts.setup), Press(), rtol
    )
    meshes.order = order
    cells = []
    for _ in range(3):
        mesh = meshes.finer(l_shape.frequencies)
        cells.append(mesh.coarse.elements.cells)
        if mesh.result(l_shape.frequencies, rtol).error.max() <= rtol:
            break
    else:
        raise AssertionError(f"meshes of {cells} triangles do not serve")
    assert len(set(cells)) == len(cells) > 1


def test_parts_of_an_error_by_the_vectors_of_a_sweep_are_those_of_solves_of_their_own(l_shape):
    ends, rtol = l_shape.frequencies[[0, -1]], 1e-4
    mesh = Triangles(
        l_shape.parts.skin,
        circuit_of(l_shape.parts.skin, l_shape.parts.setup),
        parse_press("2,1", 2.0),
        rtol,
    ).finer(ends)
    own = indicators(mesh, ends)
    assert not any(each.kept.steps for each in (mesh.coarse, mesh.fine))
    mesh.result(l_shape.frequencies, rtol)
    excitation = mesh.circuit.excitations[0]
    assert all(each.kept.of(excitation, 2 * np.pi * ends) for each in (mesh.coarse, mesh.fine))
    by_sweep = indicators(mesh, ends)
    assert (by_sweep != own).any()
    assert (np.abs(by_sweep - own).sum(axis=1) <= 1e-2 * own.sum(axis=1)).all()
    beyond = np.array([4 * l_shape.frequencies[-1]])
    assert mesh.coarse.kept.of(excitation, 2 * np.pi * beyond) is None


def test_pixels_that_are_not_pressed_cost_nothing(l_shape):
    pixels = l_shape.pixels.model_copy(update={"rows": 4, "columns": 6})
    (few, _), (many, _) = (
        finer(scene, Press(), 1e-2)[0]
        for scene in (l_shape, l_shape.model_copy(update={"pixels": pixels}))
    )
    assert many <= 4 * few


@pytest.mark.parametrize("order", [1, 2, 3])
def test_functions_are_the_same_by_the_next_order(l_shape, order):
    mesh = Triangles(
        l_shape.parts.skin, circuit_of(l_shape.parts.skin, l_shape.parts.setup), Press(), 1e-2
    ).coarsest(1e3)
    low, high = (triangles(mesh, each).element for each in (order, order + 1))
    points = np.random.default_rng(order).dirichlet([1, 1, 1], 20).T[:2]
    own, next_order = (
        np.stack([each.lbasis(points, k)[0] for k in range(len(each.doflocs))])
        for each in (low, high)
    )
    assert raising(order).T @ next_order == pytest.approx(own, abs=1e-12)

"""Meshes of rectangles: they fill the skin, keep to its pixels and foils, and are fine at ends."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.fem.assembly import groups
from rcskin.simulator.mesh.quadrilaterals import RATIO, Resolution, pixel_mesh, tile_lines
from rcskin.simulator.scene.planar import distinct

RESOLUTIONS = st.builds(
    Resolution,
    order=st.just(2),
    cells=st.integers(1, 3),
    layers=st.integers(0, 3),
    edge_cell=st.sampled_from([np.inf, 1e-2, 1e-3]),
)


def areas(cells):
    """Areas of quadrilaterals, from their points."""
    (x, y), (x_next, y_next) = cells.p[:, cells.t], cells.p[:, np.roll(cells.t, -1, axis=0)]
    return abs((x * y_next - x_next * y).sum(axis=0)) / 2


@given(data=st.data(), resolution=RESOLUTIONS)
def test_every_pixel_is_filled_by_its_own_elements(random, data, resolution):
    scene = data.draw(random.between())
    pixels, skin = pixel_mesh(scene.parts.skin, scene.contacts, resolution), scene.skin
    count = scene.pixels.rows * scene.pixels.columns
    filled = np.bincount(pixels.pixel, weights=areas(pixels.cells), minlength=count)
    np.testing.assert_allclose(filled, skin.length * skin.width / count, rtol=1e-9)
    x, y = pixels.mesh.p[:, pixels.mesh.t].mean(axis=1)
    row = np.floor(y / skin.width * scene.pixels.rows)
    column = np.floor(x / skin.length * scene.pixels.columns)
    np.testing.assert_array_equal(pixels.pixel, row * scene.pixels.columns + column)


@given(data=st.data(), resolution=RESOLUTIONS, at=st.sets(st.floats(0.01, 0.99), max_size=3))
def test_every_part_between_further_lines_is_filled_by_its_own_elements(
    random, data, resolution, at
):
    scene = data.draw(random.between())
    x, y = (distinct([*(side * each for each in at), side]) for side in size(scene))
    resolution = replace(resolution, lines=(tuple(x[:-1].tolist()), tuple(y[:-1].tolist())))
    pixels = pixel_mesh(scene.parts.skin, scene.contacts, resolution)
    x, y = (tile_lines(scene.parts.skin, axis, resolution) for axis in (0, 1))
    of_tile = np.multiply.outer(np.diff(y), np.diff(x)).ravel()
    filled = np.bincount(pixels.pixel, weights=areas(pixels.cells), minlength=len(of_tile))
    np.testing.assert_allclose(filled, of_tile, rtol=1e-6, atol=1e-15)


def size(scene):
    """Length and width, m."""
    return scene.skin.length, scene.skin.width


@given(data=st.data(), resolution=RESOLUTIONS)
def test_every_foil_covers_its_span(random, data, resolution):
    scene = data.draw(random.between())
    pixels = pixel_mesh(scene.parts.skin, scene.contacts, resolution)
    for contact in scene.contacts:
        start, stop = np.array(contact.ends(scene.skin))
        facets = pixels.mesh.p[:, pixels.mesh.facets[:, pixels.facets(contact)]]
        covered = np.linalg.norm(facets[:, 1] - facets[:, 0], axis=0).sum()
        assert covered == pytest.approx(np.linalg.norm(stop - start), rel=1e-9)


@given(width=st.sampled_from([1e-2, 1e-3, 1e-5]))
def test_cells_at_a_fed_edge_are_as_thin_as_requested(make_scene, width):
    scene = make_scene(columns=2)
    x = np.unique(
        pixel_mesh(scene.parts.skin, scene.contacts, Resolution(2, edge_cell=width)).mesh.p[0]
    )
    assert x[1] - x[0] <= width * (1 + 1e-9)
    assert x[-1] - x[-2] > 1e-2


TIP = np.array([0.0, 0.04])
HALF = {"top-left": {"span": (0.0, 0.5)}, "bottom-left": {}}


@pytest.mark.parametrize("layers", [1, 3, 6, 14])
def test_rings_shrink_towards_the_end_of_a_foil(make_scene, layers):
    """They shrink by one ratio, with cells of one shape. The last cells keep that shape, although
    their points are too close to resolve it."""
    scene = make_scene(HALF)
    cells = pixel_mesh(scene.parts.skin, scene.contacts, Resolution(2, layers=layers)).cells
    distance = np.linalg.norm(cells.p - TIP[:, None], axis=0)
    nearest = np.sort(distance[distance > 0])[:5]
    patch = np.array([0.04, 0.04, 0.04, *np.sqrt(2) * np.array([0.04, 0.04])])
    np.testing.assert_allclose(nearest, patch * RATIO**layers, rtol=1e-4)
    assert len(groups(cells, 2)) == 5
    smallest = np.linalg.norm(cells.along, axis=0).min()
    assert smallest == pytest.approx(0.04 * RATIO**layers, rel=1e-12)


@given(data=st.data(), resolution=RESOLUTIONS)
def test_shapes_are_those_of_the_points(random, data, resolution):
    scene = data.draw(random.between())
    cells = pixel_mesh(scene.parts.skin, scene.contacts, resolution).cells
    first, second, third, fourth = cells.p[:, cells.t].transpose(1, 0, 2)
    for shape, points in (
        (cells.along, second - first),
        (cells.across, fourth - first),
        (cells.along + cells.across + cells.twist, third - first),
    ):
        np.testing.assert_allclose(shape, points, rtol=0, atol=1e-15)


@given(data=st.data(), resolution=RESOLUTIONS)
def test_neighbours_run_along_their_edge_in_one_direction(random, data, resolution):
    """Edge functions of odd degree would else change sign between them."""
    scene = data.draw(random.between())
    t = pixel_mesh(scene.parts.skin, scene.contacts, resolution).cells.t
    edges = {
        edge for a, b in ((0, 1), (3, 2), (0, 3), (1, 2)) for edge in zip(t[a], t[b], strict=True)
    }
    assert not {(b, a) for a, b in edges} & edges

"""Meshes of rectangles: they fill the skin, keep to its pixels and foils, and are fine at ends."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simulator.assembly import areas
from simulator.mesh import Resolution, pixel_mesh

RESOLUTIONS = st.builds(
    Resolution,
    order=st.just(2),
    cells=st.integers(1, 3),
    layers=st.integers(0, 3),
    edge_cell=st.sampled_from([np.inf, 1e-2, 1e-3]),
)


@given(data=st.data(), resolution=RESOLUTIONS)
def test_every_pixel_is_filled_by_its_own_elements(random, data, resolution):
    scene = data.draw(random.between())
    pixels, skin = pixel_mesh(scene, scene.contacts, resolution), scene.skin
    count = scene.pixels.rows * scene.pixels.columns
    filled = np.bincount(pixels.pixel, weights=areas(pixels.mesh), minlength=count)
    np.testing.assert_allclose(filled, skin.length * skin.width / count, rtol=1e-9)
    x, y = pixels.mesh.p[:, pixels.mesh.t].mean(axis=1)
    row = np.floor(y / skin.width * scene.pixels.rows)
    column = np.floor(x / skin.length * scene.pixels.columns)
    np.testing.assert_array_equal(pixels.pixel, row * scene.pixels.columns + column)


@given(data=st.data(), resolution=RESOLUTIONS)
def test_every_foil_covers_its_span(random, data, resolution):
    scene = data.draw(random.between())
    pixels = pixel_mesh(scene, scene.contacts, resolution)
    for contact in scene.contacts:
        start, stop = np.array(contact.ends(scene.skin))
        facets = pixels.mesh.p[:, pixels.mesh.facets[:, pixels.facets(contact)]]
        covered = np.linalg.norm(facets[:, 1] - facets[:, 0], axis=0).sum()
        assert covered == pytest.approx(np.linalg.norm(stop - start), rel=1e-9)


@given(width=st.sampled_from([1e-2, 1e-3, 1e-5]))
def test_cells_at_a_fed_edge_are_as_thin_as_asked(make_scene, width):
    scene = make_scene(columns=2)
    x = np.unique(pixel_mesh(scene, scene.contacts, Resolution(2, edge_cell=width)).mesh.p[0])
    assert x[1] - x[0] <= width * (1 + 1e-9)
    assert x[-1] - x[-2] > 1e-2


@pytest.mark.parametrize("layers", [1, 3, 6])
def test_cells_shrink_towards_the_end_of_a_foil(make_scene, layers):
    scene = make_scene({"top-left": {"span": (0.0, 0.5)}, "bottom-left": {}})
    x, y = (
        np.unique(coordinate)
        for coordinate in pixel_mesh(scene, scene.contacts, Resolution(2, layers=layers)).mesh.p
    )
    beside = np.diff(y)[np.searchsorted(y, 0.04) + np.array([-1, 0])]
    assert (beside < 0.04 * 0.21**layers).all()
    assert x[1] - x[0] < 0.1 * 0.21**layers

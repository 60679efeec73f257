"""Images of depth and pressure: means over cells, conservation, and agreement with touches."""

import numpy as np
import pytest
from rcskin import DepthImage, PressureImage
from rcskin.simulator.press.batch import PressBatch
from rcskin.simulator.press.press import press_on
from rcskin.simulator.press.rasterized import touched_cells
from rcskin.simulator.sensor.contacts.rasterizer import ContactRasterizer, to_cells

GRID = 10, 15


def dense(batch, grid=GRID):
    rises = np.zeros((batch.count, grid[0] * grid[1]))
    np.add.at(rises, (batch.press, batch.cells), batch.rises)
    return rises.reshape(-1, *grid)


def field(count, scene):
    """A smooth depth at the middles of count x count rectangles, m."""
    x, y = ((np.arange(count) + 0.5) * side / count for side in scene.skin.sides)
    return 2e-3 * np.exp(-((x - 0.05) ** 2 + (y[:, None] - 0.06) ** 2) / 0.015**2)


def test_an_image_of_a_touch_is_the_touch(sharp):
    depth = np.zeros((40, 40))  # 3 mm rectangles
    depth[10:14, 20:30] = 1.5e-3
    press = press_on(
        sharp.parts.skin,
        sharp.press,
        f"rect(0.075,0.036,0.03,0.012):{sharp.parts.skin.factor_at(1.5e-3)!r}",
    )
    expected = dense(PressBatch.of([touched_cells(sharp.parts.skin, press, GRID)]))
    np.testing.assert_allclose(
        dense(to_cells(sharp.parts.skin, sharp.press, GRID, DepthImage(depth))), expected, atol=1e-6
    )
    pressure = float(sharp.skin.foam.mechanics.elastic.stress(np.array(1.5e-3 / 4e-3)))
    found = to_cells(
        sharp.parts.skin, sharp.press, GRID, PressureImage(np.where(depth > 0, pressure, 0.0))
    )
    np.testing.assert_allclose(dense(found), expected, atol=1e-4)


def test_finer_images_of_a_field_converge(sharp):
    exact = dense(to_cells(sharp.parts.skin, sharp.press, GRID, DepthImage(field(960, sharp))))
    errors = [
        np.abs(
            dense(to_cells(sharp.parts.skin, sharp.press, GRID, DepthImage(field(count, sharp))))
            - exact
        ).max()
        for count in (60, 120, 240)
    ]
    assert errors[0] < 5e-3 * exact.max()
    assert errors[1] < errors[0] / 3 and errors[2] < errors[1] / 3


def test_c_is_averaged_and_not_the_depth(sharp):
    depth = np.array([[0.0, 2e-3]])
    (rise,) = dense(
        to_cells(sharp.parts.skin, sharp.press, (1, 1), DepthImage(depth)), (1, 1)
    ).ravel()
    assert rise == pytest.approx((sharp.parts.skin.factor_at(2e-3) - 1) / 2, rel=1e-6)


def test_an_image_coarser_than_the_cells(sharp):
    rises = dense(
        to_cells(sharp.parts.skin, sharp.press, (4, 6), DepthImage([[1e-3, 0.0], [0.0, 2e-3]])),
        (4, 6),
    )[0]
    one, two = (sharp.parts.skin.factor_at(depth) - 1 for depth in (1e-3, 2e-3))
    np.testing.assert_allclose(rises, np.kron([[one, 0], [0, two]], np.ones((2, 3))), rtol=1e-6)


def test_images_of_many_skins(sharp):
    random = np.random.default_rng(1)
    depth = random.uniform(0, 1e-3, (3, 7, 8)) * (random.random((3, 7, 8)) < 0.4)
    depth[1] = 0.0
    batch = to_cells(sharp.parts.skin, sharp.press, GRID, DepthImage(depth))
    for skin in range(3):
        alone = to_cells(sharp.parts.skin, sharp.press, GRID, DepthImage(depth[skin]))
        np.testing.assert_array_equal(batch.one(skin).cells, alone.cells)
        np.testing.assert_array_equal(batch.one(skin).rises, alone.rises)


@pytest.mark.parametrize("image", [DepthImage([[1.0, 1e-3]]), PressureImage([[1e9, 1.0]])])
def test_values_beyond_the_foam_are_limited_and_said(sharp, image):
    found = ContactRasterizer.of(sharp.parts.skin, sharp.press, (1, 2))(image)
    assert found.limited.tolist() == [True]
    assert found.batch.rises[0] == pytest.approx(sharp.parts.skin.max_factor - 1, rel=1e-6)

"""Point contacts press cells like the same touches of a press, and by closed forms."""

import numpy as np
import pytest
from rcskin import PointContacts, Sensor
from rcskin.simulator.models.mechanics.indentation import deformation
from rcskin.simulator.press.batch import PressBatch
from rcskin.simulator.press.press import press_on
from rcskin.simulator.press.rasterized import touched_cells
from rcskin.simulator.sensor.contacts.rasterizer import ContactRasterizer, to_cells

GRID = 15, 20
PRESSED = {
    "disc(0.05,0.07,0.012):3N": PointContacts([0.05], [0.07], [3.0], 0.012),
    "rect(0.05,0.07,0.03,0.01):2N": PointContacts(0.05, 0.07, 2.0, size=(0.03, 0.01)),
    "disc(0.05,0.07,0.012):1mm+disc(0.09,0.02,0.005):2mm": PointContacts(
        [0.05, 0.09], [0.07, 0.02], radius=[0.012, 0.005], depth=[1e-3, 2e-3]
    ),
    "disc(0.05,0.07,0.012):3.0": PointContacts(0.05, 0.07, radius=0.012, factor=3.0),
}


def dense(batch, grid=GRID):
    """Rises on all cells, shape (press, row, column)."""
    rises = np.zeros((batch.count, grid[0] * grid[1]))
    np.add.at(rises, (batch.press, batch.cells), batch.rises)
    return rises.reshape(-1, *grid)


@pytest.mark.parametrize("text", PRESSED)
def test_they_are_the_touches_of_a_press(sharp, text):
    press = press_on(sharp.parts.skin, sharp.press, text)
    factors = deformation(sharp.parts.skin, press, 1e-3).sharp if press.indented else press
    expected = dense(PressBatch.of([touched_cells(sharp.parts.skin, factors, GRID)]))
    found = dense(to_cells(sharp.parts.skin, sharp.press, GRID, PRESSED[text]))
    np.testing.assert_allclose(found, expected, rtol=2e-6, atol=1e-12)


def test_factors_of_overlapping_patches_multiply(sharp):
    found = to_cells(
        sharp.parts.skin,
        sharp.press,
        GRID,
        PointContacts([0.04, 0.05], 0.06, radius=[0.012, 0.01], factor=[2.0, 1.5]),
    )
    press = press_on(
        sharp.parts.skin, sharp.press, "disc(0.04,0.06,0.012):2.0+disc(0.05,0.06,0.01):1.5"
    )
    expected = PressBatch.of([touched_cells(sharp.parts.skin, press, GRID)])
    np.testing.assert_allclose(dense(found), dense(expected), atol=1e-12)


def test_no_contact_is_the_unpressed_skin(sharp):
    assert not to_cells(
        sharp.parts.skin, sharp.press, GRID, PointContacts([], [], [], 0.01)
    ).cells.size
    assert not to_cells(
        sharp.parts.skin, sharp.press, GRID, PointContacts(0.05, 0.05, 0.0, 0.01)
    ).cells.size


def test_many_skins_are_each_of_them(sharp):
    random = np.random.default_rng(1)
    x, y = random.uniform(0.02, 0.1, (2, 7, 3))
    force, radius = random.uniform(0.1, 2.0, (7, 3)), random.uniform(2e-3, 8e-3, (7, 3))
    count = np.array([3, 0, 1, 2, 3, 3, 0])
    batch = to_cells(
        sharp.parts.skin, sharp.press, GRID, PointContacts(x, y, force, radius, count=count)
    )
    for skin, own in enumerate(count):
        one = PointContacts(*(each[skin, :own] for each in (x, y, force, radius)))
        alone = to_cells(sharp.parts.skin, sharp.press, GRID, one)
        np.testing.assert_array_equal(batch.one(skin).cells, alone.cells)
        np.testing.assert_array_equal(batch.one(skin).rises, alone.rises)


def test_a_force_too_large_limits_the_foam_and_says_so(sharp):
    strong = PointContacts([0.05, 0.02], 0.05, [1e6, 1.0], 0.01)
    found = ContactRasterizer.of(sharp.parts.skin, sharp.press, GRID)(strong)
    assert found.limited.tolist() == [True]
    most = sharp.parts.skin.max_factor - 1
    assert found.batch.rises.max() == pytest.approx(most, rel=1e-9)
    gentle = PointContacts([0.05, 0.02], 0.05, 1.0, 0.01)
    assert not ContactRasterizer.of(sharp.parts.skin, sharp.press, GRID)(gentle).limited.any()


@pytest.mark.parametrize("tension", [0.0, 20.0])
def test_a_model_s_largest_factor_limits_as_closed_cells_do(sharp, tension):
    scene = sharp.with_({"skin.foam.mechanics.tension": tension})
    found = ContactRasterizer.of(scene.parts.skin, scene.press, GRID, highest=3.0)(
        PointContacts(0.05, 0.05, 1e3, 0.02)
    )
    assert found.limited.tolist() == [True]
    assert found.batch.rises.max() == pytest.approx(2.0, rel=1e-5)


@pytest.mark.parametrize(("count", "radius"), [(8, 6e-3), (3, 1e-2), (2, 3e-3)])
def test_patches_that_overlap_end_with_the_foam(sharp, count, radius):
    """Loads that compress the foam whole are limited, however their patches lie on the cells."""
    sensor, middle = Sensor(sharp, rtol=1e-2), np.array(sharp.skin.sides) / 2
    x = middle[0] + 2e-3 * np.arange(count)
    readings = [
        sensor.step(PointContacts(at, [middle[1]] * len(at), [1e4] * len(at), radius), 1.0)
        for at in (x[:1], x)
    ]
    assert readings[1].limited.all()
    assert readings[1].Cp[0, 0, 0] > 0.98 * readings[0].Cp[0, 0, 0]  # the meter has noise

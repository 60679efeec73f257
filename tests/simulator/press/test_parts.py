"""How presses name the parts of M: foam, fingers, the field across the foam, what stays."""

from dataclasses import replace

import numpy as np
import pytest
import rcskin
from rcskin.simulator.press.batch import PressBatch
from rcskin.simulator.press.parts import parts_of
from rcskin.simulator.press.press import press_on
from rcskin.simulator.press.rasterized import touched_cells
from rcskin.simulator.press.walls import step_capacitance
from rcskin.simulator.sweeps import InputError

COVER = {"thickness": 1e-3, "relative_permittivity": 3.0}


@pytest.fixture(scope="module")
def walled(scene):
    return scene.with_({"surroundings.edges": True})


@pytest.fixture(scope="module")
def scene():
    around = {"cover": COVER, "thickness": True, "rim": 8e-12, "body": {"distance": 5e-3}}
    sheet = {"skin.foam.thickness": 4e-3, "skin.foam.relative_permittivity": 2.2}
    foam = {"skin.foam.capacitance_per_area": None, **sheet}
    return rcskin.load("sheet-5x5").with_({"pixels": 3, "surroundings": around, **foam})


def test_a_scene_without_surroundings_has_foam_alone():
    parts = parts_of(rcskin.load("sheet-5x5").parts.skin)
    assert (parts.count, parts.fingers, parts.around) == (25, 0, False)
    batch = PressBatch.even(np.array([[3], [4]]), np.array([[0.5], [1.0]]))
    assert parts.followed(batch) is batch


def test_parts_follow_each_other_kind_by_kind(scene):
    parts = parts_of(scene.parts.skin)
    assert [kind.stop - kind.start for kind in parts.kind] == [9, 9, 9, 0]
    assert parts.fixed == ("body", "rim")
    assert parts.count == 29
    assert parts_of(scene.parts.skin, (6, 6)).finger(np.array([0])) == [36]


def test_a_body_in_front_of_the_touched_sheet_leaves_no_fingers(scene):
    body = {"side": "top", "distance": 5e-3}
    around = {"cover": None, "body": body}
    shielded = scene.with_({f"surroundings.{key}": each for key, each in around.items()})
    assert parts_of(shielded.parts.skin).fingers == 0


def test_what_is_pressed_is_there_and_the_field_across_foam_goes_with_one_over_its_factor(scene):
    """However a press says it: once, in two rises of one pixel, or as one of a batch."""
    parts, rng = parts_of(scene.parts.skin), np.random.default_rng(0)
    presses = [
        (np.array([4, 13]), np.array([1.0, 5e-12])),
        (np.array([], dtype=np.int64), np.array([])),
        (np.array([8, 0, 8]), np.array([0.5, 0.3, 0.5])),
        (np.array([17]), np.array([2e-12])),
        (rng.permutation(9)[:3], rng.uniform(-0.4, 2.0, 3)),
    ]
    followed = parts.followed(PressBatch.of(presses))
    for own, found in zip(presses, followed.each(), strict=True):
        there = parts.pressed(*own)
        np.testing.assert_allclose(there[18:27], 1 / there[:9])
        summed = parts.resting.copy()
        np.add.at(summed, *found)
        np.testing.assert_allclose(summed, there)
        np.testing.assert_allclose(parts.completed(*own), found)
    assert parts.pressed(*presses[0])[13] == 5e-12


def test_the_pixel_of_each_touch_is_counted_once(scene):
    pixels, first = parts_of(scene.parts.skin).pixels(np.array([[4, 13, 2], [9, 0, 1]]))
    np.testing.assert_array_equal(pixels, [[4, 4, 2], [0, 0, 1]])
    np.testing.assert_array_equal(first, [[True, False, True], [True, False, True]])


def test_a_finger_is_spread_evenly_over_what_it_covers(scene):
    """Of a pixel on that pixel alone; on a finer grid by the area that it covers of each cell."""
    pixel = touched_cells(scene.parts.skin, press_on(scene.parts.skin, scene.press, "2,2:2:6pF"))
    assert dict(zip(*map(np.ndarray.tolist, pixel), strict=True)) == {4: 1.0, 13: 6e-12}
    cells, rises = touched_cells(
        scene.parts.skin,
        press_on(scene.parts.skin, scene.press, "2,2:touch+1,1:3:2pF"),
        (6, 6),
    )
    own = cells >= 36
    assert rises[own].sum() == pytest.approx(
        2e-12 + press_on(scene.parts.skin, scene.press, "2,2:touch").touches[0].finger
    )
    assert (cells[~own] < 12).all()
    half = scene.skin.length / 6
    rect = f"rect({half},{half},{half},{2 * half}):touch"
    cells, rises = touched_cells(scene.parts.skin, press_on(scene.parts.skin, scene.press, rect))
    np.testing.assert_array_equal(cells, [9])
    assert rises.sum() == pytest.approx(
        press_on(scene.parts.skin, scene.press, rect).touches[0].finger
    )


def test_walls_stand_between_pixels_that_are_pressed_to_different_thickness(walled):
    """Twelve of 3 x 3 pixels; E of the step from one side to the other, whoever presses it."""
    parts, rng = parts_of(walled.parts.skin), np.random.default_rng(1)
    assert (parts.kind[3].start, parts.kind[3].stop, parts.count) == (27, 39, 41)
    presses = [
        (np.array([4]), np.array([1.0])),
        (np.array([4, 5, 13]), np.array([1.0, 1.0, 5e-12])),
        (np.array([], dtype=np.int64), np.array([])),
        (np.array([8, 0, 8]), np.array([0.5, 0.3, 0.5])),
        (rng.permutation(9)[:4], rng.uniform(-0.4, 2.0, 4)),
    ]
    followed = parts.followed(PressBatch.of(presses))
    for own, found in zip(presses, followed.each(), strict=True):
        there = parts.pressed(*own)
        for (one, other), wall in zip(parts.walls.pairs, there[parts.kind[3]], strict=True):
            thin = sorted(1 / there[[one, other]])
            assert wall == pytest.approx(step_capacitance(thin[0] / thin[1]), abs=1e-15)
        summed = parts.resting.copy()
        np.add.at(summed, *found)
        np.testing.assert_allclose(summed, there, atol=1e-15)
        np.testing.assert_allclose(parts.completed(*own), found)
    alone, pair = (parts.pressed(*own)[parts.kind[3]] for own in presses[:2])
    assert np.count_nonzero(alone) == 4
    assert np.count_nonzero(pair) == 5


@pytest.mark.parametrize("elastic", [False, True])
@pytest.mark.parametrize("own", [0.6, 1.5, 2.5])
@pytest.mark.parametrize("other", [0.8, 1.0, 2.0])
def test_slopes_of_walls_are_differences(walled, elastic, own, other):
    parts = parts_of(walled.parts.skin)
    if elastic:
        own, other = max(own, 1.2), max(other, 1.0)
        parts = replace(parts, mechanics=rcskin.load("foam").skin.foam.mechanics)
    own, other = np.array(own), np.array(other)
    difference = (parts.wall(own + 1e-4, other) - parts.wall(own - 1e-4, other)) / 2e-4
    assert parts.wall_slope(own, other) == pytest.approx(difference, rel=1e-5)
    assert parts.wall_slope(own, own) == 0


def test_touches_that_are_no_whole_cells_have_no_walls(walled):
    with pytest.raises(InputError, match=r"cannot take `surroundings\.edges`: it is"):
        touched_cells(
            walled.parts.skin,
            press_on(walled.parts.skin, walled.press, "disc(0.05,0.05,0.02):2"),
        )
    third = walled.skin.length / 3
    whole = f"rect({third},{third / 2},{2 * third},{third}):2:rod"
    assert touched_cells(
        walled.parts.skin, press_on(walled.parts.skin, walled.press, whole)
    ).cells.tolist() == [0, 1]
    with pytest.raises(InputError, match=r"press rect"):
        touched_cells(
            walled.parts.skin,
            press_on(walled.parts.skin, walled.press, f"rect({third},0.06,{third},0.02):2"),
        )

"""How presses name the parts of M: foam, fingers, the field across the foam, what stays."""

import numpy as np
import pytest
import rcskin
from rcskin.simulator.press.batch import PressBatch
from rcskin.simulator.press.capacitance import touched_cells
from rcskin.simulator.press.parts import parts_of
from rcskin.simulator.press.press import press_on

COVER = {"thickness": 1e-3, "relative_permittivity": 3.0}


@pytest.fixture(scope="module")
def scene():
    around = {"cover": COVER, "thickness": True, "rim": 8e-12, "body": {"distance": 5e-3}}
    sheet = {"skin.foam.thickness": 4e-3, "skin.foam.relative_permittivity": 2.2}
    foam = {"skin.foam.capacitance_per_area": None, **sheet}
    return rcskin.load("sheet-5x5").with_({"pixels": 3, "surroundings": around, **foam})


def test_a_scene_without_surroundings_has_foam_alone():
    parts = parts_of(rcskin.load("sheet-5x5"))
    assert (parts.count, parts.fingers, parts.around) == (25, 0, False)
    batch = PressBatch.even(np.array([[3], [4]]), np.array([[0.5], [1.0]]))
    assert parts.followed(batch) is batch


def test_parts_follow_each_other_kind_by_kind(scene):
    parts = parts_of(scene)
    assert [kind.stop - kind.start for kind in parts.kind] == [9, 9, 9]
    assert parts.fixed == ("body", "rim")
    assert parts.count == 29
    assert parts_of(scene, (6, 6)).finger(np.array([0])) == [36]


def test_a_body_in_front_of_the_touched_sheet_leaves_no_fingers(scene):
    body = {"side": "top", "distance": 5e-3}
    around = {"cover": None, "body": body}
    shielded = scene.with_({f"surroundings.{key}": each for key, each in around.items()})
    assert parts_of(shielded).fingers == 0


def test_what_is_pressed_is_there_and_the_field_across_foam_goes_with_one_over_its_factor(scene):
    """However a press says it: once, in two rises of one pixel, or as one of a batch."""
    parts, rng = parts_of(scene), np.random.default_rng(0)
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
        np.testing.assert_allclose(parts.with_thickness(*own), found)
    assert parts.pressed(*presses[0])[13] == 5e-12


def test_the_pixel_of_each_touch_is_counted_once(scene):
    pixels, first = parts_of(scene).pixels(np.array([[4, 13, 2], [9, 0, 1]]))
    np.testing.assert_array_equal(pixels, [[4, 4, 2], [0, 0, 1]])
    np.testing.assert_array_equal(first, [[True, False, True], [True, False, True]])


def test_a_finger_is_spread_evenly_over_what_it_covers(scene):
    """Of a pixel on that pixel alone; on a finer grid by the area that it covers of each cell."""
    pixel = touched_cells(scene, press_on(scene, "2,2:2:6pF"))
    assert dict(zip(*map(np.ndarray.tolist, pixel), strict=True)) == {4: 1.0, 13: 6e-12}
    cells, rises = touched_cells(scene, press_on(scene, "2,2:touch+1,1:3:2pF"), (6, 6))
    own = cells >= 36
    assert rises[own].sum() == pytest.approx(2e-12 + press_on(scene, "2,2:touch").touches[0].finger)
    assert (cells[~own] < 12).all()
    half = scene.skin.length / 6
    rect = f"rect({half},{half},{half},{2 * half}):touch"
    cells, rises = touched_cells(scene, press_on(scene, rect))
    np.testing.assert_array_equal(cells, [9])
    assert rises.sum() == pytest.approx(press_on(scene, rect).touches[0].finger)

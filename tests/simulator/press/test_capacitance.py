import numpy as np
import pytest
from rcskin.simulator.press.capacitance import capacitance_map, lines, tile_map, touched_box
from rcskin.simulator.press.pixels import pixel_lines
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.foam import VACUUM_PERMITTIVITY, Foam
from rcskin.simulator.sweeps import InputError
from rcskin.tests.library.rasters import cell_map

SIZE = {"length": 0.1, "width": 0.08, "rows": 4, "columns": 5, "c": 1.0}


def exact(scene, press):
    """Factors between all lines, and those lines."""
    x, y = (
        np.sort([*pixel_lines(scene.parts.skin, axis), *more])
        for axis, more in enumerate(lines(scene.parts.skin, press))
    )
    return tile_map(scene.parts.skin, press, x, y), x, y


def test_rows_run_from_the_bottom_edge_and_columns_from_the_left(make_scene):
    scene = make_scene(rows=2, columns=3, c=1.0)
    c = capacitance_map(scene.parts.skin, parse_press("2,1:3+1,3:0.5", 2.0))
    np.testing.assert_array_equal(c, [[1.0, 1.0, 0.5], [3.0, 1.0, 1.0]])


def test_nothing_pressed_is_the_foam_at_rest(make_scene):
    scene = make_scene(rows=2, columns=2, c=4e-9)
    c = capacitance_map(
        scene.parts.skin,
        parse_press("none", 2.0),
    )
    np.testing.assert_array_equal(c, np.full((2, 2), 4e-9))


def test_capacitance_from_thickness_and_permittivity():
    """2.2 makes 70 pF of 4 mm of foam between 120 x 120 mm."""
    foam = Foam(thickness=4e-3, relative_permittivity=2.2)
    assert foam.unpressed_capacitance_per_area == 2.2 * VACUUM_PERMITTIVITY / 4e-3
    assert round(foam.unpressed_capacitance_per_area * 0.120**2 * 1e12) == 70


@pytest.mark.parametrize(
    "given",
    [
        {},
        {"thickness": 4e-3},
        {"relative_permittivity": 2.2},
        {"capacitance_per_area": 5e-9, "relative_permittivity": 2.2},
        {"capacitance_per_area": 5e-9, "thickness": 4e-3, "relative_permittivity": 2.2},
    ],
)
def test_capacitance_is_given_one_way_or_the_other(given):
    with pytest.raises(ValueError, match="either capacitance_per_area, or thickness with"):
        Foam(**given)


def test_a_cell_is_touched_by_the_area_covered(make_scene):
    scene = make_scene(**SIZE)
    factors = cell_map(scene.parts.skin, parse_press("rect(0.04,0.02,0.02,0.04):3", 2.0), 2, 5)
    np.testing.assert_allclose(factors, [[1, 2, 2, 1, 1], [1, 1, 1, 1, 1]], atol=1e-12)


def test_factors_multiply_where_touches_overlap(make_scene):
    scene, press = make_scene(**SIZE), parse_press("1,2:3+rect(0.03,0.02,0.02,0.04):3", 2.0)
    factors, _, _ = exact(scene, press)
    assert sorted(set(factors.ravel().round(12))) == [1, 3, 9]
    assert cell_map(scene.parts.skin, press, 4, 5)[0, 1] == pytest.approx(3 * 3)


@pytest.mark.parametrize(
    ("text", "area"),
    [
        ("rect(0.0317,0.0456,0.0123,0.0456):2", 0.0123 * 0.0456),
        ("rect(0.05,0.04,1e-6,2e-6):2", 2e-12),
    ],
)
def test_the_whole_capacitance_is_that_of_the_area(make_scene, text, area):
    scene, press = make_scene(**SIZE), parse_press(text, 2.0)
    factors, x, y = exact(scene, press)
    assert (factors - 1).sum(axis=None, where=factors < 1) == 0
    assert np.diff(y) @ (factors - 1) @ np.diff(x) == pytest.approx(area, rel=1e-9)
    for rows, columns in ((1, 1), (3, 7), (40, 50)):
        covered = (cell_map(scene.parts.skin, press, rows, columns) - 1).mean() * 0.1 * 0.08
        assert covered == pytest.approx(area, rel=1e-7)


def test_a_disc_is_round(make_scene):
    """Cells count whole or not at all but along the rim."""
    scene = make_scene(**SIZE)
    factors = cell_map(
        scene.parts.skin,
        parse_press("disc(0.05,0.04,0.03):2", 2.0),
        160,
        200,
    )
    y, x = np.meshgrid(*(np.arange(n) * 5e-4 + 2.5e-4 for n in (160, 200)), indexing="ij")
    distance = np.hypot(x - 0.05, y - 0.04)
    np.testing.assert_allclose(factors[distance < 0.0295], 2, rtol=1e-10)
    np.testing.assert_allclose(factors[distance > 0.0305], 1, rtol=1e-10)


def test_a_rectangle_on_the_lines_of_pixels_needs_no_others(make_scene):
    scene = make_scene(**SIZE)
    rectangle = parse_press("rect(0.03,0.05,0.06,0.02):1.7", 2.0)
    assert lines(scene.parts.skin, rectangle) == ((), ())
    pixels = parse_press("3,1:1.7+3,2:1.7+3,3:1.7", 2.0)
    np.testing.assert_array_equal(
        capacitance_map(scene.parts.skin, rectangle),
        capacitance_map(scene.parts.skin, pixels),
    )


def test_a_map_of_pixels_does_not_hold_other_touches(make_scene):
    scene = make_scene(**SIZE)
    with pytest.raises(InputError, match="all touches must be whole pixels here"):
        capacitance_map(
            scene.parts.skin,
            parse_press("rect(0.03,0.05,0.05,0.02)", 2.0),
        )


@pytest.mark.parametrize("text", ["1,1:2mm", "disc(0.05,0.04,0.01):5N", "poly(0,0,0.01,0,0,0.01)"])
def test_plain_maps_hold_no_depth_force_or_polygon(make_scene, text):
    """None of what needs plain factors takes them for something else."""
    scene, press = make_scene(**SIZE), parse_press(text, 2.0)
    x, y = pixel_lines(scene.parts.skin, 0), pixel_lines(scene.parts.skin, 1)
    for asked in (
        lambda: capacitance_map(scene.parts.skin, press),
        lambda: tile_map(scene.parts.skin, press, x, y),
        lambda: lines(scene.parts.skin, press),
        lambda: touched_box(scene.parts.skin, press.touches[0]),
    ):
        with pytest.raises(InputError, match="must be capacitance factors of pixels or rect"):
            asked()

import numpy as np
import pytest

from simulator.foam import capacitance_map
from simulator.press import parse_press
from simulator.scene import VACUUM_PERMITTIVITY, Foam


def test_rows_run_from_the_bottom_edge_and_columns_from_the_left(make_scene):
    scene = make_scene(rows=2, columns=3, c=1.0)
    c = capacitance_map(scene, parse_press("2,1:3+1,3:0.5", 2.0))
    np.testing.assert_array_equal(c, [[1.0, 1.0, 0.5], [3.0, 1.0, 1.0]])


def test_nothing_pressed_is_the_foam_at_rest(make_scene):
    c = capacitance_map(make_scene(rows=2, columns=2, c=4e-9), parse_press("none", 2.0))
    np.testing.assert_array_equal(c, np.full((2, 2), 4e-9))


def test_capacitance_from_thickness_and_permittivity():
    """2.2 makes 70 pF of 4 mm of foam between 120 x 120 mm."""
    foam = Foam(thickness=4e-3, relative_permittivity=2.2)
    assert foam.rest_capacitance_per_area == 2.2 * VACUUM_PERMITTIVITY / 4e-3
    assert round(foam.rest_capacitance_per_area * 0.120**2 * 1e12) == 70


@pytest.mark.parametrize(
    "given",
    [
        {},
        {"thickness": 4e-3},
        {"relative_permittivity": 2.2},
        {"capacitance_per_area": 5e-9, "thickness": 4e-3},
        {"capacitance_per_area": 5e-9, "thickness": 4e-3, "relative_permittivity": 2.2},
    ],
)
def test_capacitance_is_given_one_way_or_the_other(given):
    with pytest.raises(ValueError, match="either capacitance_per_area, or thickness with"):
        Foam(**given)

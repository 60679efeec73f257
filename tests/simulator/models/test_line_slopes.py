"""The exact line as a function: its values are the line's and the solver's, its slopes exact."""

import numpy as np
import pytest
from rcskin.simulator.models.line import Line, tanh_ratio, tanh_ratio_slope
from rcskin.simulator.models.parameters import parts_with
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.batch import NOTHING
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.sweeps import InputError

FILMS = {"top-left": {"resistance": 200.0}, "bottom-left": {"resistance": 120.0}}
RIGHT = {"top-right": {"resistance": 200.0}, "bottom-right": {"resistance": 120.0}}


def of(scene):
    return Line(scene.parts.skin, scene.parts.setup)


@pytest.fixture(params=[FILMS, RIGHT], ids=["fed left", "fed right"])
def scene(request, make_scene):
    return make_scene(request.param, columns=3, frequencies=(1e3, 1e4, 1e5))


@pytest.fixture
def model(scene):
    return of(scene)


@pytest.mark.parametrize("press", ["none", "1,2:1.8+1,3:2.5"])
def test_values_are_those_of_the_solver(scene, model, press, moved):
    touched = parse_press(press, 2.0)
    Z = model.slopes(model.cells(touched), moved).Z
    same_films = moved | {"sheet_mismatch": 0.0}
    truth = Solver(parts_with(scene.parts, same_films), 1e-6).solve(touched).Z
    np.testing.assert_allclose(model.slopes(model.cells(touched), same_films).Z, truth, rtol=1e-9)
    assert np.abs(Z / truth - 1).max() > 1e-4


def test_the_slope_of_the_ratio_is_smooth_where_its_formula_changes():
    z = 1e-2 * np.array([0.999999, 1.000001]) * np.exp(0.7j)
    below, above = tanh_ratio_slope(z, tanh_ratio(z))
    assert abs(below - above) < 1e-7


def test_a_mismatch_of_equal_sheets_does_nothing_to_first_order(make_scene):
    model = of(make_scene(top=4e4, bottom=4e4))
    slope = model.slopes(model.cells(Press())).by_parameter["sheet_mismatch"]
    assert not slope.any()


def test_sheets_are_no_lines(make_scene):
    with pytest.raises(InputError, match="no line: it has 2 pixels across"):
        of(make_scene(rows=2)).slopes(NOTHING)
    with pytest.raises(InputError, match="not fed in pairs"):
        of(make_scene({"top-left": {}, "bottom-bottom": {}})).slopes(NOTHING)

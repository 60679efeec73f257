"""Studies of what is around a skin: how far a body is, how much a cover or a finger holds."""

import numpy as np
import pytest
from rcskin.localization.study.axis import Axis, find_key, scene_table
from rcskin.localization.study.execution import points_of
from rcskin.localization.study.point import (
    EvaluationSettings,
    _family,
    _without_readings,
    impedances,
)
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.models.solver import Solver

AROUND = {
    "surroundings.body": {"distance": 5e-3},
    "surroundings.cover": {"thickness": 1e-3, "relative_permittivity": 3.0},
    "surroundings.rim": {"mutual": 5e-12, "top": 1e-11, "bottom": 1e-11},
    "press.finger": 5e-12,
    "readout": "IM3523",
}


@pytest.fixture(scope="module")
def touched(make_scene):
    return make_scene(columns=2, frequencies=[1e3, 1e5]).with_(AROUND)


@pytest.mark.parametrize(
    ("key", "unit"),
    [
        ("surroundings.body.distance", "m"),
        ("surroundings.cover.thickness", "m"),
        ("surroundings.rim.top", "F/m"),
        ("press.finger", "F"),
    ],
)
def test_numbers_of_surroundings_are_keys_to_vary(touched, key, unit):
    table = scene_table(touched)
    found = find_key(key, table)
    *_, varied = points_of(
        table, [Axis(found, (1e-3 if unit == "m" else 7e-12,))], EvaluationSettings()
    )
    assert found.unit == unit
    assert varied.scene == touched.with_({key: 1e-3 if unit == "m" else 7e-12})


def test_pixels_are_pressed_by_the_finger_of_the_scene(touched):
    """As the full solver has it, to the tolerance of the reduced model that studies share."""
    nominal, rtol = EvaluationSettings().nominal(touched.parts.skin, touched.parts.plan), 1e-3
    Z = impedances(touched.parts, nominal, _family(_without_readings(touched.parts), rtol), rtol)
    solver = Solver(touched.parts, 1e-5)
    exact = np.stack([solver.solve(press).Z for press in nominal])
    assert relative_difference(Z, exact).max() <= rtol

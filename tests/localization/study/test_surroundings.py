"""Studies of what is around a skin: how far a body is, how much a cover or a finger holds."""

import numpy as np
import pytest
from rcskin.localization.study.axis import Axis, find_key, scene_table
from rcskin.localization.study.execution import points_of
from rcskin.localization.study.point import EvaluationSettings, families, impedances
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
    (skins,) = families([touched.parts], EvaluationSettings(), rtol)
    family = skins.at(touched.parts.skin.top.sheet_resistance)
    Z = impedances(touched.parts, nominal, family, rtol)
    solver = Solver(touched.parts, 1e-5)
    exact = np.stack([solver.solve(press).Z for press in nominal])
    assert relative_difference(Z, exact).max() <= rtol


def test_sheets_that_differ_by_one_factor_are_of_one_trained_family(touched):
    """Foils of fixed resistance, which do not scale with the sheets, are as the full solver has
    them."""
    rtol, top, bottom = 1e-3, "skin.top.sheet_resistance", "skin.bottom.sheet_resistance"
    foils = [each.model_copy(update={"resistance": 40.0}) for each in touched.contacts]
    scene = touched.model_copy(update={"contacts": tuple(foils)})
    own, other = touched.skin.top.sheet_resistance, touched.skin.bottom.sheet_resistance
    scaled = [scene.with_({top: f * own, bottom: f * other}) for f in (0.07, 1.0, 13.0)]
    points = [each.parts for each in [*scaled, scene.with_({bottom: 2 * other})]]
    *same, differs = families(points, EvaluationSettings(), rtol)
    assert same == [same[0]] * 3 != [differs] * 3
    for parts, skins in zip(points[:3], same, strict=True):
        nominal = EvaluationSettings().nominal(parts.skin, parts.plan)
        Z = impedances(parts, nominal, skins.at(parts.skin.top.sheet_resistance), rtol)
        solver = Solver(parts, 1e-5)
        exact = np.stack([solver.solve(press).Z for press in nominal])
        assert relative_difference(Z, exact).max() <= rtol

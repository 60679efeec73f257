"""What surrounds a skin as parameters: which scenes have them, and a scene with other values."""

import math

import pytest
from rcskin.simulator.models.parameters import (
    EFFECTS,
    PARAMETERS,
    all_values,
    own_values,
    parts_with,
)
from rcskin.simulator.scene.scene_files import load_scene, parse_scene, scene_text
from rcskin.simulator.surroundings.rim import rim_densities
from rcskin.simulator.sweeps import InputError

BODY, RIM = {"distance": 5e-3}, {"mutual": 5e-12, "top": 4e-12, "bottom": 3e-12}


@pytest.fixture
def scene():
    return load_scene("sheet-3x3")


def test_a_scene_without_surroundings_has_none_of_them(scene):
    assert tuple(own_values(scene.parts.skin, scene.parts.setup)) == PARAMETERS


@pytest.mark.parametrize(
    ("surroundings", "there"),
    [
        ({}, ("finger",)),
        ({"body": BODY}, ("body", "finger")),
        ({"body": BODY, "rim": RIM}, EFFECTS),
        ({"body": BODY | {"side": "top"}}, ("body",)),
        ({"body": BODY, "solved": True}, ("finger",)),
    ],
)
def test_a_scene_has_those_of_what_is_around_it(scene, surroundings, there):
    around = scene.with_({"surroundings": surroundings})
    assert tuple(own_values(around.parts.skin, around.parts.setup)) == (*PARAMETERS, *there)


@pytest.mark.parametrize("name", EFFECTS)
def test_what_a_scene_has_not_is_refused(scene, name):
    with pytest.raises(InputError, match=f"{name} changes nothing here; it needs"):
        all_values(scene.parts.skin, scene.parts.setup, {name: 0.1})


def test_the_scene_with_other_values_has_so_much_more_around_it(scene):
    around = scene.with_(
        {
            "surroundings": {"body": BODY, "rim": RIM},
            "press.finger": 2e-12,
            "press.factor_spread": 0,
        }
    )
    twice = math.log(2)
    found = parts_with(around.parts, {"body": twice, "rim": twice, "finger": 1e-12}).scene
    assert parse_scene(scene_text(found), "found") == found
    assert found.surroundings.body[0].distance == pytest.approx(BODY["distance"] / 2)
    assert found.surroundings.rim.bottom == pytest.approx(2 * RIM["bottom"])
    assert found.press.finger == pytest.approx(3e-12)
    by_area = around.with_({"surroundings": {"body": {"capacitance_per_area": 1e-9}}})
    other = parts_with(by_area.parts, {"body": twice}).skin.around
    assert other.body[0].capacitance_per_area == pytest.approx(2e-9)


def test_a_rim_that_is_computed_stays_what_it_was_beside_a_body_that_is_nearer(scene):
    """As models have it: of the parts of M each takes its own factor."""
    around = scene.with_({"surroundings": {"rim": True, "body": BODY}})
    own = rim_densities(around.parts.skin)
    for given, factor in (({"body": 0.4}, 1.0), ({"body": 0.4, "rim": math.log(2)}, 2.0)):
        found = parts_with(around.parts, given).skin.around.rim
        assert found.mutual == pytest.approx(factor * own.mutual)
        assert found.top == pytest.approx(factor * own.top)
    assert rim_densities(parts_with(around.parts, {}).scene.with_({}).parts.skin) == own


@pytest.mark.parametrize("factor", [2.0, 0.1])
def test_foam_keeps_its_thickness_where_the_field_around_it_counts(scene, factor):
    """With less capacitance than vacuum the foam would be thicker."""
    given = {"skin.foam": {"thickness": 4e-3, "relative_permittivity": 2.0}}
    around = scene.with_(given | {"surroundings": {"thickness": True}})
    changed = {"capacitance": math.log(factor)}
    foam, plain = (
        parts_with(each.parts, changed).skin.foam for each in (around, scene.with_(given))
    )
    assert plain.thickness is None
    assert foam.thickness == pytest.approx(4e-3 * max(1.0, 1 / (2 * factor)))
    assert foam.unpressed_capacitance_per_area == plain.unpressed_capacitance_per_area

"""Where the foam is too thick for the thin-sheet model, it is said."""

import numpy as np
import pytest
from rcskin.simulator.models.validity import (
    earth_left_out,
    rim_per_length,
    rim_share,
    straight_share,
    warnings,
)
from rcskin.simulator.press.walls import step_capacitance
from rcskin.simulator.scene.extent import perimeter, surface
from rcskin.simulator.scene.foam import VACUUM_PERMITTIVITY
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import builtin_names, load_scene

OUTLINE = {
    "skin.outline": {"circle": [0.06, 0.06, 0.05], "holes": [{"circle": [0.06, 0.06, 0.02]}]},
    "contact.1.edge": "outline",
    "contact.2.edge": "outline",
}


def with_foam(make_scene, **foam):
    """A scene whose foam is given by its geometry."""
    scene = make_scene(**foam.pop("scene", {})).model_dump(by_alias=True)
    scene["skin"]["foam"] = foam
    return Scene.model_validate(scene)


@pytest.mark.parametrize("name", builtin_names())
def test_the_papers_devices_are_within_the_model(name):
    scene = load_scene(name)
    assert warnings(scene.parts.skin, scene.parts.setup, scene.press) == []


def test_the_lateral_error_is_the_first_term_of_laplaces_equation():
    """Potentials that vary along the sheets charge them (k d / 2) coth(k d / 2) times as much."""
    d, depth = 1e-3, 20e-3
    half = np.sqrt(2j) / depth * d / 2
    assert straight_share(d, depth) == pytest.approx(abs(half / np.tanh(half) - 1), rel=1e-3)


@pytest.mark.parametrize(
    ("scene", "message"),
    [
        ({"frequencies": [1e3, 1e7]}, "currents along the foam change Rs and Cp"),
        ({"length": 0.02}, "fields around the edges add"),
        ({"columns": 20}, "pixels of 5 mm are less than 2 times"),
    ],
)
def test_each_limit_is_reported(make_scene, scene, message):
    scene = with_foam(make_scene, thickness=4e-3, relative_permittivity=2.2, scene=scene)
    (warning,) = warnings(scene.parts.skin, scene.parts.setup, scene.press)
    assert message in warning


def test_a_capacitance_alone_is_of_a_foam_of_assumed_permittivity(make_scene):
    """3.5 mm at 5 nF/m² and a relative permittivity of 2."""
    made = make_scene(frequencies=[1e5])
    assert (
        warnings(
            made.parts.skin,
            made.parts.setup,
            made.press,
        )
        == []
    )
    scene = make_scene(frequencies=[1e7])
    (warning,) = warnings(
        scene.parts.skin,
        scene.parts.setup,
        scene.press,
    )
    assert "the foam, 3.5 mm (relative permittivity 2 assumed)" in warning


@pytest.mark.parametrize(("permittivity", "warned"), [(1.0, True), (2.2, False)])
def test_the_fringe_weighs_more_the_less_the_foam_holds(make_scene, permittivity, warned):
    """The field around the edges hardly depends on what is between the sheets."""
    size = {"length": 0.12, "width": 0.12}
    foam = {"thickness": 4e-3, "relative_permittivity": permittivity}
    scene = with_foam(make_scene, scene=size, **foam)
    assert (
        (rim_share(scene.parts.skin) > 0.1)
        == warned
        == bool(warnings(scene.parts.skin, scene.parts.setup, scene.press))
    )
    stated = scene.with_({"surroundings": {"rim": True}})
    assert warnings(stated.parts.skin, stated.parts.setup, stated.press) == []


@pytest.mark.parametrize("key", ["rim", "thickness", "solved"])
def test_an_assumed_thickness_is_reported_where_it_counts(key):
    scene = load_scene("sheet-5x5").with_({f"surroundings.{key}": True})
    (warning,) = warnings(scene.parts.skin, scene.parts.setup, scene.press)
    assert (
        f"`surroundings.{key}` assumes that the foam is 3.6 mm (relative permittivity 2 " in warning
    )
    made = scene.with_({"skin.foam.thickness": 4e-3})
    assert (
        warnings(
            made.parts.skin,
            made.parts.setup,
            made.press,
        )
        == []
    )


@pytest.mark.parametrize(
    ("changes", "warned"),
    [
        ({}, True),
        ({"surroundings": {"low": "floating"}}, False),
        ({"surroundings": "solved"}, False),
        ({"surroundings.body.distance": 5e-3}, False),
    ],
)
def test_earth_is_warned_of_where_nothing_is_said_of_it(changes, warned):
    message = earth_left_out(load_scene("sheet-5x5").with_(changes).parts.skin)
    assert (message is not None) == warned
    if message is not None:
        assert "`rcskin describe` states by how much" in message


@pytest.mark.parametrize(
    ("sides", "thickness", "solved", "within"),
    [((0.12, 0.12), 4e-3, 0.918, 0.01), ((0.1, 0.02), 4e-3, 0.751, 0.05)],
)
def test_the_rim_is_that_of_a_solve_in_three_dimensions(sides, thickness, solved, within):
    gamma = rim_per_length(*sides, thickness) / VACUUM_PERMITTIVITY
    assert gamma == pytest.approx(solved, rel=within)


def test_the_rim_of_wide_plates_is_kirchhoffs():
    """d/(2 pi) (1 + ln 2 pi w/d) beyond the edge of a plate whose other side is far."""
    width, d = 1.0, 1e-5
    gamma = rim_per_length(1e6, width, d) / VACUUM_PERMITTIVITY
    assert gamma == pytest.approx((1 + np.log(2 * np.pi * width / d)) / (2 * np.pi), rel=1e-6)


def test_the_share_of_the_rim_is_that_of_the_paper_sheet():
    scene = load_scene("sheet-5x5").with_({"skin.foam.thickness": 4e-3})
    assert rim_share(scene.parts.skin) == pytest.approx(0.056, abs=5e-4)
    gamma = rim_per_length(0.12, 0.12, 4e-3)
    assert rim_share(scene.parts.skin) == pytest.approx(2 * gamma / 4.861e-9 * (2 / 0.12))


def test_the_walls_of_a_press_are_those_of_a_solve_in_three_dimensions():
    """A step from 4 to 2 mm has 0.2498 eps a metre: over 24 x 24 mm, 17 % of the rise."""
    assert step_capacitance(0.5) == pytest.approx(0.2498, abs=1e-4)


def test_a_hole_has_a_rim_too():
    skin = load_scene("sheet-3x3").with_(OUTLINE).skin
    assert perimeter(skin) == pytest.approx(2 * np.pi * 0.07)
    assert surface(skin) == pytest.approx(np.pi * (0.05**2 - 0.02**2))

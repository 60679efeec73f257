"""What is evened into a plain skin, where presses go, and what stays as it is."""

import pytest
from rcskin.simulator.models.mechanics.force_depths import pressed_by_factors
from rcskin.simulator.models.uniform import equivalent_press
from rcskin.simulator.press.press import Press, check_press, parse_press
from rcskin.simulator.press.touch import Rectangle, Touch
from rcskin.simulator.scene.foam import VACUUM_PERMITTIVITY
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import builtin_names, load_scene, parse_scene, scene_text
from rcskin.simulator.scene.supports import require
from rcskin.simulator.sweeps import InputError

STRETCH = {"x": 1.2, "y": 0.8, "foam_poisson_ratio": 0.25}
MUG, SPHERE = {"kind": "cylinder", "radius": 0.04}, {"kind": "sphere", "radius": 0.04}
GRADIENT = {"kind": "gradient", "x": 0.2}


def skin_with(scene, **tables):
    """The scene with further tables in its skin; those of top, bottom, foam are added to."""
    given = scene.model_dump(by_alias=True, exclude_none=True)
    for name, table in tables.items():
        given["skin"][name] = {**given["skin"].get(name, {}), **table}
    return Scene.model_validate(given)


NOT_PLAIN = {"l-shape", "mug", "stretched"}


@pytest.mark.parametrize("name", sorted({*builtin_names()} - NOT_PLAIN))
def test_a_plain_scene_is_returned_as_it_is(name):
    scene = load_scene(name)
    press = Press((Touch(1, 1, 2.0),))
    assert scene.parts.skin.uniform
    skin = scene.parts.skin
    assert skin.electrical is skin
    assert equivalent_press(skin, press) is press
    require("a uniform model", skin)


def test_a_stretch_gives_derived_values(make_scene):
    """J = 0.96; rubber of constant volume R J, foam J^(1/3) = J^(0.25 / 0.75)."""
    scene = skin_with(make_scene(rows=2, columns=3), stretch=STRETCH)
    folded = scene.parts.skin.electrical
    assert not scene.parts.skin.uniform
    assert folded.uniform
    assert folded.sides == pytest.approx((0.12, 0.064))
    assert folded.top.sheet_resistance == pytest.approx(0.96 * 50e3)
    assert folded.bottom.sheet_resistance == pytest.approx(0.96 * 30e3)
    assert folded.foam.unpressed_capacitance_per_area == pytest.approx(5e-9 * 0.96 ** (1 / 3))
    assert folded.contacts == scene.contacts
    assert folded.pixels == scene.pixels
    assert folded.electrical is folded


def test_foam_of_known_thickness_thins_under_stretch(make_scene):
    foam = {"thickness": 4e-3, "relative_permittivity": 2.2}
    scene = skin_with(make_scene(), stretch=STRETCH)
    tables = scene.model_dump(by_alias=True, exclude_none=True)
    tables["skin"]["foam"] = foam
    folded = Scene.model_validate(tables).parts.skin.electrical.foam
    assert folded.thickness == pytest.approx(4e-3 * 0.96 ** (-1 / 3))
    expected = VACUUM_PERMITTIVITY * 2.2 / folded.thickness
    assert folded.unpressed_capacitance_per_area == pytest.approx(expected)


def test_even_maps_and_directions_of_no_preference_are_folded(make_scene):
    scene = skin_with(
        make_scene(),
        top={"map": {"kind": "constant", "value": 2.0}, "anisotropy": {"ratio": 1.0}},
        foam={"map": {"kind": "grid", "values": [[0.5, 0.5]]}},
        shape=MUG,
    )
    folded = scene.parts.skin.electrical
    assert folded.uniform
    assert folded.shape is None
    assert folded.top.sheet_resistance == 100e3
    assert folded.foam.unpressed_capacitance_per_area == 2.5e-9


@pytest.mark.parametrize(
    ("key", "tables"),
    [
        ("skin.top.map", {"top": {"map": GRADIENT}}),
        ("skin.foam.map", {"foam": {"map": GRADIENT}}),
        ("skin.bottom.anisotropy", {"bottom": {"anisotropy": {"ratio": 2.0}}}),
        ("skin.top.piezoresistance", {"top": {"piezoresistance": 1.0}}),
        ("skin.shape", {"shape": SPHERE}),
    ],
)
def test_what_is_not_plain_keeps_its_stretch_and_is_refused_by_its_key(make_scene, key, tables):
    scene = skin_with(make_scene(), stretch=STRETCH, **tables)
    left = scene.parts.skin.electrical
    assert left == scene.parts.skin
    assert not left.uniform
    assert equivalent_press(scene.parts.skin, Press((Touch(1, 1, 2.0),))) is None
    unstretched = skin_with(make_scene(), **tables)
    with pytest.raises(InputError, match=f"scene: a uniform model cannot take `{key}`: it"):
        require("a uniform model", unstretched.parts.skin)


def test_a_mug_around_what_is_not_plain_is_folded_all_the_same(make_scene):
    scene = skin_with(make_scene(), shape=MUG, top={"map": GRADIENT})
    flat = skin_with(make_scene(), top={"map": GRADIENT})
    assert scene.parts.skin.electrical == flat.parts.skin


def test_a_stretched_scene_needs_to_be_folded_first(make_scene):
    scene = skin_with(make_scene(), stretch=STRETCH)
    with pytest.raises(InputError, match="cannot take `skin.stretch`"):
        require("a uniform model", scene.parts.skin)
    assert pressed_by_factors(scene.parts).skin == scene.parts.skin.electrical


def test_presses_move_with_the_skin(make_scene):
    scene = skin_with(make_scene(rows=2, columns=2), stretch=STRETCH)
    press = Press((Touch(1, 2, 3.0), Rectangle(0.05, 0.04, 0.1, 0.02, 2.0)))
    moved = equivalent_press(scene.parts.skin, press)
    assert moved is not None
    pixel, rectangle = moved.touches
    assert pixel == Touch(1, 2, 3.0)
    assert rectangle == Rectangle(0.06, 0.032, pytest.approx(0.12), 0.016, 2.0)
    assert check_press(moved, scene.parts.skin.electrical) == moved


@pytest.mark.parametrize(
    "text", ["1,1:2mm", "disc(0.05,0.04,0.01):2", "poly(0.01,0.01,0.02,0.01,0.02,0.02):2"]
)
def test_presses_beyond_the_plain_ones_have_no_plain_scene(make_scene, text):
    assert equivalent_press(make_scene().parts.skin, parse_press(text, 2.0)) is None


def test_scenes_survive_being_written(make_scene):
    random = {"kind": "random", "deviation": 0.2, "correlation_length": 0.01, "seed": 3}
    scene = skin_with(
        make_scene(),
        stretch=STRETCH,
        shape=SPHERE,
        top={"map": random, "anisotropy": {"ratio": 2.0, "angle": 0.1}, "piezoresistance": 0.5},
        bottom={"map": {"kind": "grid", "values": [[0.1, 1 / 3], [1.0, 2.0]]}},
    )
    assert parse_scene(scene_text(scene), "kept") == scene
    folded = skin_with(make_scene(), stretch=STRETCH).parts.evened.scene
    assert parse_scene(scene_text(folded), "kept") == folded

"""Keys of readers of gains: what they refuse, and that a scene keeps them."""

import pytest
from rcskin.simulator.scene.scene_files import load_scene, parse_scene, scene_text
from rcskin.tests.refusals import refusal_of

GAIN = {
    "interface.1.reader": "gain",
    "interface.1.series_resistance": 1e6,
    "interface.2.reader": "gain",
    "interface.2.series_resistance": 2e6,
}
TOGETHER = GAIN | {"interface.1.driven_with": ["bottom"], "interface.2.driven_with": ["left"]}
SCENE = load_scene("sheet-5x5-two-interfaces")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"interface.1.reader": "gain"},
            'with reader = "gain" needs series_resistance, in ohm: the resistor between',
        ),
        (
            {"interface.1.series_resistance": 1e6},
            'takes series_resistance with reader = "gain" only',
        ),
        ({"interface.1.driven_with": ["bottom"]}, 'takes driven_with with reader = "gain" only'),
        (
            {"interface.1.reader": "gain", "interface.1.series_resistance": 1e6},
            "all interfaces must have the same `reader`, got 'gain' of 'left' and 'impedance' of",
        ),
        (
            GAIN | {"interface.1.magnitude_only": True},
            "all interfaces must have the same `magnitude_only`, got true of 'left' and false of",
        ),
        (
            GAIN | {"interface.1.driven_with": ["right"]},
            "interface 'left': `driven_with` must be one of bottom, got 'right'",
        ),
        (
            GAIN | {"interface.1.driven_with": ["left"]},
            "interface 'left': `driven_with` must be one of bottom, got 'left'",
        ),
        (
            GAIN | {"interface.1.driven_with": [{"high": ["far"], "series_resistance": 1e6}]},
            "interface 'left': `driven_with` names the contact 'far'; there are top-left",
        ),
        (
            GAIN | {"interface.1.driven_with": [{"high": ["bottom-left"]}]},
            "`interface[1].driven_with` `series_resistance` is missing",
        ),
        (
            GAIN
            | {
                "interface.1.driven_with": [{"high": ["bottom-left"], "series_resistance": 1e6}],
            },
            "interface 'left': a node of `driven_with` is low at another one",
        ),
        (
            GAIN | {"interface.1.driven_with": [{"high": ["top-left"], "series_resistance": 1e6}]},
            "interface 'left': two nodes of `driven_with` are one terminal",
        ),
    ],
)
def test_what_does_not_fit_is_refused(changes, message):
    assert message in refusal_of(SCENE.with_, changes)


def test_a_scene_of_impedances_does_not_write_the_keys():
    assert "reader" not in scene_text(SCENE)
    assert "driven_with" not in scene_text(SCENE)


def test_a_scene_of_gains_keeps_its_keys():
    scene = SCENE.with_(TOGETHER | {"interface.1.load": {"capacitance": 8e-12}})
    again = parse_scene(scene_text(scene), "again")
    assert again == scene
    assert again.interfaces[0].driven_with == ("bottom",)


def test_one_interface_of_a_scene_keeps_the_sources_of_the_others():
    scene = SCENE.with_(TOGETHER)
    some = scene.parts.setup.of(["left"])
    (other,) = some.interfaces[0].driven_with
    assert (other.high, other.series_resistance) == (scene.interfaces[1].high, 2e6)
    alone = scene.parts.read(some).scene
    assert parse_scene(scene_text(alone), "some") == alone
    assert scene.parts.setup.of(["bottom", "left"]).interfaces[1] == scene.interfaces[0]

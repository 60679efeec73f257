"""What a scene says of its surroundings, and what it is refused."""

import numpy as np
import pytest
from rcskin.simulator.measure.symmetry import representative
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press, press_on
from rcskin.simulator.scene.foam import VACUUM_PERMITTIVITY
from rcskin.simulator.scene.scene_files import builtin_names, load_scene, parse_scene, scene_text
from rcskin.simulator.scene.surroundings import Rim
from rcskin.simulator.sweeps import InputError, read
from rcskin.tests.refusals import refusal_of

COVER = {"thickness": 1e-3, "relative_permittivity": 3.0}
BELOW = {"distance": 5e-3}
ABOVE = {"side": "top", "distance": 5e-3}


def around(**changes):
    return load_scene("sheet-5x5").with_({f"surroundings.{k}": v for k, v in changes.items()})


@pytest.mark.parametrize("name", builtin_names())
def test_a_scene_that_says_nothing_is_written_as_ever(name):
    text = scene_text(load_scene(name))
    contacts = text[text.index("[[contact]]") : text.index("[[interface]]")]
    assert "surroundings" not in text
    assert "finger" not in text
    assert "width" not in contacts


@pytest.mark.parametrize(
    "changes",
    [
        {"surroundings": {}},
        {"surroundings": "solved"},
        {"surroundings": {"low": "floating", "rim": True, "thickness": True}},
        {"surroundings": {"rim": 5e-12, "air": 1e-3}},
        {"surroundings": {"rim": {"mutual": 5e-12, "top": 1e-11}}},
        {"surroundings": {"body": {"distance": 5e-3, "potential": "floating"}}},
        {"surroundings": {"body": [ABOVE, {"capacitance_per_area": 1e-9, "potential": "low"}]}},
        {"surroundings": {"cover": COVER}, "press.finger": "floating"},
        {"surroundings": {"cover": {"side": "bottom", **COVER}, "body": ABOVE}},
        {"contact.top-left.width": 1e-3},
    ],
)
def test_surroundings_are_read_back_as_they_were_written(changes):
    scene = load_scene("sheet-5x5").with_(changes)
    assert parse_scene(scene_text(scene), "again") == scene


def test_the_short_form_is_an_lcr_meter_and_a_solve():
    around = load_scene("sheet-5x5").with_({"surroundings": "solved"}).surroundings
    assert (around.low, around.solved, around.rim, around.body) == (
        "virtual earth",
        True,
        False,
        (),
    )


def test_a_number_for_the_rim_is_that_between_the_sheets():
    assert around(rim=5e-12).surroundings.rim == Rim(mutual=5e-12)


def test_a_key_of_one_body_is_changed_by_its_name():
    scene = around(body=BELOW).with_({"surroundings.body.distance": 7e-3})
    (body,) = scene.surroundings.body
    assert body.per_area == VACUUM_PERMITTIVITY / 7e-3
    two = around(body=[BELOW, ABOVE]).with_({"surroundings.body.2.distance": 1e-3})
    assert [each.distance for each in two.surroundings.body] == [5e-3, 1e-3]


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({"surroundings": "solve"}, "`surroundings` must be a table or 'solved', got 'solve'"),
        ({"surroundings.rim": "yes"}, "`surroundings.rim` must be true, false, a number in F/m"),
        ({"surroundings": {"rim": True, "solved": True}}, "takes solved or rim, got both"),
        ({"surroundings.body": {}}, "`surroundings.body[1]` needs either distance or capacitance"),
        (
            {"surroundings.body": {**BELOW, "capacitance_per_area": 1e-9}},
            "`surroundings.body[1]` needs either distance or capacitance_per_area",
        ),
        (
            {"surroundings.body": {"capacitance_per_area": 1e-9, "relative_permittivity": 2.0}},
            "takes relative_permittivity with distance only",
        ),
        (
            {"surroundings.body": [BELOW, BELOW]},
            "takes one body on each side, got two on the bottom",
        ),
        ({"surroundings.body": [BELOW, ABOVE, ABOVE]}, "at most 2 items, got 3"),
        ({"surroundings": {"cover": COVER, "body": ABOVE}}, "cannot touch the top sheet"),
        ({"press.finger": "earthed"}, "`press.finger` needs the table [surroundings]"),
        (
            {"surroundings": {}, "press.finger": "earthed"},
            "`press.finger` = 'earthed' needs surroundings.cover or surroundings.air",
        ),
        (
            {"surroundings": {"body": ABOVE}, "press.finger": 5e-12},
            "`press.finger` cannot touch the top sheet",
        ),
        ({"surroundings": {}, "press.finger": "hand"}, "must be 'earthed' or 'floating' or a cap"),
        ({"surroundings": {}, "press.finger": True}, "must be 'earthed' or 'floating' or a cap"),
        (
            {"contact.top-left.width": 0.12},
            "`contact[1].width` must be < 0.12 m, the skin's extent",
        ),
        (
            {"contact.top-left.width": 1e-3, "contact.top-left.resistance": 1.0},
            "`contact[1]` takes width or resistance, got both",
        ),
    ],
)
def test_impossible_surroundings_are_refused_in_one_line(changes, why):
    assert why in refusal_of(load_scene("sheet-5x5").with_, changes)


@pytest.mark.parametrize(
    ("contacts", "overlap"),
    [
        ({"top-left": {"width": 0.06}, "top-right": {"width": 0.03}}, False),
        ({"top-left": {"width": 0.06}, "top-right": {"width": 0.04}}, True),
        ({"top-left": {"width": 0.06}, "bottom-right": {"width": 0.06}}, False),
        ({"top-left": {"width": 0.02}, "top-bottom": {"width": 0.02}}, False),
        ({"top-left": {"span": [0.1, 1.0], "width": 0.02}, "top-bottom": {"width": 0.02}}, True),
        ({"top-left": {"span": [0.5, 1.0], "width": 0.02}, "top-bottom": {"width": 0.02}}, False),
        ({"top-left": {"width": 0.02}, "top-bottom": {"span": [0.3, 1.0]}}, False),
        ({"top-left": {"width": 0.04}, "top-bottom": {"span": [0.3, 1.0]}}, True),
    ],
)
def test_wide_foils_of_one_sheet_do_not_overlap_unless_they_are_one(make_scene, contacts, overlap):
    """On 100 x 80 mm; those that meet at a corner are one terminal."""
    every = {**contacts, "bottom-bottom": {}}
    connected = {"meter": (next(iter(contacts)), "bottom-bottom")}
    if overlap:
        with pytest.raises(ValueError, match="overlap by `contact.width`"):
            make_scene(every, connected)
    else:
        assert make_scene(every, connected).parts.skin.beyond_sheets


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"surroundings.thickness": True}, "surroundings"),
        ({"contact.top-left.width": 1e-3}, "contact[1].width"),
    ],
)
def test_uses_that_need_two_bare_sheets_refuse_others(changes, key):
    scene = load_scene("sheet-3x3").with_(changes)
    assert scene.parts.skin.beyond_sheets == [key]
    for model in ("line", "lumped"):
        with pytest.raises(InputError, match="cannot take `" + key.replace("[", r"\[")):
            Solver(scene.parts, 1e-2, model).solve(Press())


@pytest.mark.parametrize(
    ("changes", "exchanged"),
    [
        ({}, True),
        ({"surroundings": {}}, True),
        ({"surroundings": {"body": [BELOW, ABOVE]}}, True),
        ({"surroundings": {"body": BELOW}}, False),
        ({"surroundings": {"rim": {"top": 1e-12}}}, False),
        ({"surroundings": {}, "press.finger": 5e-12}, False),
        (
            {
                "surroundings": {
                    "body": [{**BELOW, "potential": "low"}, {**ABOVE, "potential": "low"}]
                }
            },
            False,
        ),
    ],
)
def test_crossed_sheets_are_equal_if_their_surroundings_are(changes, exchanged):
    """Pixels (1, 2) and (2, 1) of two equal sheets, one fed at the left, one at the bottom edge."""
    scene = load_scene("sheet-5x5-crossed").with_(changes)
    of = representative(
        scene.parts.skin,
        scene.parts.setup,
        scene.press,
    )
    assert (of((2, 1)) == (1, 2)) == exchanged


def test_earth_alone_changes_nothing_until_a_finger_touches():
    """The first is to the last bit; by another solver, a finger of almost nothing is none."""
    scene = load_scene("sheet-3x3")
    earthed = scene.with_({"surroundings": {}})
    rod, finger = (
        press_on(earthed.parts.skin, earthed.press, f"2,3:2:{by}") for by in ("rod", "1e-20pF")
    )
    expected = Solver(scene.parts, 1e-4).solve(rod).Z
    np.testing.assert_array_equal(Solver(earthed.parts, 1e-4).solve(rod).Z, expected)
    np.testing.assert_allclose(Solver(earthed.parts, 1e-4).solve(finger).Z, expected, rtol=2e-4)


def test_the_press_of_a_scene_includes_its_finger(run, tmp_path):
    path = tmp_path / "touched.toml"
    path.write_text(scene_text(around(cover=COVER).with_({"sweep.frequencies": [1e4]})))
    asked = ("--press", "2,3:touch", "--press", "2,3:2:5.3pF", "-o", tmp_path / "out.nc")
    code, out, err = run("sweep", path, *asked)
    assert (code, err) == (0, "")
    assert list(read(tmp_path / "out.nc")["press"].values) == [
        f"2,3:1.0:{finger_of_a_pixel()!r}F",
        "2,3:2.0:5.3e-12F",
    ]


def finger_of_a_pixel():
    return VACUUM_PERMITTIVITY / (1e-3 / 3.0) * (0.024 * 0.024)

"""Scenes of one conductor over earth: what the file says, and what is refused."""

import numpy as np
import pytest
from rcskin.simulator.dataset.drawn_presses import drawn_presses
from rcskin.simulator.press.press import Press, label_of, press_on
from rcskin.simulator.scene.scene_files import parse_scene, scene_text
from rcskin.simulator.sweeps import InputError

YARN = """
name = "yarn"
skin = {length = 0.72, width = 1e-3, bottom = "earth", top.sheet_resistance = 694.0, foam.capacitance_per_area = 2.8e-8}
contact = [{name = "left", edge = "left"}, {name = "right", edge = "right"}]
interface = [{name = "left", high = ["left"], low = "earth"}]
pixels = {rows = 1, columns = 36}
press = {adds = "capacitance to earth", capacitance = 30e-12}
sweep.frequencies = [2e3, 1e4]
"""  # noqa: E501
BOTTOM, LOW = 'bottom = "earth"', 'low = "earth"'
CONTACT, PRESS = '{name = "left", edge = "left"}', "capacitance = 30e-12"


@pytest.fixture(scope="module")
def yarn():
    return parse_scene(YARN, "yarn")


def test_the_file_names_no_contacts_of_earth(yarn):
    text = scene_text(yarn)
    assert BOTTOM in text and LOW in text and "below" not in text
    assert parse_scene(text, "again") == yarn
    assert [foil.name for foil in yarn.parts.skin.foils] == ["left", "right"]


def test_a_touch_of_a_pixel_is_a_factor_and_its_text_a_capacitance(yarn):
    own = 2.8e-8 * 0.72 * 1e-3 / 36
    assert yarn.press.capacitance_factor == pytest.approx(1 + 30e-12 / own, rel=1e-12)
    press = press_on(yarn.parts.skin, yarn.press, "1,3+1,7:21.5pF")
    assert label_of(press, yarn.parts.skin, yarn.press) == "1,3:30.0pF+1,7:21.5pF"
    assert (
        press_on(yarn.parts.skin, yarn.press, label_of(press, yarn.parts.skin, yarn.press)) == press
    )
    assert press.adds and press != Press(press.touches)
    assert (
        press_on(yarn.parts.skin, yarn.press, "1,3")
        == Press(press.touches[:1])
        == press.of(press.touches[:1])
    )
    halved = yarn.with_({"pixels.columns": 18})
    assert halved.press.capacitance_factor == pytest.approx(1 + 15e-12 / own, rel=1e-12)


def test_data_sets_draw_the_capacitance_of_touches(yarn):
    drawn = yarn.with_({"dataset.press.capacitance": {"low": 20e-12, "high": 40e-12}})
    presses = drawn_presses(drawn.parts, np.random.default_rng(1), 200, (1, 36))
    added = [float(t.split(":")[1].removesuffix("pF")) for t in presses.text if t.count(":") == 1]
    assert 20 <= min(added) < 22 and 38 < max(added) <= 40
    for text, touches, factor in zip(presses.text, presses.touches, presses.factor, strict=True):
        solved = [touch.factor for touch in press_on(drawn.parts.skin, drawn.press, text).touches]
        assert sorted(solved) == pytest.approx(sorted(factor[:touches]), rel=1e-12)


@pytest.mark.parametrize(
    ("there", "instead", "message"),
    [
        (BOTTOM, 'bottom = "metal"', "`skin.bottom` must be a table or 'earth', got 'metal'"),
        (
            BOTTOM,
            "bottom.sheet_resistance = 694.0",
            "`interface[1].low` = 'earth' needs `skin.bottom = \"earth\"`, a skin of one conductor",
        ),
        (
            LOW,
            'low = ["right"]',
            "`interface[1].low` must be \"earth\" in a skin of one conductor, got ['right']",
        ),
        (
            CONTACT,
            '{name = "left", edge = "left", electrode = "bottom"}',
            '`contact[1].electrode` must be "top": the bottom sheet is earth',
        ),
        (
            "pixels =",
            'surroundings.low = "floating"\npixels =',
            "`surroundings` describes skins of two sheets: leave it out with "
            '`skin.bottom = "earth"`',
        ),
        (
            PRESS,
            "capacitance_factor = 2.0",
            '`press` takes adds = "capacitance to earth" and capacitance in F together',
        ),
        (
            PRESS,
            f"{PRESS}, capacitance_factor = 2.0",
            "`press` takes one of capacitance_factor, depth, force, capacitance, got "
            "capacitance_factor and capacitance",
        ),
        (PRESS, f'{PRESS}, finger = "earthed"', "`press` takes adds or finger, got both"),
        (
            "foam.capacitance_per_area = 2.8e-8",
            "foam.capacitance_per_area = 1e-12",
            "`press.capacitance` must be <= 2e-11 F, 1e+06 times the capacitance of an untouched "
            "pixel, got 3e-11",
        ),
        (
            "foam.capacitance_per_area = 2.8e-8",
            'foam = {capacitance_per_area = 2.8e-8, map = {kind = "gradient", x = 0.5}}',
            "`press.adds` needs a uniform rectangle, without `skin.foam.map`",
        ),
        (
            "sweep.f",
            'dataset.press.place = "anywhere"\nsweep.f',
            '`dataset.press.place` must be "pixel" with `press.adds`',
        ),
        (
            "sweep.f",
            "dataset.press.offset = 0.1\nsweep.f",
            "`dataset.press.offset` with `press.adds` needs `dataset.press.touches` of one touch",
        ),
        (
            "sweep.f",
            'dataset.press.capacitance = {distribution = "lognormal", median = 3e-11, '
            "spread = 0.2}\nsweep.f",
            "`dataset.press.capacitance` must be fixed, uniform or normal",
        ),
    ],
)
def test_refusals(there, instead, message):
    assert there in YARN
    with pytest.raises(InputError) as refusal:
        parse_scene(YARN.replace(there, instead, 1), "yarn.toml")
    assert str(refusal.value).startswith(f"yarn.toml: {message}"), refusal.value


def test_touches_of_two_sheets_and_mixed_strengths_are_refused(yarn, make_scene):
    with pytest.raises(InputError, match=r"`press.adds` needs `skin.bottom = \"earth\"`"):
        make_scene().with_({"press": {"adds": "capacitance to earth", "capacitance": 3e-11}})
    with pytest.raises(InputError, match=r"`dataset.press.capacitance` needs `press.adds`"):
        make_scene().with_({"dataset.press.capacitance": 3e-11})
    with pytest.raises(InputError, match=r"1,3 takes one such as :30pF, or a factor, got both"):
        press_on(yarn.parts.skin, yarn.press, "1,3:2.0:30pF")


def test_describe_names_the_conductor_and_no_contacts_of_earth(run):
    code, out, _ = run("describe", "knit-36")
    assert code == 0 and "below" not in out and "bottom" not in out
    assert "left: left against earth" in out
    assert "adds 30 pF to earth: 54.9996 times" in out

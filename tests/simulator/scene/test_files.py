import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.press.press import every_press
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import (
    BUILTIN,
    builtin_names,
    load_scene,
    parse_scene,
    read_scene,
    scene_text,
)
from rcskin.simulator.sweeps import InputError
from rcskin.tests.refusals import refusal_of

SHEET = (BUILTIN / "sheet-3x3.toml").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", builtin_names())
def test_built_in_scenes_load_under_their_own_names(name):
    assert load_scene(name).name == name
    assert load_scene(name) == load_scene(BUILTIN / f"{name}.toml")


def test_the_six_devices_of_the_paper_are_built_in():
    devices = {"strip-1x3", "strip-1x4", "strip-1x5", "sheet-3x3", "sheet-4x4", "sheet-5x5"}
    assert devices <= set(builtin_names())


@pytest.mark.parametrize("name", builtin_names())
def test_built_in_scenes_are_written_and_read_back(name):
    scene = load_scene(name)
    assert parse_scene(scene_text(scene), source="text") == scene


@given(data=st.data())
def test_any_scene_is_written_and_read_back(random, data):
    scene = data.draw(random.between())
    assert parse_scene(scene_text(scene), source="text") == scene


def test_defaults(make_scene):
    scene = make_scene()
    assert scene.press.factor_spread == 0
    assert scene.readout.display_digits == 6
    assert scene.contacts[0].span == (0, 1)
    assert scene.contacts[0].resistance == 0


def test_presses_are_the_unpressed_skin_and_each_pixel_row_by_row():
    scene = load_scene("sheet-3x3")
    presses = every_press(scene.parts.skin, scene.press)
    assert [press.pixel for press in presses][:5] == [(0, 0), (1, 1), (1, 2), (1, 3), (2, 1)]
    assert len(presses) == 1 + 9
    assert {touch.factor for press in presses for touch in press.touches} == {2.0}


def test_frequencies_are_put_in_ascending_order():
    scene = parse_scene(replaced(FREQUENCIES, "frequencies = [3e3, 1e3, 2e3]"), "text")
    assert scene.frequencies.tolist() == [1e3, 2e3, 3e3]


@pytest.mark.parametrize(
    ("spacing", "middle"), [("log", math.sqrt(1e3 * 2e5)), ("linear", (1e3 + 2e5) / 2)]
)
def test_a_grid_of_frequencies_holds_both_ends(spacing, middle):
    grid = f'frequencies = {{start = 1e3, stop = 2e5, points = 3, spacing = "{spacing}"}}'
    frequencies = parse_scene(replaced(FREQUENCIES, grid), "text").frequencies
    assert frequencies.tolist() == pytest.approx([1e3, middle, 2e5], rel=1e-15)
    assert (frequencies[0], frequencies[-1]) == (1e3, 2e5)


FREQUENCIES = 'frequencies = {start = 1e3, stop = 200e3, points = 20, spacing = "log"}'
CONTACT = 'name = "bottom-left"\nelectrode = "bottom"\nedge = "left"'
INTERFACE = 'high = ["top-left"]\nlow = ["bottom-left"]'
FOAM = "capacitance_per_area = 4.861e-9"
SHORTED = """[[contact]]
name = "top-bottom"
electrode = "top"
edge = "bottom"
"""


def replaced(*pairs):
    """The 3x3 sheet with pieces of its text replaced: old, new, old, new, ..."""
    text = SHEET
    for old, new in zip(pairs[::2], pairs[1::2], strict=True):
        assert old in text
        text = text.replace(old, new, 1)
    return text


@pytest.mark.parametrize(
    ("pairs", "told"),
    [
        # what is no TOML
        (["length = 0.120", "length = 0.120\nlength = 1"], "not valid TOML"),
        # the skin
        ([FOAM, ""], "`skin.foam` needs either capacitance_per_area, or thickness with"),
        (
            [FOAM, f"{FOAM}\nthickness = 1e-4"],
            "`skin.foam` capacitance_per_area must be >= 8.85419e-8 F/m², that of vacuum",
        ),
        ([FOAM, "thickness = 4e-3"], "`skin.foam` needs either capacitance_per_area"),
        # contacts
        (
            ['edge = "left"', 'edge = "middle"'],
            "`contact[1].edge` must be 'left', 'right', 'bottom' or 'top', got 'middle'",
        ),
        (
            [CONTACT, f"{CONTACT}\nspan = [0.7, 0.7]"],
            "`contact[2]` span must run from a lower to a higher fraction, got (0.7, 0.7)",
        ),
        (
            ['electrode = "bottom"', 'electrode = "top"'],
            "contacts 'top-left' and 'bottom-left' overlap",
        ),
        (['name = "bottom-left"', 'name = "top-left"'], "contact name 'top-left' is used more"),
        # interfaces
        (
            ['high = ["top-left"]', 'high = ["top"]'],
            "interface 'left' names the contact 'top'; there are top-left, bottom-left",
        ),
        (['low = ["bottom-left"]', 'low = ["top-left"]'], "interface 'left' shorts its high"),
        (
            ["[[interface]]", f"{SHORTED}[[interface]]", '["bottom-left"]', '["top-bottom"]'],
            "interface 'left' shorts its high and low side",
        ),
        (
            ["[pixels]", f'[[interface]]\nname = "left"\n{INTERFACE}\n[pixels]'],
            "interface name 'left' is used more than once",
        ),
        # pixels, press, sweep, readout, experiment
        ([FREQUENCIES, "frequencies = [1e3, 1e3]"], "`sweep` frequencies must be distinct"),
        (["start = 1e3", "start = 3e5"], "start must be < stop, got 300000 and 200000 Hz"),
    ],
)
def test_bad_input_is_refused_in_one_line(tmp_path, pairs, told):
    path = tmp_path / "mine.toml"
    path.write_text(replaced(*pairs), encoding="utf-8")
    with pytest.raises(InputError) as error:
        load_scene(path)
    message = str(error.value)
    assert message.startswith(f"{path}: ")
    assert told in message
    assert "\n" not in message


def test_unreadable_files_are_refused(tmp_path):
    with pytest.raises(InputError, match=r"absent\.toml: no such file$"):
        load_scene(tmp_path / "absent.toml")
    with pytest.raises(
        InputError, match=r"shet: no such file, and no built-in scene; did you mean .*sheet-3x3"
    ):
        load_scene("shet")
    binary = tmp_path / "binary.toml"
    binary.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match=r"binary\.toml: cannot be read"):
        read_scene(binary)
    with pytest.raises(InputError, match="is a folder; a scene is a file"):
        read_scene(tmp_path)


def test_scenes_are_frozen():
    scene = load_scene("sheet-3x3")
    with pytest.raises(ValueError, match="frozen"):
        scene.name = "other"
    assert isinstance(hash(scene), int)
    assert Scene.model_validate(scene.model_dump(by_alias=True)) == scene


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("length = 0.120", 'length = "12 cm"', "got '12 cm'; did you mean 0.12?"),
        (
            'high = ["top-left"]',
            'high = "top-left"',
            "must be a list, got 'top-left'; did you mean ['top-left']?",
        ),
        ("[[interface]]", "[interface]", "did you mean [[interface]]?"),
        ('name = "sheet-3x3"', 'name = "a\\nb"', "must be printable, on one line"),
        ("[[contact]]", "[[contacts]]", "`contacts` is not a known key; did you mean `contact`?"),
        ("[[interface]]", "[[interfaces]]", "did you mean `interface`?"),
    ],
)
def test_values_of_another_kind_are_refused(old, new, told):
    assert told in refusal_of(parse_scene, replaced(old, new), "mine.toml")


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        (
            "length = 0.120",
            "length = 12cm  # of it",
            "`length = 12cm`; write numbers without a unit",
        ),
        ("length = 0.120", "length = 12cm", ": 0.12"),
        ("length = 0.120", "length = 0,12", "with a point: 0.12"),
        ("{start = 1e3", "{start = 1 kHz", "`start = 1 kHz`; write numbers without a unit"),
        ('name = "sheet-3x3"', "name = mine", "`name = mine`; write text in quotes"),
        ("[skin]", "[skin", "[skin"),
    ],
)
def test_an_invalid_line_of_TOML_is_shown_with_a_suggestion(old, new, told):
    with pytest.raises(InputError, match=r"mine\.toml: not valid TOML: .* line") as refused:
        parse_scene(replaced(old, new), "mine.toml")
    assert told in str(refused.value)


@pytest.mark.parametrize("of", ["a", "1", "-", "_"])
def test_a_long_invalid_line_is_shown_in_part(of):
    """Looking through all of it for a suggestion would take hours."""
    with pytest.raises(InputError, match="not valid TOML") as refused:
        parse_scene(f"a = 1\n[{of * 200_000}\n", "mine.toml")
    assert len(str(refused.value)) < 1000


@pytest.mark.parametrize(("name", "told"), [("all.nc", "sweeps"), ("m.npz", "a model")])
def test_other_files_than_scenes_are_refused_by_their_kind(name, told, tmp_path):
    (tmp_path / name).write_bytes(b"\x89HDF")
    with pytest.raises(InputError, match=f"{told}, a scene is expected here"):
        load_scene(str(tmp_path / name))

"""

A scene inside sweeps or a model brings its maps and meshes along, and opens no file. The built-in
scenes against the numbers of the paper they stand for.
"""

import math
import sys
from copy import deepcopy

import meshio
import numpy as np
import pytest
import tomli_w
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image
from rcskin.simulator.fem.circuit import two_fields
from rcskin.simulator.measure.simulate import resimulated
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
from rcskin.simulator.scene.wiring_checks import conductor_groups
from rcskin.simulator.sweeps import InputError, read, write
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


OPENED = []
sys.addaudithook(lambda event, told: OPENED.append(str(told[0])) if event == "open" else None)
MESHED = {
    "pixels": {"rows": 1, "columns": 1, "groups": [["all"]]},
    "contact": [
        {"name": "a", "electrode": "top", "edge": "left"},
        {"name": "b", "electrode": "bottom", "edge": "right"},
    ],
    "interface": [{"name": "through", "high": ["a"], "low": ["b"]}],
}


@pytest.fixture
def tables():
    scene = load_scene("sheet-3x3").model_dump(by_alias=True, exclude_none=True)
    return {**scene, "sweep": {"frequencies": [1e3, 1e4]}}


@pytest.fixture
def meshed(tmp_path, tables):
    """A square as a mesh file beside its scene; one corner is in no triangle."""
    points = [[0, 0, 0], [0.12, 0, 0], [0.12, 0.12, 0], [0, 0.12, 0], [0.06, 0.0601, 0], [1, 1, 0]]
    cells = {
        "triangle": [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
        "line": [[3, 0], [1, 2], [2, 5]],
    }
    sets = {"all": [range(4), []], "left": [[], [0]], "right": [[], [1]], "beyond": [[], [2]]}
    sets = {name: [np.array(part, int) for part in each] for name, each in sets.items()}
    meshio.Mesh(np.array(points), list(cells.items()), cell_sets=sets).write(tmp_path / "it.inp")
    skin = {**tables["skin"], "mesh": "it.inp"}
    return {**tables, "skin": skin, **MESHED}


@pytest.fixture
def mapped(tmp_path, tables):
    """A map as a picture beside its scene."""
    shades = np.random.default_rng(1).integers(0, 256, (8, 10), dtype=np.uint8)
    Image.fromarray(shades).save(tmp_path / "it.png")
    tables["skin"]["top"]["map"] = {"kind": "file", "path": "it.png", "low": 0.8, "high": 1.2}
    return tables


@pytest.mark.parametrize(("kind", "ending"), [("mapped", ".nc"), ("meshed", ".csv")])
def test_sweeps_are_simulated_again_where_the_scene_s_files_are_not(
    request, run, tmp_path, kind, ending
):
    scene, sweeps = tmp_path / "mine.toml", tmp_path / f"sweeps{ending}"
    scene.write_text(tomli_w.dumps(request.getfixturevalue(kind)), encoding="utf-8")
    assert run("sweep", scene, "-o", sweeps, "--press", "1,1:3")[0] == 0
    asked, found = load_scene(scene), read(sweeps)
    for each in (scene, *tmp_path.glob("it.*")):
        each.unlink()
    text = found.attrs["scene"]
    assert parse_scene(text, "sweeps") == asked
    assert str(tmp_path) not in text
    again = resimulated(found, parse_scene(text, "scene").parts, found["frequency"].values)
    for name in ("Rs", "X", "Cp"):
        np.testing.assert_array_equal(again[name], found[name])


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"points": "0 0, 1 0, 0"}, "points must be rows of 2 or 3 numbers"),
        ({"points": "0 0, 1 0, 0 x"}, "points must be rows of numbers"),
        ({"points": "", "triangles": ""}, "must have points and triangles"),
        ({"triangles": "0 1 3"}, "triangles must be numbers from 0 to 2"),
        ({"triangles": "0 1 99999999999999999999"}, "triangles must be rows of numbers"),
        ({"lines": "0 -2"}, "lines must be numbers from -1 to 2"),
        ({"group": [{"name": "g", "lines": "0"}]}, "group 'g' lines must be numbers from 0 to -1"),
    ],
)
def test_a_mesh_whose_numbers_disagree_is_refused(tables, change, told):
    mesh = {"source": "a.msh", "points": "0 0, 1 0, 0 1", "triangles": "0 1 2", **change}
    text = tomli_w.dumps({**tables, "skin": {**tables["skin"], "mesh": mesh}})
    with pytest.raises(InputError, match=rf"^sweeps: `skin.mesh` {told}"):
        parse_scene(text, "sweeps")


@pytest.fixture(params=["mesh", "map"])
def received(request, tmp_path, run, tables):
    """Sweeps whose scene names a file of their reader's machine, and that file."""
    secret = tmp_path / "secret.png"
    secret.write_bytes((BUILTIN / "glove.toml").read_bytes())
    run("sweep", "sheet-3x3", "-o", tmp_path / "made.nc")
    if request.param == "mesh":
        tables["skin"]["mesh"] = str(secret)
    else:
        of_file = {"kind": "file", "path": str(secret), "low": 0.5, "high": 2.0}
        tables["skin"]["foam"]["map"] = of_file
    sweeps = read(tmp_path / "made.nc").assign_attrs(scene=tomli_w.dumps(tables))
    write(sweeps, tmp_path / "received.nc")
    return tmp_path / "received.nc", secret


@pytest.mark.parametrize(
    "command",
    [
        "gap {0} {1}",
        "gap {1} {0}",
        "calibrate sheet-3x3 {0} -o {2} --fit capacitance --fix others",
        "check {0}",
        "plot {0} -o {2}.png",
        "train {0} -o {2}.npz",
        "evaluate {0} -o {2}",
        "export {0} -o {2}.parquet",
    ],
)
@pytest.mark.usefixtures("unpainted")
def test_no_command_opens_a_file_that_received_sweeps_name(received, run, tmp_path, command):
    path, secret = received
    OPENED.clear()
    places = (path, tmp_path / "made.nc", tmp_path / "out")
    code, _, err = run(*(part.format(*places) for part in command.split()))
    assert str(secret) not in OPENED
    assert code == 0 or (code == 2 and err.count("\n") == 1)
    if code == 2 and "names the file" in err:
        assert "give the command the scene's own file" in err


def test_a_stored_scene_that_names_files_is_refused_with_advice(mapped):
    with pytest.raises(InputError, match="`skin.top.map` names the file 'it.png', which a scene"):
        parse_scene(tomli_w.dumps(mapped), "sweeps")
    assert "names" not in scene_text(load_scene("glove"))


STRIPS = ["strip-1x3", "strip-1x4", "strip-1x5"]
SHEETS = [name for name in builtin_names() if name.startswith("sheet")]
OF_THE_PAPER = [name for name in builtin_names() if name.startswith(("sheet", "strip"))]


@pytest.mark.parametrize("name", STRIPS)
def test_strips_have_the_loop_resistance_and_capacitance_of_section_3(name):
    """100 mm x 20 mm; 50 kohm/mm of both sheets in series, 108 fF/mm."""
    skin = load_scene(name).skin
    loop = (skin.top.sheet_resistance + skin.bottom.sheet_resistance) / skin.width
    assert (skin.length, skin.width) == (0.100, 0.020)
    assert loop == pytest.approx(50e3 / 1e-3, rel=1e-12)
    per_metre = skin.foam.unpressed_capacitance_per_area * skin.width
    assert per_metre == pytest.approx(108e-15 / 1e-3, rel=1e-12)


@pytest.mark.parametrize("name", STRIPS)
def test_strips_are_read_at_the_frequencies_of_equation_6(name):
    """f_i = 0.0382 / (R C x_i²) at the far end of every pixel, to the hertz."""
    scene = load_scene(name)
    x = np.arange(1, scene.pixels.columns + 1) * 100e-3 / scene.pixels.columns
    expected = 0.0382 / (50e3 / 1e-3 * 108e-15 / 1e-3 * x**2)
    np.testing.assert_array_equal(scene.frequencies, np.round(expected[::-1]))


@pytest.mark.parametrize("name", SHEETS)
def test_sheets_have_the_size_and_capacitance_of_figure_1(name):
    """120 mm x 120 mm, 50 kohm/sq, 70 pF."""
    skin = load_scene(name).skin
    assert (skin.length, skin.width) == (0.120, 0.120)
    assert skin.top.sheet_resistance == skin.bottom.sheet_resistance == 50e3
    picofarad = skin.foam.unpressed_capacitance_per_area * skin.length * skin.width * 1e12
    assert round(picofarad, 2) == 70.0


@pytest.mark.parametrize("name", SHEETS)
def test_sheets_are_read_at_twenty_frequencies_from_1_to_200_kHz(name):
    frequencies = load_scene(name).frequencies
    assert (frequencies[0], frequencies[-1], frequencies.size) == (1e3, 200e3, 20)
    np.testing.assert_allclose(np.diff(np.log(frequencies)), np.log(200) / 19, rtol=1e-12)


@pytest.mark.parametrize("name", OF_THE_PAPER)
def test_every_scene_is_pressed_to_twice_its_capacitance(name):
    scene = load_scene(name)
    assert scene.press.capacitance_factor == 2.0
    assert scene.experiment.repetitions == 6
    assert scene.name.endswith(f"{scene.pixels.rows}x{scene.pixels.columns}") or "5x5-" in name


@pytest.mark.parametrize("name", OF_THE_PAPER)
def test_class_0_is_in_1x3_and_3x3_alone(name):
    assert load_scene(name).experiment.unpressed == name.endswith("x3")


def test_the_pairs_of_foils_on_two_edges_do_not_touch():
    scene = load_scene("sheet-5x5-two-interfaces")
    assert len(set(conductor_groups(scene.contacts, scene.skin))) == 4
    assert [
        drive.high for drive in two_fields(scene.parts.skin, scene.parts.setup).excitations
    ] == [(0,), (2,)]


def test_changes_of_a_scene_are_not_modified():
    """Tables that are given, and what later keys change within them."""
    changes = {"skin.top.map": {"kind": "gradient", "x": 0.2}, "skin.top.map.y": 0.1}
    given = deepcopy(changes)
    changed = load_scene("strip-1x3").with_(changes)
    assert changed.skin.top.map.y == 0.1 and changes == given


def test_the_knit_has_the_yarn_and_the_readings_of_its_paper():
    """0.5 Mohm, 1 Mohm at each end, 2 to 25.75 kHz in steps of 250 Hz, touches of 20 to 40 pF."""
    knit = load_scene("knit-36")
    skin = knit.skin
    assert skin.top.sheet_resistance * skin.length / skin.width == pytest.approx(0.5e6, rel=1e-4)
    assert [each.series_resistance for each in knit.interfaces] == [1e6, 1e6]
    np.testing.assert_allclose(knit.frequencies, 2e3 + 250 * np.arange(96), rtol=1e-12)
    drawn = knit.dataset.press.capacitance
    assert (drawn.low, drawn.high, knit.pixels.shape) == (20e-12, 40e-12, (1, 36))

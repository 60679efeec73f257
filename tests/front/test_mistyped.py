"""Options take units, and what was mistyped is answered with what was likely meant."""

import pytest
from rcskin.__main__ import app
from rcskin.simulator.requests.mistyped import OTHER_NAMES, _all_commands
from rcskin.simulator.requests.plausibility import suspicious_values
from rcskin.simulator.scene.scene_files import load_scene, write_scene
from rcskin.simulator.sweeps.units import quantity
from typer.main import get_command


@pytest.mark.parametrize(
    ("text", "unit", "number"),
    [
        ("10 kHz", "Hz", 1e4),
        ("10khz", "Hz", 1e4),
        ("10k", "Hz", 1e4),
        ("1e4", "Hz", 1e4),
        ("5mm", "mm", 5.0),
        ("0,5 cm", "mm", 5.0),
        ("2 cm/s", "mm/s", 20.0),
        ("50 ms", "s", 0.05),
        ("35 kohm", "ohm/sq", 35e3),
        ("5 %", "", 0.05),
        ("3 mm", None, 3e-3),
    ],
)
def test_numbers_are_read_in_the_unit_of_what_they_are_for(text, unit, number):
    assert quantity(text, unit) == number


@pytest.mark.parametrize(("text", "unit"), [("5 kHz", "mm"), ("5m", "s"), ("two", "Hz")])
def test_a_number_in_another_unit_is_refused(text, unit):
    with pytest.raises(ValueError):
        quantity(text, unit)


def test_the_command_line_takes_frequencies_and_lengths_with_their_units(run):
    shown = run("frequencies", "sheet-3x3", "-n", 2, "--grid", 6, "--size", 10, "--band", "2e3:2e5")
    with_units = ("--size", "1 cm", "--band", "2 kHz:0.2MHz")
    assert run("frequencies", "sheet-3x3", "-n", 2, "--grid", 6, *with_units) == shown


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("limits", "sheet-3x3", "--size", "5 kHz"), "--size must be a number in mm, got '5 kHz'"),
        (("limits", "sheet-3x3", "--draws", "2.5"), "--draws must be a whole number, got '2.5'"),
        (("view", "sheet-3x3", "--frequency", "ten"), "--frequency must be a number in Hz, got"),
        (("simulate", "sheet-3x3"), "No such command 'simulate'. Did you mean `rcskin sweep`?"),
        (("fit", "sheet-3x3"), "Did you mean `rcskin calibrate` or `rcskin train`?"),
        (("predict", "m.skops"), "No such command 'predict'. Did you mean `rcskin localize`?"),
        (("classify",), "Did you mean `rcskin localize` or `rcskin train`?"),
        (("init",), "Did you mean `rcskin new`?"),
        (("identify",), "Did you mean `rcskin meter identify`?"),
        (("meter", "find"), "Did you mean `rcskin meter identify`?"),
        (("meter", "recrd"), "Did you mean `rcskin meter record`?"),
        (("meter", "predict"), "rcskin meter --help lists the commands"),
        (
            ("sweep", "sheet-3x3", "--freqencies", "3"),
            "Did you mean the key `sweep.frequencies` of",
        ),
        (("sweep", "sheet-3x3", "--among", "3"), "Did you mean --among of `rcskin frequencies`?"),
        (("sweep", "sheet-3x3", "--sheet-resistance", "3"), "the key `skin.top.sheet_resistance`"),
        (("sweep", "sheet-3x3", "--press", "2,3:500g"), "a force is in N; did you mean 4.9N?"),
        (("sweep", "sheet-3x3", "--press", "2,3:0.2 kg"), "did you mean 1.96N?"),
        (("sweep", "sheet-3x3", "--press", "2,3:1lb"), "a force is in N, a depth in mm, a factor"),
        (("sweep", "sheet-3x3", "--press", "disc(45,30,10)"), "mean mm, disc(0.045,0.03,0.01)?"),
        (("sweep", "sheet-3x3", "--press", "poly(9,9,30,9,9,30)"), "poly(0.009,0.009,0.03,0.009,"),
    ],
)
def test_what_is_mistyped_gets_one_line_with_what_was_likely_meant(run, tmp_path, words, told):
    output = ("-o", tmp_path / "out.png") if words[0] == "view" else ()
    code, out, err = run(*words, *(("-o", tmp_path / "a.nc") if words[0] == "sweep" else output))
    assert (code, out) == (2, "") and told in err and err.count("\n") == 1


def test_other_names_are_of_commands_and_hide_none():
    known = {path for path, _ in _all_commands(get_command(app), "")}
    assert {f" {name}" for name in OTHER_NAMES} - {" --version"} <= known
    others = {f" {word}" for words in OTHER_NAMES.values() for word in words.split()}
    assert not others & known


@pytest.mark.parametrize(
    ("key", "value", "meant"),
    [
        ("surroundings.body.distance", 4, "0.004"),
        ("surroundings.air", 2, "0.002"),
        ("skin.shape", {"kind": "cylinder", "radius": 40}, "0.04"),
    ],
)
def test_millimetres_in_place_of_metres_are_suspicious(key, value, meant):
    base = {"surroundings": {"low": "virtual earth"}} if key.startswith("surr") else {}
    scene = load_scene("sheet-3x3").with_({**base, key: value})
    assert any(f"did you mean {meant}?" in each for each in suspicious_values(scene))


def test_forces_and_depths_take_prefixes(run, tmp_path):
    presses = ("--press", "2,3:0.002kN", "--press", "2,3:2N", "--press", "2,3:200um")
    code, out, _ = run("sweep", "foam", *presses, "-o", tmp_path / "a.nc")
    assert code == 0 and out.startswith("3 sweeps")


@pytest.mark.parametrize(
    ("frequency", "model", "instead"),
    [(250e3, "IM3523", "or give --model E4980A"), (3e6, "E4980A", "or give --model E4990A")],
)
def test_a_meter_that_does_not_reach_a_frequency_names_one_that_does(
    run, tmp_path, frequency, model, instead
):
    scene = load_scene("sheet-3x3").with_({"sweep.frequencies": [1e3, frequency]})
    write_scene(tmp_path / "fast.toml", scene)
    code, _, err = run("meter", "serve", "--scene", tmp_path / "fast.toml", "--model", model)
    assert code == 2 and err.rstrip().endswith(instead) and "is outside (within reach of " in err


def test_a_choice_of_frequencies_says_what_it_is_optimal_for(run):
    asked = ("frequencies", "strip-1x3", "-n", 2, "--grid", 6)
    for more, goal in (((), "position error, rms"), (("--criterion", "column"), "two columns in")):
        last = run(*asked, *more)[2].splitlines()[-1]
        assert last.startswith("optimal: ") and goal in last
        assert "for one touch of 33.3 x 20 mm" in last and "candidates from 707 Hz to 6.37" in last

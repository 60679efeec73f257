"""`rcskin check` as its user meets it: 0 where all pass, 1 where a law is broken, 2 if bad."""

import numpy as np
import pytest
import xarray as xr
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import press_on
from rcskin.simulator.scene.scene_files import scene_text
from rcskin.simulator.sweeps import read, write

FREQUENCY = np.geomspace(1e3, 1e5, 12)
SERIES = 1e3 + 1 / (2j * np.pi * FREQUENCY * 1e-9)


@pytest.fixture
def two_sweeps(make_sweeps, tmp_path, replacing):
    """A function that writes a file of two sweeps, one of them times a factor."""

    def two_sweeps(factor, ending="nc"):
        path = tmp_path / f"sweeps.{ending}"
        Z = np.stack([SERIES, SERIES * factor])[:, None]
        write(make_sweeps(2, ["meter"], FREQUENCY, Z), path)
        return path

    return two_sweeps


@pytest.mark.parametrize("ending", ["nc", "csv"])
def test_lawful_sweeps_end_with_code_0(run, two_sweeps, ending):
    code, out, err = run("check", two_sweeps(2, ending))
    assert (code, err) == (0, "")
    assert out.count("pass") == 2
    assert "0 of 2 spectra break a law" in out


def test_a_clock_that_went_back_is_reported_for_each_session(run, two_sweeps):
    path = two_sweeps(2)
    sweeps = read(path).assign_coords(time=("sweep", [1e9, 1e9 - 60]))
    write(sweeps, path)
    code, _, err = run("check", path)
    assert code == 0
    assert "warning: session 0: sweep 1 is 60.0 s earlier than sweep 0" in err
    again = path.with_name("again.nc")
    write(sweeps.assign_coords(session=("sweep", [0, 1])), again)
    assert run("check", again)[2] == ""


def test_a_broken_law_ends_with_code_1_and_names_sweep_and_frequencies(run, two_sweeps):
    code, out, err = run("check", two_sweeps(-1))
    assert (code, err) == (1, "")
    assert "sweep 1, interface meter: Re Z >= 0 is broken at 12 frequencies" in out
    assert "1 of 2 spectra break a law" in out


@pytest.mark.usefixtures("replacing")
def test_laws_of_passive_networks_do_not_apply_to_a_virtual_earth(run, make_scene, tmp_path):
    """A finger on a line makes Rs rise with frequency: some of the current goes to earth."""
    line = make_scene(columns=3, frequencies=FREQUENCY.tolist(), top=5e5, bottom=5e5)
    scene = line.with_({"surroundings": {}})
    path, plain = tmp_path / "touched.nc", tmp_path / "plain.nc"
    touched = simulate(
        Solver(scene.parts, 1e-4), [press_on(scene.parts.skin, scene.press, "1,2:2:20pF")]
    )
    write(touched, path)
    code, out, err = run("check", path, "--noise", "1e-3")
    assert code == 0 and "0 of 1 spectra break a law" in out
    assert "readings are transfer impedances" in err
    rod = touched.assign_coords(press=("sweep", ["1,2:2.0"]))
    for unsaid in (touched.drop_attrs(), rod):
        write(unsaid, plain)
        code, out, err = run("check", plain, "--noise", "1e-3")
        assert code == 1 and "1 of 1 spectra break a law" in out
        assert "a body or a finger that takes current to earth also breaks these laws" in out


@pytest.mark.usefixtures("replacing")
def test_creep_during_a_sweep_is_noted(run, make_scene, tmp_path):
    """More and more pressed from one frequency to the next, so that Cp rises."""
    line = make_scene(columns=3, frequencies=FREQUENCY.tolist())
    relaxation = [{"share": 0.3, "time_constant": 1.0}]
    relaxing = line.with_({"skin.foam.thickness": 4e-3, "skin.foam.relaxation": relaxation})
    factors = np.linspace(1.5, 2.5, len(FREQUENCY)).tolist()
    each = [
        simulate(Solver(line.parts, 1e-4), [press_on(line.parts.skin, line.press, f"1,1:{f}")])
        for f in factors
    ]
    parts = [own.isel(frequency=[k]) for k, own in enumerate(each)]
    crept = xr.concat(parts, "frequency", coords="minimal", compat="override", join="override")
    path = tmp_path / "crept.nc"
    write(crept.assign_attrs(each[0].attrs), path)
    assert run("check", path, "--noise", "1e-3")[0] == 1
    write(crept.assign_attrs(each[0].attrs | {"scene": scene_text(relaxing)}), path)
    code, out, err = run("check", path, "--noise", "1e-3")
    assert code == 0 and "0 of 1 spectra break a law" in out
    assert "foam creeps during a sweep" in err


def test_the_chart_is_written_to_the_given_path(run, two_sweeps, tmp_path, monkeypatch):
    for ending, begins in ((".png", b"\x89PNG"), (".svg", b"<?xml")):
        chart = tmp_path / f"chart{ending}"
        assert run("check", two_sweeps(2), "-o", chart)[0] == 0
        assert chart.read_bytes().startswith(begins)
    monkeypatch.chdir(tmp_path)
    assert run("check", two_sweeps(2), "-o", ".")[0] == 0
    assert (tmp_path / "verdicts.csv").exists()
    run("check", two_sweeps(2), "-o", tmp_path / "report")
    assert (tmp_path / "report" / "verdicts.csv").exists()


def test_the_table_of_another_tool_is_checked_as_it_is(run, tmp_path):
    rows = [f"{f}\t{Z.real}\t{-Z.imag}" for f, Z in zip(FREQUENCY, SERIES, strict=True)]
    path = tmp_path / "eis.txt"
    path.write_text("\n".join(["f/Hz\tZ'/ohm\t-Z''/ohm", *rows]))
    assert run("check", path)[0] == 0


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["absent.nc"], "absent.nc: no such file"),
        (["absent.csv"], "absent.csv: no such file"),
        (["SWEEPS", "--noise", "-1"], "--noise must be from 1e-09 to 1, got -1.0"),
        (["SWEEPS", "--tolerance", "0"], "--tolerance must be from 1e-09 to 1, got 0.0"),
        (
            ["SWEEPS", "-o", "report.html"],
            "must end in .png, .svg, .pdf or be a folder",
        ),
    ],
)
def test_bad_input_ends_with_one_line_and_code_2(refused, two_sweeps, arguments, told):
    sweeps = two_sweeps(1)
    assert told in refused("check", *(sweeps if each == "SWEEPS" else each for each in arguments))


def test_too_few_frequencies_name_the_file(refused, make_sweeps, tmp_path):
    write(make_sweeps(), tmp_path / "few.nc")
    told = refused("check", tmp_path / "few.nc")
    assert f"{tmp_path / 'few.nc'}: noise cannot be estimated from 3 frequencies" in told
    assert "by --noise" in told, "an option of the command"


@pytest.mark.parametrize("count", [3, 12])
def test_a_stuck_device_is_named_however_few_frequencies_there_are(
    run, make_sweeps, tmp_path, count
):
    path, f = tmp_path / "stuck.nc", FREQUENCY[:count]
    write(make_sweeps(1, ["meter"], f, np.full((1, 1, count), 2e3 - 5e3j)), path)
    code, out, err = run("check", path)
    assert (code, err) == (1, "")
    told = f"the same reading, digit for digit, at all {count} frequencies: is the device stuck?"
    assert f"sweep 0, interface meter: {told}" in out


def test_a_reading_of_a_wrong_range_is_named(run, make_sweeps, tmp_path):
    path, Z = tmp_path / "range.nc", SERIES[:3].copy()
    Z[2] *= 10
    write(make_sweeps(1, ["meter"], FREQUENCY[:3], Z[None, None]), path)
    code, out, _ = run("check", path)
    assert code == 1 and "2310.13 Hz is about 10 times what the others show" in out

"""`rcskin plot` as its user meets it."""

import numpy as np
import pytest
from rcskin.simulator.check.sweep_curves import (
    CHOICES,
    MAX_DRAWN,
    MAX_NAMED,
    QUANTITIES,
    _baseline,
    _look,
    colours_of,
    curves_of,
    labels_of,
    rows_of,
)
from rcskin.simulator.sweeps import build, read, write
from rcskin.simulator.sweeps.reading_quantities import GAIN, MAGNITUDE


@pytest.fixture
def file(make_sweeps, tmp_path):
    path = tmp_path / "run.nc"
    write(make_sweeps(3, press=["none", "1,1", "none"], row=[0, 1, 0], column=[0, 1, 0]), path)
    return path


@pytest.mark.parametrize("ending", [pytest.param("png", marks=pytest.mark.slow), "svg"])
def test_every_quantity_is_drawn(run, file, tmp_path, ending):
    output = tmp_path / f"out.{ending}"
    asked = [word for name in CHOICES["impedance"] for word in ("--what", name)]
    code, out, err = run("plot", file, "-o", output, *asked)
    assert (code, err) == (0, "") and output.stat().st_size > 5_000
    assert out == f"3 sweeps x 2 interfaces x 3 frequencies -> {output}\n"


@pytest.mark.parametrize("magnitude_only", [False, True])
def test_gains_are_drawn(run, refused, make_sweeps, file, tmp_path, magnitude_only):
    kind = MAGNITUDE if magnitude_only else GAIN
    presses = {"press": ["none", "1,1", "none"], "row": [0, 1, 0], "column": [0, 1, 0]}
    gains = 0.5 * np.exp(-0.3j) * np.ones((3, 1, 3))
    sweeps = build(gains, [1e3, 2e3, 3e3], interface=["left"], kind=kind, **presses).dataset()
    write(sweeps, tmp_path / "gains.nc")
    output = tmp_path / "gains.svg"
    assert run("plot", tmp_path / "gains.nc", "-o", output)[0] == 0
    assert ("phase (°)" in output.read_text(encoding="utf-8")) != magnitude_only
    output = tmp_path / "refused.svg"
    wrong = refused("plot", tmp_path / "gains.nc", "-o", output, "--what", "Rs")
    assert f"--what of {kind.name} must be of gain, " in wrong and "got 'Rs'" in wrong
    mixed = refused("plot", tmp_path / "gains.nc", file, "-o", output)
    assert f"recordings of {kind.name} and of impedance cannot share a chart" in mixed


def test_recordings_are_drawn_over_each_other(run, file, tmp_path):
    code, out, _ = run("plot", file, file, "-o", tmp_path / "out.svg", "--what", "Cp")
    assert code == 0 and "2 recordings -> " in out
    assert (tmp_path / "out.svg").read_text(encoding="utf-8").count("run.nc") >= 2


@pytest.mark.parametrize(
    "words, told",
    [
        (["-o", "out.jpg"], "must end in .png or .svg or .pdf or .html, got '.jpg'"),
        (["-o", "out.png", "--what", "Q"], "--what must be of Rs, Cp, change-Rs, "),
    ],
)
def test_what_cannot_be_drawn_is_one_line(refused, file, words, told):
    assert told in refused("plot", file, *words)


def test_changes_without_a_baseline_are_refused(refused, make_sweeps, tmp_path):
    pressed = make_sweeps(2, press=["1,1", "1,2"], row=[1, 1], column=[1, 2])
    write(pressed, tmp_path / "run.nc")
    output = tmp_path / "out.png"
    assert "has no baseline sweep" in refused(
        "plot", tmp_path / "run.nc", "-o", output, "--what", "change-Cp"
    )
    assert not output.exists()


def test_changes_are_from_the_mean_baseline_of_their_session(make_sweeps):
    press = ["none", "1,1", "none", "none", "1,1"]
    sweeps = make_sweeps(
        5, press=press, row=[0, 1, 0, 0, 1], column=[0, 1, 0, 0, 1], session=[0, 0, 0, 1, 1]
    )
    values = np.arange(5.0)[:, None] * np.ones(sweeps.sizes["frequency"])
    assert _baseline(values, sweeps)[:, 0].tolist() == [1.0, 1.0, 1.0, 3.0, 3.0]


def test_many_presses_are_coloured_by_column(make_sweeps):
    press = ["none", "rect(0.01,0.02,0.005,0.005):2", "1,1+2,2:1.5"]
    press += [f"{row},{column}" for row in range(1, 5) for column in range(1, 5)]
    column = [0, 0, 0] + [column for _ in range(4) for column in range(1, 5)]
    row = [0, 0, 0] + [row for row in range(1, 5) for _ in range(4)]
    sweeps = make_sweeps(len(press), press=press, row=row, column=column)
    labels = labels_of([sweeps])
    assert labels["3,2"] == "column 2" and labels["1,1+2,2:1.5"] == "elsewhere"
    assert list(dict.fromkeys(labels.values()))[-1] == "elsewhere"
    few = labels_of([sweeps.isel(sweep=slice(0, MAX_NAMED))])
    assert few["none"] == "unpressed" and few["1,1"] == "1,1"


def test_rows_of_a_column_have_lines_of_their_own(make_sweeps, run, tmp_path):
    pixels = [(row, column) for row in range(1, 8) for column in range(1, 3)]
    press = ["none", *(f"{row},{column}" for row, column in pixels)]
    row, column = ([0, *each] for each in zip(*pixels, strict=True))
    sweeps = make_sweeps(len(press), press=press, row=row, column=column)
    rows = rows_of([sweeps], labels_of([sweeps]))
    assert rows == {f"{i},{j}": i for i, j in pixels}
    looks = [tuple(_look(each).values()) for each in range(1, 8)]
    assert len(set(looks)) == 7
    assert rows_of([sweeps, sweeps], labels_of([sweeps, sweeps])) == {}
    write(sweeps, tmp_path / "run.nc")
    for name in ("out.svg", "out.html"):
        asked = ("-o", tmp_path / name, "--what", "Cp")
        assert run("plot", tmp_path / "run.nc", *asked)[0] == 0
        assert "row 7" in (tmp_path / name).read_text(encoding="utf-8")


def test_a_pixel_of_one_strength_is_the_same_press_without_it(make_sweeps):
    press = ["none", "2,3:2.0", "2,3", "1,1:1.5", "1,1:2.0", "1,1"]
    row, column = [0, 2, 2, 1, 1, 1], [0, 3, 3, 1, 1, 1]
    labels = labels_of([make_sweeps(6, press=press, row=row, column=column)])
    assert labels["2,3:2.0"] == labels["2,3"] == "2,3"
    assert len({labels[each] for each in press[3:]}) == 3


def test_presses_of_other_strengths_and_places_show_theirs(make_sweeps):
    press, places = ["1,1:0.001m:3e-12F", "disc(0.06,0.06,0.01):5.0N:3e-12F"], [1, -1]
    labels = labels_of([make_sweeps(2, press=press, row=places, column=places)])
    assert [*labels.values()] == ["1,1:1mm:3pF", "disc(0.06,0.06,0.01):5N:3pF"]


@pytest.mark.parametrize("many", [3, 7, 40])
def test_labels_of_many_sweeps_are_distinguished(many):
    colours = colours_of(["unpressed", *(f"column {n}" for n in range(many))])
    assert len(set(colours.values())) == many + 1


@pytest.fixture
def two_files(make_sweeps, tmp_path):
    """A simulated recording and a measured one."""
    labels = {"press": ["none", "1,1", "none"], "row": [0, 1, 0], "column": [0, 1, 0]}
    kinds = {"all.nc": {"model": "line", "rtol": 1e-4}, "run.nc": {"model": "measured"}}
    for name, attributes in kinds.items():
        write(make_sweeps(3, **labels, attributes=attributes), tmp_path / name)
    return [tmp_path / name for name in kinds]


def test_the_legend_distinguishes_measured_and_simulated_sweeps(run, two_files, tmp_path):
    assert run("plot", *two_files, "-o", tmp_path / "out.svg", "--what", "Cp")[0] == 0
    text = (tmp_path / "out.svg").read_text(encoding="utf-8")
    assert "all.nc (simulated)" in text and "run.nc (measured)" in text


def test_a_page_holds_every_curve_and_needs_no_network(run, two_files, tmp_path):
    output = tmp_path / "page.html"
    asked = [word for name in CHOICES["impedance"] for word in ("--what", name)]
    code, out, err = run("plot", *two_files, "-o", output, *asked)
    assert (code, out, err) == (0, f"2 recordings -> {output}\n", "")
    text = output.read_text(encoding="utf-8")
    assert "<script src=" not in text and "plotly.js v" in text
    for name in ("unpressed, all.nc (simulated)", "1,1, run.nc (measured)"):
        assert text.count(f'"name":"{name}"') == 2 * len(CHOICES["impedance"])


def test_a_page_without_plotly_is_refused_in_one_line(refused, file, tmp_path, monkeypatch):
    monkeypatch.setattr("rcskin.simulator.sweeps.optional_packages.find_spec", lambda name: None)
    assert "needs plotly: pip install 'rcskin[view]'" in refused(
        "plot", file, "-o", tmp_path / "page.html"
    )
    assert not (tmp_path / "page.html").exists()


@pytest.mark.usefixtures("unpainted")
@pytest.mark.parametrize("ending", ["zarr", "csv"])
def test_every_file_of_sweeps_is_drawn(run, make_sweeps, tmp_path, ending):
    path = tmp_path / f"run.{ending}"
    write(make_sweeps(3), path)
    code, out, err = run("plot", path, "-o", tmp_path / "out.svg")
    assert (code, err) == (0, "") and out.startswith("3 sweeps x 2 interfaces")


def test_of_very_many_sweeps_some_are_drawn_with_a_note(run, make_sweeps, tmp_path):
    path, many = tmp_path / "many.nc", MAX_DRAWN + 1
    labels = {"press": ["1,1"] * many, "row": [1] * many, "column": [1] * many}
    write(make_sweeps(many, ["left"], **labels), path)
    assert len(list(curves_of(read(path), "left", QUANTITIES["Rs"]))) == MAX_DRAWN
    code, _, err = run("plot", path, "-o", tmp_path / "out.html", "--what", "Rs")
    assert code == 0 and err == f"rcskin: note: {path}: 400 of 401 sweeps are drawn at even steps\n"


@pytest.fixture
def own_frequencies(make_sweeps, tmp_path):
    """A recording whose second interface was read at two of three frequencies."""
    taken = np.array([[True, True, True], [True, False, True]])
    sweeps = make_sweeps(3, press=["none", "1,1", "none"], row=[0, 1, 0], column=[0, 1, 0])
    thin = sweeps.where(np.broadcast_to(taken, sweeps["Rs"].shape))
    told = thin.assign_coords(taken=(("interface", "frequency"), taken.astype(np.int8)))
    write(told, tmp_path / "own.nc")
    return tmp_path / "own.nc"


@pytest.mark.usefixtures("unpainted")
@pytest.mark.parametrize("output", ["out.png", "out.html"])
def test_interfaces_with_frequencies_of_their_own_are_drawn_at_these(
    run, own_frequencies, tmp_path, output
):
    code, out, err = run("plot", own_frequencies, "-o", tmp_path / output)
    assert (code, err) == (0, "") and "3 sweeps x 2 interfaces" in out
    sweeps = read(own_frequencies)
    first, second = (str(name) for name in sweeps["interface"].values)
    for name, count in ((first, 3), (second, 2)):
        for shown in QUANTITIES.values():
            drawn = list(curves_of(sweeps, name, shown))
            assert len(drawn) == 3
            assert all(x.size == count and np.isfinite(y).all() for _, x, y in drawn)

"""`rcskin import` as its user meets it: exit codes, one clear line, nothing half-written."""

import numpy as np
import pytest
from rcskin.simulator.sweeps import impedance, read


@pytest.fixture
def tables(tmp_path):
    """Three tables of one sweep each; the third one of Rs and Cp alone."""
    paths = [tmp_path / f"{name}.txt" for name in "abc"]
    for path in paths[:2]:
        path.write_text("f/kHz\tRs/kohm\t-X/kohm\n2\t1\t4\n1\t1\t8\n")
    paths[2].write_text("f/kHz;Rs/kohm;Cp/nF\n1;1,0;10\n2;1,0;10\n")
    return paths


@pytest.mark.parametrize("ending", ["nc", "csv"])
def test_tables_become_sweeps(run, tables, tmp_path, ending):
    path = tmp_path / f"all.{ending}"
    code, out, err = run("import", *tables[:2], "-o", path)
    assert (code, err) == (0, "")
    assert out == (
        "header in line 1: frequency from `f/kHz`, Rs from `Rs/kohm`, X from `-X/kohm` (negated)\n"
        f"2 sweeps x 2 frequencies -> {path}\n"
    )
    sweeps = read(path)
    assert sweeps["frequency"].values.tolist() == [1e3, 2e3]
    assert impedance(sweeps).tolist() == [[[1e3 - 8e3j, 1e3 - 4e3j]]] * 2


def test_options_label_every_file_or_each(run, tables, tmp_path):
    path = tmp_path / "all.nc"
    run("import", *tables[:2], "--press", "none", "--press", "1,2", "--interface", "left",
        "--session", "3", "-o", path)  # fmt: skip
    sweeps = read(path)
    assert sweeps["press"].values.tolist() == ["none", "1,2"]
    assert sweeps["column"].values.tolist() == [0, 2]
    assert sweeps["interface"].values.tolist() == ["left"]
    assert sweeps["session"].values.tolist() == [3, 3]


def test_the_branch_rule_is_reported_and_kept(run, tables, tmp_path):
    path = tmp_path / "all.nc"
    code, out, _ = run("import", tables[2], "-o", path)
    assert code == 0
    assert "|X| >= Rs" in out
    assert "|X| >= Rs" in read(path).attrs["branch_rule"]


def test_readings_near_45_degrees_are_named_and_a_branch_can_be_forced(run, refused, tmp_path):
    table, path = tmp_path / "some.csv", tmp_path / "all.nc"
    rows = [(1e3, -8e3), (2e3, -3e3), (4e3, -1e3), (8e3, -300), (16e3, -100)]
    Cp = [-X / (1e6 + X**2) / (2 * np.pi * f) for f, X in rows]
    lines = [f"{f},1000,{C!r}" for (f, _), C in zip(rows, Cp, strict=True)]
    table.write_text("\n".join(["f/Hz,Rs,Cp", *lines]))
    code, _, err = run("import", table, "-o", path)
    assert code == 0 and err.count("\n") == 1 and err.endswith("; --branch chooses one\n")
    assert "5 of 5 readings may be on the wrong branch: interface unnamed from 1000 to" in err
    assert read(path)["X"].values.ravel() == pytest.approx([X for _, X in rows])
    code, _, err = run("import", table, "--branch", "capacitive", "-o", tmp_path / "forced.nc")
    assert (code, err) == (0, "")
    assert read(tmp_path / "forced.nc")["X"].values.ravel()[-1] == pytest.approx(-1e4)
    assert "`branch` must be one of followed, capacitive, resistive" in refused(
        "import", table, "--branch", "up", "-o", tmp_path / "other.nc"
    )


def test_the_branch_rule_stands_in_the_help(run):
    code, out, _ = run("import", "--help")
    assert code == 0
    assert "|X| >= Rs" in out


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["a.txt", "-o", "out.xlsx"], "must end in .nc or .csv"),
        (["absent.txt", "-o", "out.nc"], "absent.txt: no such file"),
        (["bad.txt", "-o", "out.nc"], "bad.txt: line 3: `X` must be a finite number, got ''"),
        (["a.txt", "b.txt", "c.txt", "--press", "x", "--press", "y", "-o", "out.nc"],
         "--press must be given once or 3 times, got 2"),
        (["a.txt", "one.txt", "-o", "out.nc"], "one.txt: 1 from 1000 to 1000 Hz are not the"),
    ],
)  # fmt: skip
def test_bad_input_ends_with_one_line_and_code_2(
    refused, tables, tmp_path, monkeypatch, arguments, told
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bad.txt").write_text("f,Rs,X\n1,1,-1\n2,1,\n")
    (tmp_path / "one.txt").write_text("f,Rs,X\n1000,1,-1\n")
    assert told in refused("import", *arguments)
    assert not (tmp_path / "out.nc").exists()


def test_a_table_of_a_stuck_device_gets_a_warning(run, tmp_path):
    table = tmp_path / "stuck.csv"
    rows = [f"{sweep},{f},1666000,-20870000" for sweep in range(3) for f in (707, 1592, 6367)]
    table.write_text("\n".join(["sweep,f/Hz,Rs/ohm,X/ohm", *rows]))
    code, out, err = run("import", table, "-o", tmp_path / "out.nc")
    assert code == 0 and "3 sweeps x 3 frequencies" in out
    assert "sweep 0, interface unnamed: the same reading, digit for digit, at all 3" in err
    assert "is the device stuck? (2 more such)" in err and err.count("\n") == 1

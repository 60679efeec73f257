"""Names in CSV files are no formulas of a spreadsheet, and read back as they were."""

import csv
import io

import numpy as np
import pytest
from rcskin.simulator.sweeps import build, read, write
from rcskin.simulator.sweeps.csv_cells import guarded, unguarded, write_cells

NAMES = ["=1+1", "+cmd", "-left", "@sum", "\tx", "\rx", "'=x", "''", "'it", "-3", "+1e-3", "[red]"]


@pytest.mark.parametrize("name", NAMES)
def test_a_name_comes_back_and_is_no_formula(name):
    cell = guarded(name)
    assert unguarded(cell) == name
    assert cell[0] not in "=@\t\r" and (cell[0] not in "+-" or float(cell))


def test_numbers_stay_as_they_are():
    file = io.StringIO()
    write_cells(file, [[-1.5e-3, -2, "-4.5"]])
    assert file.getvalue() == "-0.0015,-2,-4.5\n"


def test_sweeps_with_such_names_are_written_and_read_back(tmp_path):
    sweeps = build(
        np.full((3, 2, 1), 100 - 50j),
        [1e3],
        interface=["=one", "-two"],
        press=["=a", "@b", "none"],
        row=[-1, -1, 0],
        column=[-1, -1, 0],
        session=[0, 0, 0],
        attributes={"scene": 'description = "x,=1+1;@y,-z"', "note": ",=2"},
    ).dataset()
    write(sweeps, tmp_path / "named.csv")
    again = read(tmp_path / "named.csv")
    for name in ("interface", "press"):
        assert again[name].values.tolist() == sweeps[name].values.tolist()
    assert again.attrs == sweeps.attrs
    lines = (tmp_path / "named.csv").read_text(encoding="utf-8").splitlines()
    for separator in ",;\t":
        rows = csv.reader(lines, delimiter=separator)
        cells = [cell for row in rows for cell in row]
        assert not [each for each in cells if each[:1] in ("=", "@")]

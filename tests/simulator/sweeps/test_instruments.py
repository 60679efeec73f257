"""Files as instruments write them: read to the numbers that they hold, or refused in one line."""

import numpy as np
import pytest
from rcskin.simulator.sweeps import InputError, impedance
from rcskin.simulator.sweeps.imports import ImportOptions, import_file
from rcskin.tests.simulator.sweeps.shared_files import COLUMNS, parsed, shared

FREQUENCY = [100, 200, 500, 1e3, 2e3, 5e3, 1e4, 2e4, 5e4, 8e4]
Z = np.array(
    [996.28289 - 110.25986j, 957.53067 - 210.87761j, 758.91618 - 403.6488j]
    + [463.25816 - 439.47812j, 235.1591 - 311.41353j, 132.67414 - 141.04116j]
    + [115.77771 - 71.878737j, 111.45141 - 36.113245j, 110.23254 - 14.464893j]
    + [110.09085 - 9.0419817j]
)
"""The sweep of the small inputs."""


@pytest.mark.parametrize("name", COLUMNS)
def test_files_of_instruments_hold_what_their_columns_hold(name):
    path = shared("instruments", name)
    sweeps = import_file(path)
    frequency, expected = parsed(name, path.read_text("latin-1"))
    np.testing.assert_allclose(sweeps["frequency"], frequency, rtol=1e-11)
    np.testing.assert_allclose(impedance(sweeps)[0, 0], expected, rtol=1e-12)
    assert "frequency from `" in sweeps.attrs["columns"]


READ = [
    *("03_cp_contradicts_rs_x/zeros.csv", "14_loops_within_a_cycle/index.csv"),
    *("13_text_after_the_table/aborted.dta", "13_text_after_the_table/e4990.csv"),
    *("13_text_after_the_table/zplot.z", "14_loops_within_a_cycle/zero.mpt"),
    *("15_names_of_instruments/bode.csv", "15_names_of_instruments/cp_d.csv"),
    *("15_names_of_instruments/cp_rp.csv", "15_names_of_instruments/g_b.csv"),
    *("15_names_of_instruments/novocontrol.txt", "15_names_of_instruments/powersuite.txt"),
    *("15_names_of_instruments/realimag.csv", "15_names_of_instruments/sjis.csv"),
    *("15_names_of_instruments/smart.csv", "15_names_of_instruments/spaces.txt"),
    *("15_names_of_instruments/waveforms.csv", "15_names_of_instruments/waynekerr.csv"),
    "16_header_in_a_comment/in.csv",
]


@pytest.mark.parametrize("name", READ)
def test_one_sweep_in_the_way_of_many_instruments(name):
    sweeps = import_file(shared("cases", name))
    np.testing.assert_allclose(sweeps["frequency"], FREQUENCY)
    assert np.abs(impedance(sweeps)[0, 0] / Z - 1).max() < 3e-5


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("02_rows_count_from_0/in.csv", "line 12: has row 0 with column 1; rows and columns count"),
        ("03_cp_contradicts_rs_x/in.csv", "line 2: `Cp` does not follow from `Rs (ohm)` and `X"),
        ("03_cp_contradicts_rs_x/in.csv", "(1e12 times as much: is its unit right?)"),
        ("06_columns_contradict_each_other/in.csv", "line 2: `Phase / deg` does not follow from"),
        ("06_columns_contradict_each_other/in.csv", "(the opposite sign)"),
    ],
)
def test_what_contradicts_itself_is_refused_with_its_line(name, message):
    path = shared("cases", name)
    with pytest.raises(InputError) as error:
        import_file(path)
    assert message in str(error.value) and "\n" not in str(error.value)


def test_sweeps_begin_where_the_frequency_turns_back():
    sweeps = import_file(shared("cases", "01_frequencies_jitter", "in.csv"))
    assert dict(sweeps.sizes) == {"sweep": 2, "interface": 1, "frequency": 10}
    assert sweeps["frequency"].values.tolist() == FREQUENCY
    assert "differ by up to 20 ppm" in sweeps.attrs["warnings"]
    loops = import_file(shared("cases", "14_loops_within_a_cycle", "loops.mpt"))
    assert loops.sizes["sweep"] == 2


@pytest.mark.parametrize("name", ["in.csv", "tab.txt"])
def test_commas_between_thousands(name):
    sweeps = import_file(shared("cases", "05_thousands_separators", name))
    assert sweeps["frequency"].values[[0, 7, 17]].tolist() == [40, 1000, 80000]


@pytest.mark.parametrize(
    ("name", "note"),
    [("status.csv", "line 6 (`Status` is -1)"), ("overflow.csv", "line 6 (`Rs (ohm)` is no")],
)
def test_failed_readings_are_left_out_and_named(name, note):
    path = shared("cases", "09_failed_readings", name)
    sweeps = import_file(path)
    assert sweeps["frequency"].values.tolist() == [f for f in FREQUENCY if f != 2000]
    assert sweeps.attrs["left_out"].startswith(note)
    with pytest.raises(InputError, match=r"line 6 .* no reading, as --strict asks"):
        import_file(path, options=ImportOptions(strict=True))

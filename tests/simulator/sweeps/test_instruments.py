"""Files as instruments write them: read to the numbers that they hold, or refused in one line."""

import numpy as np
import pytest
from rcskin.simulator.sweeps import InputError, impedance
from rcskin.simulator.sweeps.imports import import_file
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


ONE_SPECTRUM = {
    "26_segments_that_overlap/loops.csv": 1,
    "26_segments_that_overlap/plain.csv": 1,
    "28_units_above_the_names/in.csv": 1,
    "30_header_cells_of_two_lines/in.csv": 1,
    "30_header_cells_of_two_lines/joined.csv": 2,
    "31_lines_quoted_as_a_whole/in.csv": 1,
}
"""Files of a skin at 100 Hz to 100 kHz, and how many sweeps of it they hold."""


@pytest.mark.parametrize("name", ONE_SPECTRUM)
def test_whole_spectra_from_files_in_unusual_forms(name):
    sweeps = import_file(shared("cases", name))
    assert sweeps["frequency"].values.tolist() == [100, 300, 1e3, 3e3, 1e4, 3e4, 1e5]
    assert sweeps.sizes["sweep"] == ONE_SPECTRUM[name]
    for first, *_, last in impedance(sweeps)[:, 0]:
        assert abs(first / (47795.5 - 457.982j) - 1) < 1e-4
        assert abs(last / (1289.74 - 4772.62j) - 1) < 1e-4


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
        import_file(path, strict=True)


F3, Z3 = [1e5, 1e4, 1e3], [110.1 - 7.2j, 115.8 - 71.9j, 463.3 - 439.5j]


def lines(pattern, start=0):
    """A line for each reading: f, z, phase p in degrees, Cs c, admittance y, number n."""
    return [
        pattern.format(
            **{"f": f, "r": z.real, "x": z.imag, "m": -z.imag, "z": abs(z), "y": 1 / z, "n": n},
            **{"p": np.degrees(np.angle(z)), "q": -np.degrees(np.angle(z))},
            **{"c": -1 / (2 * np.pi * f * z.imag)},
        )
        for n, (f, z) in enumerate(zip(F3, Z3, strict=True), start)
    ]


PALMSENS = ["freq / Hz,neg. Phase / \u00b0,Idc / uA,Z / Ohm,Z' / Ohm,-Z'' / Ohm,Cs / F"]
FORMS = {
    "PalmSens": (
        ["Date and time:,2025-01-01 00:00:00", "CH 1: Fixed at 3 freqs", *PALMSENS]
        + lines("{f:E},{q:.6g},1,{z:.7g},{r:.7g},{m:.7g},{c:.6g}")
        + ["CH 2: Fixed at 3 freqs", *PALMSENS]
        + lines("{f:E},{q:.6g},1,{z:.7g},{r:.7g},{m:.7g},{c:.6g}"),
        "utf-16",
    ),
    "Zahner": (
        ["Thales", "", "  Number  Frequency/Hz  Impedance/Ohm  Phase/deg  Significance  Time/s", ""]
        + lines("  {n}   {f:.6E}   {z:.8E}   {p:.7E}   9.9E-01   1.2E+01"),
        "utf-8",
    ),
    "Nova": (
        ["Index;Frequency (Hz);Z' (\u03a9);-Z'' (\u03a9);Z (\u03a9);-Phase (\u00b0);Time (s)"]
        + [
            line.replace(".", ",")
            for line in lines("{n};{f};{r:.8g};{m:.8g};{z:.8g};{q:.8g};1.5", 1)
        ],
        "utf-8",
    ),
    "E4990A": (
        ["!CSV A.01.01", "BEGIN CH1_DATA", "Frequency(Hz), G(S)-data, B(S)-data"]
        + lines("{f}, {y.real:.9g}, {y.imag:.9g}")
        + ["END"],
        "utf-8",
    ),
    "IM3523": (
        ["HIOKI", '"FREQ[Hz]","RS[ohm]","X[ohm]","STATUS"'] + lines("{f:.4E},{r:.6E},{x:.6E},0"),
        "utf-8",
    ),
    "Solartron": (
        ["Frequency (Hz)\tZ'\tZ''\t|Z|\ttheta"] + lines("{f}\t{r:.7g}\t{x:.7g}\t{z:.7g}\t{p:.4g}"),
        "utf-8",
    ),
    "4192A": (["Frequency /Hz, Z_r, Z_im, remark"] + lines("{f}\t{r:.7g}\t{x:.7g}\tx"), "utf-8"),
}


@pytest.mark.parametrize("name", FORMS)
def test_tables_in_the_form_of_instruments(tmp_path, name):
    text, encoding = FORMS[name]
    (tmp_path / "file.txt").write_text("\n".join(text), encoding=encoding)
    sweeps = import_file(tmp_path / "file.txt")
    assert sweeps["frequency"].values.tolist() == F3[::-1]
    for each in impedance(sweeps)[:, 0]:
        np.testing.assert_allclose(each, Z3[::-1], rtol=1e-6)

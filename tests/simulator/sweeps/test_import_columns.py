"""What the columns of a table are taken for: curves, letters, prefixes, channels, odd numbers.

Numbers with units are understood, where they are certain, as their users mean them. Names in CSV
files are no formulas of a spreadsheet, and read back as they were.
"""

import csv
import io

import numpy as np
import pytest
from rcskin.simulator.sweeps import InputError, build, impedance, read, write
from rcskin.simulator.sweeps.csv_cells import guarded, unguarded, write_cells
from rcskin.simulator.sweeps.importing.grouping import Defaults
from rcskin.simulator.sweeps.imports import import_file
from rcskin.simulator.sweeps.units import in_si
from rcskin.tests.simulator.sweeps.shared_files import shared

F = np.array([1e3, 1e4, 1e5])
Z = np.array([300 - 900j, 200 - 400j, 100 - 50j])
FACTORS = (1, 1.03, 1.001)


@pytest.fixture
def table(tmp_path):
    """A function that imports columns of numbers or text below their names."""

    def table(columns, separator=",", **defaults):
        names, *cells = zip(*((name, *column) for name, column in columns), strict=True)
        rows = [separator.join(map(_text, row)) for row in cells]
        path = tmp_path / "some.csv"
        path.write_text("\n".join([separator.join(names), *rows]), encoding="utf-8")
        return import_file(path, Defaults(**defaults))

    return table


def _text(cell):
    return cell if isinstance(cell, str) else f"{cell:.9g}"


def curves(names):
    """Columns of as many curves as there are pairs of names."""
    parts = [part for factor in FACTORS for part in ((factor * Z).real, (factor * Z).imag)]
    return list(zip(names, parts, strict=False))


@pytest.mark.parametrize(
    "names",
    [
        "Rs X Rs X Rs X",
        "Rs X Rs.1 X.1 Rs.2 X.2",
        "R X R.1 X.1",
        "Rs_1 X_1 Rs_2 X_2 Rs_3 X_3",
        "CH1_Rs_ohm CH1_X_ohm CH2_Rs_ohm CH2_X_ohm",
        "A:Z' A:Z'' B:Z' B:Z'' C:Z' C:Z''",
        "Rs@(Run@1) X@(Run@1) Rs@(Run@2) X@(Run@2)",
        "Trace@1:@Rs@(ohm) Trace@1:@X@(ohm) Trace@2:@Rs@(ohm) Trace@2:@X@(ohm)",
        "Rs@(ohm) X@(ohm) Rs@(ohm).1 X@(ohm).1",
    ],
)
@pytest.mark.parametrize("own_frequency", [False, True])
def test_columns_of_one_quantity_are_curves(table, names, own_frequency):
    names = names.replace("@", "\0").split()
    columns = curves([name.replace("\0", " ") for name in names])
    blocks = [columns[place : place + 2] for place in range(0, len(columns), 2)]
    columns = [("f/Hz", F), *columns]
    if own_frequency:
        columns = [each for block in blocks for each in (("f/Hz", F), *block)]
    sweeps = table(columns)
    expected = [factor * Z for factor in FACTORS[: len(blocks)]]
    np.testing.assert_allclose(impedance(sweeps)[:, 0], expected, rtol=1e-8)
    assert f"{len(blocks)} curves beside each other: frequency from" in sweeps.attrs["columns"]


def test_two_quantities_of_one_reading_are_compared(table):
    columns = [("f", F), ("Z'", Z.real), ("Z''", Z.imag), ("|Z|", abs(Z))]
    sweeps = table([*columns, ("phase (deg)", np.degrees(np.angle(Z)))])
    assert sweeps.sizes["sweep"] == 1
    assert sweeps.attrs["columns"].endswith("`|Z|`, `phase (deg)` agree")
    traces = [("f", F), ("Trace 1: |Z|", abs(Z)), ("Trace 2: Phase (rad)", np.angle(Z))]
    assert table(traces).sizes["sweep"] == 1
    copied = table([("f", F), ("Rs", Z.real), ("X", Z.imag), ("Rs", Z.real)])
    assert copied.sizes["sweep"] == 1


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ([("Rs", Z.real), ("X", Z.imag), ("Rs", 1.03 * Z.real)], r"Rs twice, `Rs` .column 2. and"),
        (
            [("Rs", Z.real), ("X", Z.imag), ("Rs.1", 1.03 * Z.real)],
            r"has Rs twice, `Rs` .column 2. and `Rs.1` .column 4., but not all",
        ),
        ([("Rs", Z.real), ("X", Z.imag), ("ESR", 1.03 * Z.real)], "`ESR` does not follow from"),
        (
            [("A: Rs", Z.real), ("A: X", Z.imag), ("B: |Z|", abs(Z)), ("B: phase (rad)", 0 * F)],
            "curves of Rs and X and of magnitude and phase; name the columns of one",
        ),
        (
            [("Rs", Z.real), ("X", Z.imag), ("f", 2 * F), ("Rs", Z.real), ("X", Z.imag)],
            "columns of other curves stand beside it; --columns with - for them reads one curve",
        ),
    ],
)
def test_half_a_curve_is_refused(table, columns, message):
    with pytest.raises(InputError, match=message):
        table([("f", F), *columns])


@pytest.mark.parametrize("name", ["curves.csv", "traces.csv", "channels.csv"])
def test_curves_as_instruments_write_them(name):
    sweeps = import_file(shared("cases", "22_two_curves_side_by_side", name))
    assert sweeps.sizes["sweep"] == 2
    np.testing.assert_allclose(sweeps["Rs"][:, 0, 0], [47795.5, 49229.4], rtol=1e-5)


@pytest.mark.parametrize(
    "letters",
    [
        {"x": -2.5e-4, "R/Ohm": 1350},
        {"x": 20, "y": 35},
        {"X": 20, "Y": 35},
        {"R/Ohm": 1350},
        {"r": 7},
    ],
)
@pytest.mark.parametrize("pair", ["Re(Z)/Ohm -Im(Z)/Ohm", "|Z|/Ohm Phase(Z)/rad"])
def test_letters_name_a_quantity_only_without_plain_names(table, letters, pair):
    parts = (Z.real, -Z.imag) if pair.startswith("Re") else (abs(Z), np.angle(Z))
    plain = [("freq/Hz", F), *zip(pair.split(), parts, strict=True)]
    sweeps = table([*[(name, 0 * F + value) for name, value in letters.items()], *plain])
    np.testing.assert_allclose(impedance(sweeps)[0, 0], Z, rtol=1e-8)
    listed = ", ".join(f"`{name}`" for name in letters)
    assert sweeps.attrs["columns"].endswith(f"not used: {listed}")


def test_letters_that_stand_for_a_reading_are_compared(table):
    plain = [("f", F), ("|Z|", abs(Z)), ("phase (rad)", np.angle(Z))]
    assert "agree" in table([*plain, ("r", Z.real), ("x", Z.imag)]).attrs["columns"]
    with pytest.raises(InputError, match="`.Z.` does not follow from `R` and `X`"):
        table([*plain, ("R", Z.real), ("X", 1.2 * Z.imag)])
    assert impedance(table([("f", F), ("r", Z.real), ("x", Z.imag)]))[0, 0, 0] == Z[0]


@pytest.mark.parametrize(("R", "X"), [("Rs (ohm)", "X (ohm)"), ("R", "X"), ("R/Ohm", "X/Ohm")])
def test_a_place_beside_R_and_X_is_not_taken(table, R, X):
    place = [("x", 0 * F + 20), ("y", 0 * F + 35)]
    sweeps = table([*place, ("f (Hz)", F), (R, Z.real), (X, Z.imag)])
    np.testing.assert_allclose(impedance(sweeps)[0, 0], Z, rtol=1e-8)


@pytest.mark.parametrize("name", ["x.mpt", "r.mpt", "position.csv"])
def test_letters_as_instruments_use_them(name):
    sweeps = import_file(shared("cases", "25_x_and_r_of_others", name))
    assert np.abs(impedance(sweeps)[0, 0, 0] / (47795.5 - 458.0j) - 1) < 1e-4


@pytest.mark.parametrize(
    "name", ["freq_mhz", "FREQ_MHZ", "f[mhz]", "Freq (mhz)", "F/MHZ", "Frequency (MHz)"]
)
def test_mega_in_a_name_without_case(table, name):
    sweeps = table([(name, F / 1e6), ("Rs", Z.real), ("X", Z.imag)])
    np.testing.assert_allclose(sweeps["frequency"], F, rtol=1e-9)
    assert name == "Frequency (MHz)" or f"`{name}` (in MHz)" in sweeps.attrs["columns"]


@pytest.mark.parametrize("names", ["rs_mohm x_mohm", "RS_MOHMS X_MOHMS", "Rs(MOHM) X(MOHM)"])
@pytest.mark.parametrize(("unit", "size"), [(1e6, 1.0), (1e-3, 1e3)])
def test_mega_or_milli_is_what_is_plausible(table, names, unit, size):
    first, second = names.split()
    columns = [(first, size * Z.real / unit), (second, size * Z.imag / unit)]
    sweeps = table([("freq_hz", F), *columns])
    np.testing.assert_allclose(impedance(sweeps)[0, 0], size * Z, rtol=1e-8)


@pytest.mark.parametrize(
    ("names", "readings"),
    [("f rs_mohm x_mohm", Z), ("freq_mhz Rs X", Z)],
)
def test_a_prefix_that_may_be_both_is_refused(table, names, readings):
    columns = zip(names.split(), (F / 1e3, readings.real, readings.imag), strict=True)
    with pytest.raises(InputError, match=r"column `\w+` may be in m\w+ or in M\w+, as its name"):
        table(columns)


def test_a_prefix_without_a_reading_is_refused(table):
    with pytest.raises(InputError, match="column `freq_mhz` may be in mHz or in MHz"):
        table([("freq_mhz", ["OL"] * 3), ("Rs", Z.real), ("X", Z.imag)])


def test_other_prefixes_in_names_without_case(table):
    sweeps = table([("FREQ_KHZ", F / 1e3), ("CP_PF", 0 * F + 5), ("RP_KOHM", 0 * F + 2)])
    assert sweeps["Cp"].values.ravel() == pytest.approx([5e-12] * 3)
    assert (1 / impedance(sweeps).ravel()).real == pytest.approx(1 / 2e3)
    assert table([("f", F), ("cp_mf", 0 * F + 5), ("d", 0 * F), ("rp", 0 * F + 2)])["Cp"][
        0, 0, 0
    ] == pytest.approx(5e-3)


@pytest.mark.parametrize("name", ["channel", "Ch", "CH#", "port", "mux", "Channel No."])
def test_a_channel_labels_interfaces(table, name):
    columns = [("f", np.tile(F, 2)), (name, np.repeat([1, 2], 3))]
    readings = np.concatenate([Z, 2 * Z])
    columns += [("Rs", readings.real), ("X", readings.imag)]
    sweeps = table(columns)
    assert sweeps["interface"].values.tolist() == ["1", "2"]
    np.testing.assert_allclose(impedance(sweeps)[0], [Z, 2 * Z])
    with pytest.raises(InputError, match="has its own column `.*`, so no interface may be given"):
        table(columns, interface="left")


def test_a_channel_that_is_the_same_everywhere_yields_to_a_given_interface(table):
    columns = [("f", F), ("ch", ["7"] * 3), ("Rs", Z.real), ("X", Z.imag)]
    assert table(columns)["interface"].item() == "7"
    assert table(columns, interface="left")["interface"].item() == "left"
    twice = [(name, np.tile(cells, 2)) for name, cells in [("port", ["COM3"] * 3), *columns]]
    twice[2] = ("ch", np.repeat(["7", "8"], 3))
    assert table(twice)["interface"].values.tolist() == ["7", "8"]


CODES = [("f", F), ("Real", [523, 498, 470]), ("Imag", [-812, -790, -760])]


@pytest.mark.parametrize(
    "impedances",
    [
        ["10234,5", "10100,2", "9987,1"],
        ["10.234,5", "10.100,2", "9.987,1"],
        ["10'234.5", "10'100.2", "9'987.1"],
        ["10234.5", "<10100", "9987 ohm"],
        ["", "10,100", "9,987"],
    ],
)
def test_codes_do_not_pass_as_ohm_since_their_impedance_is_written_otherwise(table, impedances):
    with pytest.raises(InputError, match="`Impedance` does not follow from `Real` and `Imag`"):
        table([*CODES, ("Impedance", impedances)], separator=";")


def test_numbers_in_another_format_are_compared_too(table):
    columns = [("f", F), ("Rs", Z.real), ("X", Z.imag)]
    written = [f"{size:.4f}".replace(".", ",") for size in abs(Z)]
    assert "`|Z|` agrees" in table([*columns, ("|Z|", written)], separator=";").attrs["columns"]


def test_cells_that_cannot_be_compared_are_named(table):
    columns = [("f", F), ("Rs", Z.real), ("X", Z.imag)]
    sweeps = table([*columns, ("D", [f"{300 / 900:.4g}", "<1", "2 (limit)"])])
    assert "`D` agrees" in sweeps.attrs["columns"]
    assert sweeps.attrs["warnings"] == (
        "`D` cannot be compared in 2 of 3 lines: '<1' in line 3 is no number"
    )
    sweeps = table([*columns, ("D", ["OL", "", "n/a"])])
    assert "warnings" not in sweeps.attrs


@pytest.mark.parametrize(
    ("written", "plain"),
    [
        ("2cm", "0.02"),
        ("90 mm", "0.09"),
        ("0,09", "0.09"),
        ("20k", "20000"),
        ("35 kohm/sq", "35000"),
        ("200 kHz", "200000"),
        ("12pF", "1.2e-11"),
        ("150%", "1.5"),
        ("3 m", "3"),
    ],
)
def test_what_a_number_is_without_its_unit(written, plain):
    assert in_si(written) == plain


@pytest.mark.parametrize("written", ["", "2", "1e3", "2 apples", "x2", "1,2,3", "1.2.3k", "cm"])
def test_no_guess_where_nothing_is_certain(written):
    assert in_si(written) is None


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

"""Layouts of instruments that are no table with a header, and files that are no text."""

import numpy as np
import pytest
from rcskin.simulator.sweeps import InputError, impedance
from rcskin.simulator.sweeps.imports import import_file
from rcskin.tests.simulator.sweeps.shared_files import shared

F = np.array([1e3, 1e4, 1e5])
Z = np.array([300 - 900j, 200 - 400j, 100 - 50j])


@pytest.fixture
def imported(tmp_path):
    """A function that imports a file of some text."""

    def imported(*lines, name="file.txt"):
        (tmp_path / name).write_text("\n".join(lines), encoding="utf-8")
        return import_file(tmp_path / name)

    return imported


def check(sweeps, rtol=1e-9):
    np.testing.assert_allclose(sweeps["frequency"], F, rtol=1e-12)
    for each in impedance(sweeps)[:, 0]:
        np.testing.assert_allclose(each, Z, rtol=rtol)


def blocks(parameter, one, other, imaginary="0"):
    lines = ["4294A REV1.11", f'"MEASURE PARAMETER: {parameter}"', ""]
    for name, values in (("A", one), ("B", other)):
        lines += [f'"TRACE: {name}"', '"FORMAT: LOG"', ""]
        lines += ['"Frequency"\t"Data Trace Real"\t"Data Trace Imag"']
        lines += [f"{f:.9g}\t{v!r}\t{imaginary}" for f, v in zip(F, values.tolist(), strict=True)]
    return lines


PARAMETERS = {
    "IMPEDANCE MAG PHASE (DEG)": (abs(Z), np.degrees(np.angle(Z))),
    "ADMITTANCE MAG PHASE (DEG)": (1 / abs(Z), -np.degrees(np.angle(Z))),
    "Cp-D": ((1 / Z).imag / (2 * np.pi * F), -Z.real / Z.imag),
    "R-X": (Z.real, Z.imag),
}


@pytest.mark.parametrize("parameter", PARAMETERS)
def test_blocks_of_traces(imported, parameter):
    check(imported(*blocks(parameter, *PARAMETERS[parameter])))
    twice = imported(*2 * blocks(parameter, *PARAMETERS[parameter]))
    assert twice.sizes["sweep"] == 2
    check(twice)


def test_blocks_of_traces_that_are_broken(imported):
    good = blocks("R-X", Z.real, Z.imag)
    for lines, message in [
        (blocks("volts", Z.real, Z.imag), "the measure parameter 'volts' of its traces is unknown"),
        (good[:10], "line 4: traces A and B must follow each other"),
        (good[:-1], "line 11: trace B has other frequencies than trace A"),
        (blocks("R-X", Z.real, Z.imag, "1"), "line 8: a trace must have a frequency, a number"),
    ]:
        with pytest.raises(InputError, match=message):
            imported(*lines)


def fields(separator, chunk=0, **changed):
    rows = {
        "absz": abs(Z),
        "frequency": F,
        "imagz": Z.imag,
        "phasez": np.angle(Z),
        "realz": Z.real,
        "realzstddev": 0 * F,
        **changed,
    }
    return [
        separator.join(map(str, [chunk, 112574, len(values), name, *values.tolist()]))
        for name, values in rows.items()
    ]


@pytest.mark.parametrize("separator", [";", ","])
def test_a_line_for_each_quantity(imported, separator):
    head = separator.join(["chunk", "timestamp", "size", "fieldname"])
    sweeps = imported(head, *fields(separator), *fields(separator, 1))
    assert sweeps.sizes["sweep"] == 2
    check(sweeps)
    assert "`absz`, `phasez (rad)` agree" in sweeps.attrs["columns"]
    with pytest.raises(InputError, match="`phasez .rad.` does not follow from `realz` and `imagz`"):
        imported(head, *fields(separator, phasez=-np.angle(Z)))
    with pytest.raises(InputError, match="line 6: `realz` has 2 numbers, line 2 has 3"):
        imported(head, *fields(separator, realz=Z.real[:2]))


def test_a_file_that_two_rules_can_read_is_refused_with_both(imported):
    table = ["f/Hz;Rs;X", "1;2;-3", "2;2;-3"]
    with pytest.raises(InputError, match="line 1 and as a line for each quantity"):
        imported(*table, *fields(";"))


def s_parameters(s, ports):
    lines = ["! made by hand", "# kHz S RI R 50"]
    for f, row in zip(F, s.reshape(len(F), -1), strict=True):
        numbers = " ".join(f"{each.real!r} {each.imag!r}" for each in row.tolist())
        lines.append(f"{f / 1e3:.9g} {numbers}")
    return lines


def two_ports(s11, s21):
    return np.stack([s11, s21, s21, s11], axis=1)


def test_touchstone(imported):
    pytest.importorskip("skrf")
    check(imported(*s_parameters((Z - 50) / (Z + 50), 1), name="a.s1p"))
    in_series = two_ports(Z / (Z + 100), 100 / (Z + 100))
    check(imported(*s_parameters(in_series, 2), name="a.s2p"))
    to_ground = two_ports(-50 / (2 * Z + 50), 2 * Z / (2 * Z + 50))
    check(imported(*s_parameters(to_ground, 2), name="b.S2P"))
    with pytest.raises(InputError, match=r"its two ports hold no single impedance: neither S11"):
        imported(*s_parameters(two_ports(0.3 + 0 * Z, 0.3 + 0 * Z), 2), name="a.s2p")
    with pytest.raises(InputError, match=r"cannot be read as Touchstone"):
        imported("# kHz S RI R 50", "1 0.5 x", name="a.s1p")


@pytest.mark.parametrize("name", ["a.s1p", "a.s2p", "A.S1P"])
def test_a_touchstone_runs_nothing(tmp_path, name):
    pytest.importorskip("skrf")
    folder = tmp_path / "owned"
    (tmp_path / name).write_bytes(b"cposix\nmkdir\n(S'%s'\ntR." % str(folder).encode())
    with pytest.raises(InputError, match="cannot be read as Touchstone"):
        import_file(tmp_path / name)
    assert not folder.exists()


def test_touchstone_as_instruments_write_it():
    pytest.importorskip("skrf")
    sweeps = import_file(shared("cases", "15_names_of_instruments", "touchstone.s1p"))
    assert (
        np.abs(
            impedance(sweeps)[0, 0, [0, -1]] / [996.28289 - 110.25986j, 110.09085 - 9.0419817j] - 1
        ).max()
        < 1e-5
    )


def test_traces_as_instruments_write_them():
    sweeps = import_file(shared("cases", "15_names_of_instruments", "4294a.txt"))
    assert np.abs(impedance(sweeps)[0, 0, 0] / (996.28289 - 110.25986j) - 1) < 1e-5


def workbook(path, **sheets):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    book.remove(book.active)
    for name, rows in sheets.items():
        sheet = book.create_sheet(name)
        for row in rows:
            sheet.append(row)
    book.save(path)
    return path


def test_workbooks(tmp_path):
    rows = [["made by hand"], [None], ["f (kHz)", "remark", "Rs (ohm)", "X (ohm)"]]
    rows += [[f / 1e3, "a\tb", z.real, z.imag] for f, z in zip(F.tolist(), Z.tolist(), strict=True)]
    path = workbook(tmp_path / "a.xlsx", notes=[["nothing"]], data=rows)
    check(import_file(path))
    with pytest.raises(InputError, match="sheet 2 is not the only one with a table"):
        import_file(workbook(tmp_path / "a.xlsx", one=rows, two=rows))
    with pytest.raises(InputError, match="no line names a frequency column"):
        import_file(workbook(tmp_path / "a.xlsx", one=rows[:1]))
    path.write_bytes(b"no workbook")
    with pytest.raises(InputError, match=r"a\.xlsx: cannot be read as a workbook"):
        import_file(path)


def test_binary_files_are_refused_with_what_to_do(imported):
    with pytest.raises(InputError, match=r"a \.mpr is binary: export it as text \(\.mpt\) in EC-"):
        imported("x", name="a.mpr")

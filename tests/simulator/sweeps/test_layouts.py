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


NUMBERS = {
    "RI": lambda s: (s.real, s.imag),
    "MA": lambda s: (abs(s), np.degrees(np.angle(s))),
    "DB": lambda s: (20 * np.log10(abs(s)), np.degrees(np.angle(s))),
}


def touchstone(parameters, option="# kHz S RI R 50", above=(), digits=12):
    """Lines of a Touchstone of parameters of shape (frequency, all of one line)."""
    (form,) = {"RI", "MA", "DB"} & {*option.split()} or {"MA"}
    lines = ["! made by hand", option, *above]
    for f, row in zip(F, parameters.reshape(len(F), -1), strict=True):
        numbers = [f"{n:.{digits}g}" for each in row for n in NUMBERS[form](each)]
        lines.append(f"{f / 1e3:.9g} {' '.join(numbers)}")
    return lines


def two_ports(s11, s21):
    return np.stack([s11, s21, s21, s11], axis=1)


def in_series(Z):
    return two_ports(Z / (Z + 100), 100 / (Z + 100))


def to_ground(Z):
    return two_ports(-50 / (2 * Z + 50), 2 * Z / (2 * Z + 50))


S = (Z - 50) / (Z + 50)
OF_VERSION_2 = ("[Number of Ports] 1", "[Number of Frequencies] 3", "[Network Data]")
TOUCHSTONES = {
    "one port": ("a.s1p", touchstone(S)),
    "in series": ("a.s2p", touchstone(in_series(Z))),
    "to ground": ("b.S2P", touchstone(to_ground(Z))),
    "magnitude and angle": ("a.s2p", touchstone(in_series(Z), "# kHz S MA R 50")),
    "decibels": ("a.s2p", touchstone(to_ground(Z), "# kHz S DB R 50")),
    "no reference": ("a.s1p", touchstone(S, "# kHz S RI")),
    "another reference": ("a.s1p", touchstone((Z - 75) / (Z + 75), "# kHz S RI R 75")),
    "Z-parameters, normalized": ("a.s1p", touchstone(Z / 50, "# kHz Z RI R 50")),
    "Y-parameters, to 1 ohm": ("a.s1p", touchstone(1 / Z, "# kHz Y MA R 1")),
    "Y-parameters of two ports": (
        "a.s2p",
        touchstone(two_ports(1 / Z, -1 / Z), "# kHz Y RI R 1"),
    ),
    "Z-parameters of two ports": ("a.s2p", touchstone(two_ports(Z, Z), "# kHz Z RI R 1")),
    "version 2": ("a.s1p", ["[Version] 2.0", *touchstone(S, above=OF_VERSION_2), "[End]"]),
    "version 2, admittance": (
        "a.s1p",
        ["[Version] 2.0", *touchstone(1 / Z, "# kHz Y RI R 50", OF_VERSION_2), "[End]"],
    ),
}


@pytest.mark.parametrize("kind", TOUCHSTONES)
def test_touchstone(imported, kind):
    pytest.importorskip("skrf")
    name, lines = TOUCHSTONES[kind]
    check(imported(*lines, name=name))


NO_SINGLE = r"a\.s2p: its two ports hold no single impedance: S21 .*; save the port .* as \.s1p"
REFUSED = {
    "no part": ("a.s2p", touchstone(two_ports(0.3 + 0 * Z, 0.3 + 0 * Z)), NO_SINGLE),
    "nothing at port 2": (
        "a.s2p",
        touchstone(np.stack([S, 0 * S, 0 * S, 0 * S + 1], 1)),
        NO_SINGLE,
    ),
    "zeros beside S11": ("a.s2p", touchstone(two_ports(S, 0 * S)), NO_SINGLE),
    "no text": ("a.s1p", ["# kHz S RI R 50", "1 0.5 x"], "cannot be read as Touchstone"),
    "three ports": ("a.s3p", touchstone(np.zeros((3, 9))), "from one or two ports, got 3"),
    "a million ports": ("a.s999999p", touchstone(S), "from one or two ports, got 999999"),
    "ports declared": (
        "a.s1p",
        ["[Version] 2.0", "[Number of Ports] 99999", *touchstone(S)],
        "from one or two ports, got 99999",
    ),
    "two references": ("a.s2p", touchstone(in_series(Z), "# kHz S RI R 50 75"), "one reference"),
    "two references of version 2": (
        "a.s2p",
        ["[Version] 2.0", *touchstone(in_series(Z), above=("[Reference] 50 75",))],
        "one reference",
    ),
    "complex reference": ("a.s1p", touchstone(S, "# kHz S RI R 50+1j"), "one reference imped"),
    "no reference": ("a.s1p", touchstone(S, "# kHz S RI R 0"), "reference impedance, real and > 0"),
    "Y-parameters, normalized": (
        "a.s1p",
        touchstone(50 / Z, "# kHz Y RI R 50"),
        "Y-parameters of version 1 are read only if they are normalized to 1 ohm; save S- or Z-",
    ),
    "open everywhere": ("a.s1p", touchstone(0 * S + 1), "no line has a reading"),
    "open between ports": (
        "a.s2p",
        touchstone(two_ports(0 * S + 1, 0 * S)),
        "no line has a reading",
    ),
}


@pytest.mark.parametrize("kind", REFUSED)
def test_touchstone_without_an_impedance_is_refused(imported, kind):
    pytest.importorskip("skrf")
    name, lines, message = REFUSED[kind]
    with pytest.raises(InputError, match=message):
        imported(*lines, name=name)


@pytest.mark.parametrize("option", ["# kHz S RI R 50", "# kHz S MA R 50", "# kHz S DB R 50"])
@pytest.mark.parametrize("angle", [0, 360])
def test_an_open_reading_of_a_touchstone_is_left_out(imported, option, angle):
    pytest.importorskip("skrf")
    lines = touchstone(S, option)
    lines[3] = f"10 {0 if 'DB' in option else 1} {0 if 'RI' in option else angle}"
    sweeps = imported(*lines, name="a.s1p")
    assert sweeps.attrs["left_out"] == "line 4 (`Rs (ohm)` is no reading)"
    np.testing.assert_allclose(impedance(sweeps)[0, 0], Z[[0, 2]], rtol=1e-9)


@pytest.mark.parametrize("form", [in_series, to_ground])
def test_a_reading_of_two_ports_that_is_no_number_is_left_out(imported, form):
    pytest.importorskip("skrf")
    lines = touchstone(form(Z))
    lines[3] = "10" + " nan" * 8
    sweeps = imported(*lines, name="a.s2p")
    assert sweeps.attrs["left_out"] == "line 4 (`Rs (ohm)` is no reading)"
    np.testing.assert_allclose(impedance(sweeps)[0, 0], Z[[0, 2]], rtol=1e-9)


@pytest.mark.parametrize("digits", [6, 9])
@pytest.mark.parametrize("size", 10.0 ** np.arange(0, 8))
def test_two_ports_of_any_impedance_are_told_apart(imported, size, digits):
    """A part is read in series and to ground, or refused where digits do not tell its S11."""
    pytest.importorskip("skrf")
    part = size * np.exp(-0.6j) * np.array([1, 0.9, 0.5])
    for form, name in ((in_series, "a.s2p"), (to_ground, "b.s2p")):
        try:
            found = impedance(imported(*touchstone(form(part), digits=digits), name=name))[0, 0]
        except InputError as error:
            assert "no single impedance" in str(error) and size == 1e7 and digits == 6
        else:
            np.testing.assert_allclose(found, part, rtol=0.2 if digits == 6 else 1e-3)


@pytest.mark.parametrize("decibels", range(-120, -39, 10))
@pytest.mark.parametrize("noise", [0, 1e-5, 1e-4])
def test_crosstalk_of_a_one_port_is_no_part_in_series(imported, decibels, noise):
    pytest.importorskip("skrf")
    random = np.random.default_rng(0)
    for size in 10.0 ** np.arange(1, 7.1, 0.5):
        part = size * np.exp(-0.6j) * np.array([1, 0.6, 0.2])
        s11, leak = (part - 50) / (part + 50), 0 * part + 10 ** (decibels / 20)
        s = np.stack([s11, leak, leak, 0 * part + 1], axis=1)
        s = s + noise * (random.normal(size=s.shape) + 1j * random.normal(size=s.shape))
        with pytest.raises(InputError, match=NO_SINGLE):
            imported(*touchstone(s), name="a.s2p")


@pytest.mark.parametrize("size", [300, 3e3, 30e3])
def test_a_part_between_the_ports_of_an_analyser_is_read_with_its_noise(imported, size):
    """Noise of 1e-4 of S11, 1e-6 of S21, and impedances that fall as those of a skin."""
    pytest.importorskip("skrf")
    random = np.random.default_rng(0)
    part = size / (1 + 1j * np.array([0.1, 1, 10]))
    s = in_series(part)
    s = s + [1e-4, 1e-6, 1e-6, 1e-4] * (
        random.normal(size=s.shape) + 1j * random.normal(size=s.shape)
    )
    found = impedance(imported(*touchstone(s), name="a.s2p"))[0, 0]
    np.testing.assert_allclose(found, part, rtol=5e-3)


def test_a_one_port_in_a_file_for_two_is_refused_or_read_as_one():
    pytest.importorskip("skrf")
    one = impedance(import_file(shared("cases", "23_s2p_of_one_port", "reflection.s1p")))[0, 0]
    assert np.abs(one[0] / (47795.5 - 458.0j) - 1) < 1e-5
    with pytest.raises(InputError, match="no single impedance"):
        import_file(shared("cases", "23_s2p_of_one_port", "reflection.s2p"))


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


@pytest.mark.parametrize(
    ("name", "advice"),
    [
        ("a.mpr", r"a \.mpr is binary: export it as text \(\.mpt\) in EC-Lab"),
        ("a.pssession", "is a session of PSTrace: export its measurement as .csv there"),
        ("a.mat", "is a file of MATLAB: save its columns as .csv there, by writetable"),
        ("a.xls", "is no .xlsx: save it as .xlsx or .csv"),
        *((f"a{ending}", "write its frequencies") for ending in (".h5", ".HDF5", ".pkl")),
        ("a.csv.gz", "is packed: unpack it"),
    ],
)
def test_binary_files_are_refused_with_what_to_do(imported, name, advice):
    with pytest.raises(InputError, match=advice):
        imported("x", name=name)


@pytest.mark.parametrize("name", ["a.csv", "a.txt", "a.mpt", "a.xlsx", "a.s1p", "a"])
@pytest.mark.parametrize("above", [[], ["made by hand", "a; b; c; d; e; f"]])
def test_commands_that_read_sweeps_name_import_for_tables_of_others(run, tmp_path, name, above):
    (tmp_path / name).write_text("\n".join([*above, "f/Hz;Rs;X", "100;1;2", "200;1;2"]))
    for command in (
        ["localize", "any.npz"],
        ["evaluate", "any.npz"],
        ["adapt", "any.npz", "-o", tmp_path / "b.npz"],
        ["train", "-o", tmp_path / "b.npz"],
        ["calibrate", "strip-1x3"],
        ["join", "-o", tmp_path / "b.nc"],
        ["gap", "-o", tmp_path / "gap", tmp_path / name],
        ["export", "-o", tmp_path / "b.mcap"],
    ):
        code, _, err = run(*command, tmp_path / name)
        assert (code, err.count("\n")) == (2, 1) and "rcskin import" in err, (command, err)

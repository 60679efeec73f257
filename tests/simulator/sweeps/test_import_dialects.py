"""Any dialect of a table gives the same Z, and a spoilt one a line that says where."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.sweeps import InputError, build, impedance, parallel_capacitance
from rcskin.simulator.sweeps.imports import import_file

DIGITS = 9
PREFIXES = {"": 1, "k": 1e3, "m": 1e-3, "M": 1e6, "u": 1e-6, "n": 1e-9, "p": 1e-12, "\u00b5": 1e-6}
FREQUENCY_NAMES = ["Frequency (@Hz)", "freq_@Hz", "f/@Hz", "FREQ [@Hz]", "Frequency in @Hz"]
PAIRS = {
    ("Rs", "X"): [
        ["Rs [@ohm]", "Zreal_@ohm", "Z' (@Ohm)", "Re(Z)/@Ohm", "R (@\u03a9)", "Z_real/@Ohm"],
        ["X [@ohm]", "-Z'' (@Ohm)", "-Im(Z)/@Ohm", "Zimag @ohm", "Z\u2033 (@\u2126)", "X_@ohm"],
    ],
    ("magnitude", "phase"): [
        ["|Z| (@Ohm)", "Z[@ohm]", "Zmod @ohm", "|Z|/@Ohm"],
        ["theta (deg)", "Phase/rad", "-Phase (\u00b0)", "PHASE[deg]", "Phase(Z)/deg"],
    ],
    ("Rs", "Cs"): [["Rs_@ohm", "RS[@ohm]"], ["Cs (@F)", "CS[@F]"]],
    ("Rs", "Cp"): [["Rs (@ohm)", "Rs [@Ohm]"], ["Cp (@F)", "Cp_@F"]],
}
PREAMBLES = [[], ["# made by a tool", "Instrument: 4711"], ["% x", "; y", "", "Date,2024-01-02"]]


@dataclass(frozen=True)
class Dialect:
    """How a table is written."""

    pair: tuple
    names: list
    separator: str
    decimal: str
    order: list
    descending: bool
    labelled: bool
    preamble: list
    header_mark: str
    comment: bool


@st.composite
def dialects(draw):
    pair = draw(st.sampled_from(list(PAIRS)))
    prefixes = [["", "k", "M"], ["", "k", "m", "M"], ["", "u", "\u00b5", "n", "p", "m"]]
    kinds = [0, 1, 2 if pair[1][0] == "C" else 1]
    patterns = [FREQUENCY_NAMES, *PAIRS[pair]]
    return Dialect(
        pair,
        [
            (draw(st.sampled_from(names)), draw(st.sampled_from(prefixes[kind])))
            for names, kind in zip(patterns, kinds, strict=True)
        ],
        draw(st.sampled_from(",;\t")),
        draw(st.sampled_from(".,")),
        draw(st.permutations(range(4))),
        draw(st.booleans()),
        draw(st.booleans()),
        draw(st.sampled_from(PREAMBLES)),
        draw(st.sampled_from(["", "# "])),
        draw(st.booleans()),
    )


def written(sweeps, dialect):
    """The text of sweeps at one interface, in that dialect."""
    frequency = sweeps["frequency"].values
    lines = []
    for index, Z in enumerate(impedance(sweeps)[:, 0]):
        first, second = quantities(Z, frequency, dialect)
        rows = [*zip(frequency, first, second, strict=True)]
        for row in reversed(rows) if dialect.descending else rows:
            numbers = zip(row, dialect.names, strict=True)
            cells = [number(value, name, dialect.decimal) for value, name in numbers]
            lines.append(in_order([*cells, str(index + 1) if dialect.labelled else "x"], dialect))
        if dialect.comment:
            lines += ["# between", ""]
    header = in_order(
        [
            *(name.replace("@", prefix) for name, prefix in dialect.names),
            "Sweep" if dialect.labelled else "remark",
        ],
        dialect,
    )
    return "\n".join([*dialect.preamble, dialect.header_mark + header, *lines, ""])


def quantities(Z, frequency, dialect):
    omega = 2 * np.pi * frequency
    return {
        ("Rs", "X"): (Z.real, Z.imag),
        ("magnitude", "phase"): (np.abs(Z), np.angle(Z)),
        ("Rs", "Cs"): (Z.real, -1 / (omega * Z.imag)),
        ("Rs", "Cp"): (Z.real, parallel_capacitance(Z, frequency)),
    }[dialect.pair]


def number(value, name, decimal):
    pattern, prefix = name
    unit = math.pi / 180 if "deg" in pattern or "\u00b0" in pattern else 1
    scale = (PREFIXES[prefix] if "@" in pattern else unit) * (-1 if pattern[0] == "-" else 1)
    return f"{value / scale:.{DIGITS}g}".replace(".", decimal)


def in_order(cells, dialect):
    quoted = [f'"{cell}"' if dialect.separator in cell else cell for cell in cells]
    return dialect.separator.join(quoted[place] for place in dialect.order)


@st.composite
def sweeps_of_one_interface(draw):
    """Up to three sweeps whose phase lies where (Rs, Cp) are well-conditioned too."""
    points, count = draw(st.integers(1, 5)), draw(st.integers(1, 3))
    parts = st.tuples(st.floats(-2, 8), st.floats(-89, -50))
    drawn = draw(st.lists(parts, min_size=points * count, max_size=points * count))
    Z = np.array([10**size * np.exp(1j * np.radians(phase)) for size, phase in drawn])
    frequency = np.cumprod([draw(st.floats(1, 1e5)), *[draw(st.floats(1.1, 5))] * (points - 1)])
    rounded = [float(f"{f:.{DIGITS}g}") for f in frequency]
    labels = {name: [-1] * count for name in ("row", "column")}
    shaped = Z.reshape(count, 1, points)
    return build(
        shaped, rounded, interface=["unnamed"], press=["unknown"] * count, **labels
    ).dataset()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("tables")


@given(sweeps=sweeps_of_one_interface(), dialect=dialects())
def test_every_dialect_gives_the_same_impedance(folder, sweeps, dialect):
    (folder / "any.txt").write_text(written(sweeps, dialect), encoding="utf-8")
    imported = import_file(folder / "any.txt", branch="capacitive")
    np.testing.assert_allclose(imported["frequency"], sweeps["frequency"], rtol=1e-8)
    error = np.abs(impedance(imported) / impedance(sweeps) - 1)
    assert error.max() < 2e-7
    assert ("branch_rule" in imported.attrs) == (dialect.pair == ("Rs", "Cp"))


@given(
    sweeps=sweeps_of_one_interface(),
    dialect=dialects(),
    junk=st.sampled_from(["", "1.2.3", "0x10", "1_0", "\u0661"]),
    data=st.data(),
)
def test_a_bad_cell_is_reported_with_file_and_line(folder, sweeps, dialect, junk, data):
    lines = written(sweeps, dialect).split("\n")
    begin = len(dialect.preamble) + 1
    readings = [at for at in range(begin, len(lines)) if lines[at] not in ("", "# between")]
    line = data.draw(st.sampled_from(readings))
    cells = [""] * 4
    place = data.draw(st.sampled_from([0, 1, 2]))
    cells[dialect.order.index(place)] = junk
    for other in {0, 1, 2, 3} - {place}:
        cells[dialect.order.index(other)] = "1"
    lines[line] = dialect.separator.join(cells)
    (folder / "bad.txt").write_text("\n".join(lines), encoding="utf-8")
    with pytest.raises(InputError) as error:
        import_file(folder / "bad.txt")
    assert str(error.value).startswith(f"{folder / 'bad.txt'}: line {line + 1}: ")
    assert "\n" not in str(error.value)


@given(sweeps=sweeps_of_one_interface(), dialect=dialects(), data=st.data())
def test_a_file_of_any_bytes_is_read_or_reported_in_one_line(folder, sweeps, dialect, data):
    content = bytearray(written(sweeps, dialect).encode())
    for _ in range(data.draw(st.integers(1, 4))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    (folder / "bytes.txt").write_bytes(content)
    try:
        imported = import_file(folder / "bytes.txt")
    except InputError as error:
        assert str(error).startswith(f"{folder / 'bytes.txt'}: ")
        assert "\n" not in str(error)
    else:
        assert np.isfinite(impedance(imported)).all()

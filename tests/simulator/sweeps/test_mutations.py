"""Spoilt files of instruments are read to the numbers that they hold, or refused in one line.

What a file holds is said by a parser of its own: cells between separators at known places.
"""

import re
from dataclasses import dataclass, replace

import numpy as np
import pytest
from rcskin.simulator.sweeps import InputError, impedance
from rcskin.simulator.sweeps.imports import import_file
from rcskin.tests.simulator.sweeps.shared_files import COLUMNS, FOLDER

QUICK, MANY = 100, 2000
JUNK = ["", "nan", "OL", "9.9E+37", "abc", "1e999", "-", "--", "1.2.3", "0x1F", "#N/A", "1,5", "0"]
TEXTS = ["END", "aborted by user", "x\ty\tz", "a,b,c", "---", "1", "# note", "Phase 2: done", '"']


@dataclass(frozen=True)
class Table:
    """A file in parts. places: of frequency, first and second quantity. kind: of the pair."""

    above: tuple
    header: tuple
    rows: tuple
    separator: str
    places: tuple
    kind: str = "Rs X"
    sign: float = 1.0
    decimal: str = "."
    encoding: str = "utf-8"
    newline: str = "\n"

    def content(self):
        lines = [*self.above, self.separator.join(self.header), *map(self.line, self.rows)]
        return self.newline.join([*lines, ""]).encode(self.encoding)

    def line(self, row):
        if isinstance(row, str):
            return row
        return self.separator.join(cell.replace(".", self.decimal) for cell in row)

    def readings(self, content):
        """Frequency and Z of all lines of a content that are whole."""
        text = content.decode(self.encoding, errors="replace")
        found = []
        for line in re.split(r"\r\n|\r|\n", text):
            cells = line.split(self.separator) if self.separator.strip(" ") else line.split()
            while len(cells) > len(self.header) and not cells[-1].strip():
                cells.pop()
            if len(cells) != len(self.header):
                continue
            numbers = [cells[place].strip().replace(self.decimal, ".") for place in self.places]
            if not all(re.fullmatch(r"[+-]?\d*\.?\d+\.?([eE][+-]?\d+)?", n) for n in numbers):
                continue
            f, a, b = map(float, numbers)
            if f > 0 and max(abs(a), abs(b)) < 1e30:
                found.append((f, self.impedance(f, a, b)))
        return found

    def impedance(self, f, a, b):
        b = self.sign * b
        if self.kind == "Rs X":
            return a + 1j * b
        if self.kind == "|Z| phase":
            return a * np.exp(1j * np.radians(b))
        return 1 / (a + 2j * np.pi * f * b)


F = [100, 200, 500, 1000, 2000, 5000, 10000, 20000, 50000, 80000]
Z = [1 / (1 / 900 + 2j * np.pi * f * 2e-7) + 110 for f in F]


def drawn(names, kind, separator, places, sign=1.0, more=()):
    rows = []
    for f, z in zip(F, Z, strict=True):
        pair = {
            "Rs X": (z.real, sign * z.imag),
            "|Z| phase": (abs(z), np.degrees(np.angle(z))),
            "G Cp": ((1 / z).real, (1 / z).imag / (2 * np.pi * f)),
        }[kind]
        cells = {0: f"{f}", 1: f"{pair[0]:.7g}", 2: f"{pair[1]:.7g}", 3: f"{abs(z):.7g}", 4: "0"}
        rows.append(tuple(cells[k] for k in more))
    return Table(("made by hand",), names, tuple(rows), separator, places, kind, sign)


DRAWN = [
    drawn(("Freq (Hz)", "Rs (ohm)", "X (ohm)"), "Rs X", ",", (0, 1, 2), more=(0, 1, 2)),
    drawn(
        ("freq/Hz", "Re(Z)/Ohm", "-Im(Z)/Ohm", "|Z|/Ohm"),
        "Rs X",
        "\t",
        (0, 1, 2),
        -1.0,
        (0, 1, 2, 3),
    ),
    drawn(("Z[ohm]", "f[Hz]", "Phase[deg]"), "|Z| phase", ";", (1, 0, 2), more=(1, 0, 2)),
    drawn(("f/Hz", "G/S", "Status", "Cp/F"), "G Cp", ";", (0, 1, 3), more=(0, 1, 4, 2)),
    drawn(("f/Hz", "Rs/ohm", "X/ohm"), "Rs X", "   ", (0, 1, 2), more=(0, 1, 2)),
]


HEADERS = {
    **{"BioLogic.mpt": 61, "CHInstruments.txt": 17, "Gamry.DTA": 447, "Parstat.txt": 1},
    **{"Powersuite.txt": 1, "VersaStudio.par": 116, "ZPlot.z": 122},
}
"""Lines of headers."""


def of_instruments():
    """The files of instruments beside the project, as tables; none where they are absent."""
    for name, (separator, f, real, imaginary, sign) in COLUMNS.items():
        path = FOLDER / "instruments" / name
        if not path.exists() or name not in HEADERS:
            continue
        lines = path.read_text("latin-1").split("\n")
        header = lines[HEADERS[name] - 1].rstrip(separator + " 0\r").split(separator)
        above, below = (
            tuple(part) for part in (lines[: HEADERS[name] - 1], lines[HEADERS[name] :])
        )
        places = f, real, imaginary
        yield Table(
            above, tuple(header), below, separator, places, sign=float(sign), encoding="latin-1"
        )


def whole(table):
    """Changes that leave the readings as they are."""
    yield lambda rng: replace(table, newline="\r\n")
    yield lambda rng: replace(table, above=(*table.above, "# note", "", "Date: today"))
    if all(ord(sign) < 256 for line in table.above for sign in line):
        yield lambda rng: replace(table, encoding="utf-16")
    if all(isinstance(row, tuple) for row in table.rows):
        yield lambda rng: _permuted(table, rng)
        if table.separator != ",":
            yield lambda rng: replace(table, decimal=",")


def _permuted(table, rng):
    order = rng.permutation(len(table.header)).tolist()
    return replace(
        table,
        header=tuple(table.header[k] for k in order),
        rows=tuple(tuple(row[k] for k in order) for row in table.rows),
        places=tuple(order.index(place) for place in table.places),
    )


def spoilt(table, content, rng):
    """The content with one random damage below the header."""
    mark = table.newline.encode(table.encoding if table.encoding != "utf-16" else "utf-16-le")
    lines = content.split(mark)
    first = len(table.above) + 1
    if len(lines) <= first:
        return content
    at = int(rng.integers(first, len(lines)))
    if table.encoding == "utf-16":
        return mark.join([*lines[:at], *lines[at + 1 :]])
    separator = table.separator.encode()
    cells = lines[at].split(separator)
    cell = int(rng.integers(len(cells)))
    kind = int(rng.integers(10))
    if kind == 0:
        place = int(rng.integers(sum(map(len, lines[:first])) + first, len(content)))
        return content[:place] + bytes([int(rng.integers(32, 127))]) + content[place + 1 :]
    if kind == 1:
        return content[: int(rng.integers(len(content) // 2, len(content)))]
    if kind == 2:
        return mark.join([*lines[:at], lines[at], *lines[at:]])
    if kind == 3:
        return mark.join([*lines[:at], *lines[at + 1 :]])
    if kind == 4:
        other = int(rng.integers(first, len(lines)))
        lines[at], lines[other] = lines[other], lines[at]
        return mark.join(lines)
    if kind == 5:
        text = TEXTS[int(rng.integers(len(TEXTS)))].encode()
        return mark.join([*lines[:at], text, *lines[at:]])
    if kind == 6:
        cells[cell] = JUNK[int(rng.integers(len(JUNK)))].encode()
    elif kind == 7:
        del cells[cell]
    elif kind == 8:
        cells[cell] += str(rng.integers(10)).encode()
    else:
        cells[cell] = b"-" + cells[cell]
    lines[at] = separator.join(cells)
    return mark.join(lines)


def outcome(table, content, path):
    """`read` or `refused`; fails if other numbers are read, or if numbers vanish silently."""
    path.write_bytes(content)
    expected = table.readings(content)
    try:
        sweeps = import_file(path)
    except InputError as error:
        assert str(error).startswith(str(path)) and "\n" not in str(error)
        return "refused"
    found = impedance(sweeps)[:, 0]
    frequency = np.broadcast_to(sweeps["frequency"].values, found.shape).ravel()
    found = found.ravel()
    rest = list(expected)
    for f, z in zip(frequency, found, strict=True):
        same = [abs(f / g - 1) < 1e-3 and abs(z / w - 1) < 1e-9 for g, w in rest]
        fits = np.flatnonzero(same)
        assert fits.size, (path.read_bytes(), f, z)
        rest.pop(fits[0])
    assert not rest or "left_out" in sweeps.attrs, (rest, sweeps.attrs)
    return "read"


def outcomes(number, seed, folder, tables):
    rng = np.random.default_rng(seed)
    counts = {"read": 0, "refused": 0}
    for k in range(number):
        table = tables[k % len(tables)]
        changes = list(whole(table))
        if rng.random() < 0.5:
            table = changes[int(rng.integers(len(changes)))](rng)
        content = table.content()
        for _ in range(int(rng.integers(1, 4))):
            content = spoilt(table, content, rng)
        counts[outcome(table, content, folder / "spoilt.txt")] += 1
    return counts


@pytest.mark.parametrize("number", range(len(DRAWN)))
def test_files_that_are_not_spoilt_are_read(tmp_path, number):
    table = DRAWN[number]
    for change in [lambda rng: table, *whole(table)]:
        changed = change(np.random.default_rng(0))
        assert outcome(changed, changed.content(), tmp_path / "whole.txt") == "read"


def test_spoilt_files_are_read_right_or_refused(tmp_path):
    counts = outcomes(QUICK, 1, tmp_path, DRAWN)
    assert counts["read"] > QUICK / 4 and counts["refused"] > QUICK / 10


@pytest.mark.slow
def test_many_spoilt_files_are_read_right_or_refused(tmp_path):
    counts = outcomes(MANY, 2, tmp_path, [*DRAWN, *of_instruments()])
    assert counts["read"] > MANY / 4

"""Sweeps from lines: a fault never becomes a wrong sweep, and each is counted."""

import math

import numpy as np
import pytest
from rcskin.hardware.reader.line_format import LineFormat
from rcskin.hardware.reader.line_port import MAX_LINE, LineCutter
from rcskin.hardware.reader.sweep_assembly import SweepAssembly
from rcskin.simulator.sweeps import inputs
from rcskin.tests.hardware.reader.reader_files import (
    ARRAYS,
    COUNTED,
    FREQUENCIES,
    counted_lines,
    true_value,
)


def assembled(text, lines, frequencies=None, **changed):
    """Sweeps from lines, and the kinds of noted faults."""
    notes = []
    line_format = LineFormat.model_validate({**inputs.tables(text), **changed})
    wanted = {name: np.array(own) for name, own in (frequencies or FREQUENCIES).items()}
    assembly = SweepAssembly(line_format, wanted, lambda kind, text: notes.append(kind))
    found = [sweep for sweep in map(assembly.feed, lines) if sweep is not None]
    return found, notes


def whole(sweep):
    """Truth of a sweep of the device."""
    return {
        name: [true_value(name, f, sweep) for f in frequencies]
        for name, frequencies in FREQUENCIES.items()
    }


def assert_sweeps(found, expected):
    assert len(found) == len(expected)
    for sweep, number in zip(found, expected, strict=True):
        for name, Z in whole(number).items():
            np.testing.assert_allclose(sweep[name], Z, rtol=1e-12)


def stream(*sweeps):
    """Lines of successive sweeps, counted on, and the first line of one more."""
    lines = [line for k, sweep in enumerate(sweeps) for line in counted_lines(sweep, 6 * k)]
    return [*lines, counted_lines(0, len(lines))[0]]


def test_lines_become_sweeps_from_the_first_whole_one_on():
    found, notes = assembled(COUNTED, stream(0, 1, 2)[2:])
    assert_sweeps(found, [1, 2])
    assert notes == []


CUT = "1,10,A,20"
FAULTS = {
    "half a line": (lambda lines: [*lines[:7], CUT, *lines[8:]], ["lines of a wrong length"]),
    "two lines in one": (
        lambda lines: [*lines[:7], lines[7][:6] + lines[8], *lines[9:]],
        ["lines of a wrong length", "gaps in the count"],
    ),
    "garbage": (lambda lines: [*lines[:7], "?x??", *lines[8:]], ["lines that are no readings"]),
    "a line too long": (lambda lines: [*lines[:7], None, *lines[8:]], ["lines that are too long"]),
    "a lost line": (lambda lines: [*lines[:7], *lines[8:]], ["gaps in the count"]),
    "a changed count": (
        lambda lines: [*lines[:7], f"70{lines[7]}", *lines[8:]],
        ["gaps in the count", "restarts of the device"],
    ),
    "two values of one count": (
        lambda lines: [*lines[:8], lines[7].replace("1010.0", "1020.0"), *lines[8:]],
        ["readings that came twice"],
    ),
    "not a number": (
        lambda lines: [*lines[:7], lines[7].replace("1010.0", "nan"), *lines[8:]],
        ["readings out of range"],
    ),
    "infinite": (
        lambda lines: [*lines[:7], lines[7].replace("1010.0", "1e999"), *lines[8:]],
        ["readings out of range"],
    ),
    "no number": (
        lambda lines: [*lines[:7], lines[7].replace("1010.0", "1_0"), *lines[8:]],
        ["lines that are no readings"],
    ),
    "another frequency": (
        lambda lines: [*lines[:7], lines[7].replace(",2000,", ",2100,"), *lines[8:]],
        ["readings at other frequencies"],
    ),
    "a frequency twice": (
        lambda lines: [*lines[:8], lines[8].replace(",4000,", ",2000,"), *lines[9:]],
        ["readings that came twice"],
    ),
    "another terminal": (
        lambda lines: [*lines[:7], lines[7].replace(",A,", ",C,"), *lines[8:]],
        ["lines of an unknown terminal"],
    ),
    "a restart": (
        lambda lines: [*lines[:8], "boot: READY", *stream(5), *lines[12:]],
        ["restarts of the device", "gaps in the count"],
    ),
    "a restart without a word": (
        lambda lines: [*lines[:8], *stream(5), *lines[12:]],
        ["restarts of the device", "gaps in the count"],
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_within_a_sweep_costs_that_sweep_and_is_noted(name):
    """The second of three sweeps is spoilt; a device that restarts begins another one."""
    spoil, expected = FAULTS[name]
    found, notes = assembled(COUNTED, spoil(stream(0, 1, 2)))
    assert_sweeps(found, [0, 5, 2] if "restart" in name else [0, 2])
    assert set(notes) >= set(expected)


def test_a_line_that_comes_twice_is_used_once():
    lines = stream(0, 1)
    found, notes = assembled(COUNTED, [*lines[:3], lines[2], *lines[3:]])
    assert_sweeps(found, [0, 1])
    assert notes == ["repeated lines"]


def test_interleaved_sweeps_give_none():
    one, other = counted_lines(0), counted_lines(1)
    numbered = [
        f"{k},{line}" for pair in zip(one, other, strict=True) for k, line in enumerate(pair)
    ]
    columns = ["s", "n", "t", "port", "f", "r", "x"]
    found, notes = assembled(COUNTED, numbered, columns=columns, count="", sweep="s", time="")
    assert found == [] and "interleaved sweeps" in notes
    found, notes = assembled(
        COUNTED, [line for pair in zip(one, other, strict=True) for line in pair], count="", time=""
    )
    assert found == [] and set(notes) == {"incomplete sweeps", "readings that came twice"}


def test_without_counters_a_lost_line_is_noticed_by_the_next_sweep():
    lines = stream(0, 1, 2)
    found, notes = assembled(COUNTED, [*lines[:7], *lines[8:]], count="", time="")
    assert_sweeps(found, [0, 2])
    assert notes == ["incomplete sweeps"]


def test_a_count_that_wraps_is_no_fault():
    lines = [f"{(k + 250) % 256},{line.split(',', 1)[1]}" for k, line in enumerate(stream(0, 1, 2))]
    found, notes = assembled(COUNTED, lines, count_limit=256)
    assert_sweeps(found, [0, 1, 2])
    assert notes == []


BOOTS = {
    "text": "\nets Jun  8 2016 00:22:57\r\n\r\nrst:0x1 (POWERON_RESET)\n",
    "a banner": "\nREADY\n",
    "a banner in a comment": "\n# READY\n",
    "a comment": "\r\n# hello\r\n",
    "a line end": "\n",
    "garbage": "\n\xf3\x80\n\x00",
}
"""What a device sends when it starts anew: each completes a number that was cut."""
NUMBERED = {"csv": COUNTED, "a sweep a line": ARRAYS.replace('sweep = "id"', 'count = "id"')}
NUMBERED["csv, a sweep a line"] = """
name = "rows"
format = "csv"
lines = "sweeps"
columns = ["n", "left[3]", "lx[3]", "bottom[3]", "bx[3]"]
frequencies = [1e3, 2e3, 4e3]
count = "n"
rate = 100
[[interface]]
name = "left"
real = "left"
imaginary = "lx"
[[interface]]
name = "bottom"
real = "bottom"
imaginary = "bx"
"""


def row(number, sweep):
    """One line of the format with arrays in CSV, written by hand."""
    Z = [[true_value(name, f, sweep) for f in own] for name, own in FREQUENCIES.items()]
    parts = [part for own in Z for part in (np.real(own), np.imag(own))]
    return ",".join([str(number), *(f"{part:.2f}" for part in np.concatenate(parts))])


def sent_by(name, first, sweeps):
    """What a device sends from its start on: sweeps of the numbers first, first + 1, ..."""
    numbers = range(first, first + sweeps)
    if name == "csv":
        lines = stream(*numbers)[:-1]
    else:
        line = array_line if name == "a sweep a line" else row
        lines = [line(k, number) for k, number in enumerate(numbers)]
    return "".join(f"{line}\n" for line in lines)


def kept(text, sent, checked=""):
    """Sweeps that are read from all that a device sent, up to the end of the stream."""
    line_format = LineFormat.model_validate({**inputs.tables(text), "checksum": checked})
    wanted = {name: np.array(own) for name, own in FREQUENCIES.items()}
    assembly = SweepAssembly(line_format, wanted, lambda kind, text: None)
    lines = LineCutter().feed(sent.encode("latin-1"), 0.0, 0.0)
    found = [*(assembly.feed(line.text) for line in lines), assembly.end()]
    return [sweep for sweep in found if sweep is not None]


def assert_sent(found, numbers):
    """Each sweep is one of these, in all its readings."""
    for sweep in found:
        number = round((sweep["left"][0].real - 1000) / 10)
        assert number in numbers
        for name, Z in whole(number).items():
            np.testing.assert_allclose(sweep[name], Z, rtol=1e-6)


@pytest.mark.parametrize("boot", BOOTS)
@pytest.mark.parametrize("name", NUMBERED)
def test_a_restart_anywhere_never_leaves_a_number_that_was_cut(name, boot):
    """The device restarts after any byte of two sweeps, or within the last line of the second."""
    before, after = sent_by(name, 1, 2), sent_by(name, 7, 4)
    cuts = range(1, len(before), 7 if name != "csv" else 1)
    for cut in sorted({*cuts, *range(len(before) - 12, len(before))}):
        found = kept(NUMBERED[name], before[:cut] + BOOTS[boot] + after)
        assert_sent(found, (1, 2, 7, 8, 9, 10))
        assert any(round(sweep["left"][0].real) == 1090 for sweep in found)


@pytest.mark.parametrize("name", NUMBERED)
def test_bytes_lost_from_one_line_to_another_never_join_two_readings(name):
    """Lines of the same length run together where bytes between them are lost."""
    lines = sent_by(name, 1, 3).splitlines()
    for first in range(len(lines) - 2):
        one, next_one = lines[first], lines[first + 1]
        for cut in range(1, min(len(one), len(next_one))):
            joined = [*lines[:first], one[:cut] + next_one[cut:], *lines[first + 2 :]]
            found = kept(NUMBERED[name], "".join(f"{line}\n" for line in joined))
            assert_sent(found, (1, 2, 3))


def test_the_last_sweep_of_a_stream_is_read_where_its_lines_show_their_end():
    """By a checksum or the brace of JSON; a line of CSV without a checksum shows nothing."""

    def signed(text):
        from rcskin.hardware.reader.line_format import checksum

        return "".join(f"{line}*{checksum(line, 'crc16'):04X}\n" for line in text.splitlines())

    counts = {
        (name, checked): len(kept(text, (signed if checked else str)(sent_by(name, 1, 2)), checked))
        for name, text in NUMBERED.items()
        for checked in ("", "crc16")
    }
    assert {key for key, count in counts.items() if count == 1} == {
        ("csv", ""),
        ("csv, a sweep a line", ""),
    }
    assert set(counts.values()) == {1, 2}


@pytest.mark.parametrize("ends", ["", "\n"])
@pytest.mark.parametrize("text", [COUNTED, COUNTED.replace('count = "n"\ntime = "t"\n', "")])
def test_a_number_that_is_cut_at_the_end_of_a_stream_is_not_kept(text, ends):
    sent = sent_by("csv", 1, 2)
    for cut in range(len(sent) - 9, len(sent)):
        found = kept(text, sent[:cut] + ends)
        assert_sent(found, (1,))
        assert len(found) <= 1


def array_line(number, sweep, khz=(1, 2, 4), spoil=lambda values: values):
    """One line of ARRAYS, written by hand."""
    parts = []
    for name, short in (("left", "a"), ("bottom", "b")):
        Z = [true_value(name, 1e3 * f, sweep) for f in khz]
        mag = ", ".join(f"{abs(z):.9e}" for z in Z)
        phi = ", ".join(f"{math.atan2(z.imag, z.real):.9f}" for z in spoil(Z))
        parts.append(f'"{short}": {{"mag": [{mag}], "phi": [{phi}]}}')
    return f'{{"id": {number}, "khz": {list(khz)}, {", ".join(parts)}}}'


def test_arrays_become_sweeps():
    lines = ["# hello", *(array_line(k, k) for k in range(4))]
    found, notes = assembled(ARRAYS, lines)
    assert len(found) == 2 and notes == []  # the first may be a part of one
    np.testing.assert_allclose(found[0]["bottom"], whole(1)["bottom"], rtol=1e-6)


@pytest.mark.parametrize(
    ("line", "kind"),
    [
        (array_line(1, 0, khz=(1, 2)), "incomplete sweeps"),
        (array_line(1, 0, khz=(1, 2, 4, 8)), "readings at other frequencies"),
        (array_line(1, 0, spoil=lambda Z: Z[:2]), "lines of a wrong length"),
        (array_line(1, 0).replace('"b"', '"c"'), "lines that are no readings"),
        (array_line(1, 0)[:-9], "lines that are no readings"),
        (array_line(1, 0).replace("[1, 2, 4]", "[1, 2, NaN]"), "readings out of range"),
        (array_line(1, 0).replace("[1, 2, 4]", "[1, 2, true]"), "lines that are no readings"),
        (array_line(1, 0).replace("[1, 2, 4]", '[1, 2, "4"]'), "lines that are no readings"),
        (array_line(1, 0).replace('"id": 1', '"id": 1.5'), "lines that are no readings"),
        ("[" * 100_000, "lines that are no readings"),
        ("17", "lines that are no readings"),
    ],
)
def test_a_wrong_array_costs_its_sweep(line, kind):
    rest = [array_line(number, number) for number in (2, 3, 4)]
    found, notes = assembled(ARRAYS, [array_line(0, 0), line, *rest])
    assert [round(sweep["left"][0].real) for sweep in found] == [1020, 1030]
    assert kind in notes


CHECKED = {
    "xor": ("1,2,3", "1,2,3*30"),
    "sum": ("1,2,3", "1,2,3*EE"),
    "crc16": ("123456789", "123456789*29B1"),
    "crc32": ("123456789", "123456789*CBF43926"),
}
"""Check values of CRC-16/CCITT-FALSE and CRC-32 from the catalogue of parametrised CRC algorithms;
xor: 31^2C^32^2C^33 = 30; sum: 31+2C+32+2C+33 = EE."""


@pytest.mark.parametrize("kind", CHECKED)
def test_a_checksum_is_that_of_the_literature(kind):
    from rcskin.hardware.reader.line_format import checksum

    body, line = CHECKED[kind]
    assert f"{body}*{checksum(body, kind):X}" == line


def test_a_wrong_checksum_costs_the_sweep():
    def signed(line):
        total = 0
        for character in line:
            total ^= ord(character)
        return f"{line}*{total:02X}"

    lines = [signed(line) for line in stream(0, 1)]
    assert_sweeps(assembled(COUNTED, lines, checksum="xor")[0], [0, 1])
    lines[2] = lines[2].replace("1000.0", "1000.1")
    found, notes = assembled(COUNTED, lines, checksum="xor")
    assert_sweeps(found, [1])
    assert "lines with a wrong checksum" in notes


def test_bytes_are_cut_into_lines_however_they_come():
    sent = b"one\r\ntwo\n\nthr\xffee\r\n" + b"x" * (3 * MAX_LINE) + b"\nfour\nfi"
    for step in (1_000_000, 50_000, 7):
        cutter, lines = LineCutter(), []
        for k in range(0, len(sent), step):
            lines += cutter.feed(sent[k : k + step], float(k), float(k))
        assert [line.text for line in lines] == ["one", "two", "thr?ee", None, "four"]


GAIN = """
name = "node"
format = "json"
quantity = "gain"
frequency = "f"
magnitude = "m"
rate = 10
"""


@pytest.mark.parametrize(
    ("keys", "line", "expected"),
    [
        ('unit = "share"', '{"f": 1000, "m": 0.25}', 0.25),
        ('unit = "V"\namplitude = 2.0', '{"f": 1000, "m": 0.5}', 0.25),
        ('unit = "bit"\nscale = 0.001\namplitude = 2.0', '{"f": 1000, "m": 500}', 0.25),
        ('unit = "share"\nphase = "p"', '{"f": 1000, "m": 0.25, "p": -90}', -0.25j),
        ('unit = "V"\namplitude = 1.0\nrange = [0.0, 3.2]', '{"f": 1000, "m": 3.3}', None),
        ('unit = "share"', '{"f": 1000, "m": -0.25}', None),
        ('unit = "share"', '{"f": 1000, "m": 0}', None),
    ],
)
def test_gains_follow_from_volts_bits_and_shares(keys, line, expected):
    found, notes = assembled(f"{GAIN}{keys}\n", [line, line], {"node": (1e3,)})
    if expected is None:
        assert (found, set(notes)) == ([], {"readings out of range"})
    else:
        np.testing.assert_allclose(found[0]["node"], [expected], atol=1e-12)

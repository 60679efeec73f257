"""Tables of other tools: which readings are one sweep, and which sweeps belong together.

Tables of gains from other tools.
"""

import numpy as np
import pytest
from rcskin.simulator.sweeps import InputError, read, write
from rcskin.simulator.sweeps.importing.grouping import Defaults
from rcskin.simulator.sweeps.imports import import_file, import_files
from rcskin.simulator.sweeps.reading_quantities import GAIN, MAGNITUDE, kind_of
from rcskin.simulator.sweeps.schema import complex_readings


@pytest.mark.parametrize("frequencies", ["121212", "212121", "122112"])
def test_a_sweep_begins_where_frequencies_start_over(table, frequencies):
    rows = [f"{f},{index + 1},-1" for index, f in enumerate(frequencies)]
    sweeps = table("f/Hz,R,X", *rows)
    assert dict(sweeps.sizes) == {"sweep": 3, "interface": 1, "frequency": 2}
    assert [set(Rs) for Rs in sweeps["Rs"].values[:, 0]] == [{1, 2}, {3, 4}, {5, 6}]


def test_labels_distinguish_sweeps_wherever_their_lines_stand(table):
    header = "row,column,repetition,session,f/Hz,R,X"
    rows = ["1,2,1,7,1,1,-1", "2,2,1,7,1,2,-1", "1,2,1,7,2,3,-1", "2,2,1,7,2,4,-1"]
    sweeps = table(header, *rows)
    assert sweeps["Rs"].values.tolist() == [[[1, 3]], [[2, 4]]]
    assert sweeps["press"].values.tolist() == ["1,2", "2,2"]
    assert sweeps["session"].values.tolist() == [7, 7]


def test_every_sweep_has_every_interface(table):
    rows = ["left,1,1,-1", "left,2,2,-1", "top,1,3,-1", "top,2,4,-1", "left,1,5,-1"]
    more = ["left,2,6,-1", "top,1,7,-1", "top,2,8,-1"]
    sweeps = table("interface,f/Hz,R,X", *rows, *more)
    assert sweeps["interface"].values.tolist() == ["left", "top"]
    assert sweeps["Rs"].values.tolist() == [[[1, 2], [3, 4]], [[5, 6], [7, 8]]]


@pytest.mark.parametrize(
    ("press", "pixel"),
    [
        ("none", (0, 0)),
        ("2,3", (2, 3)),
        ("2,3:1.5", (2, 3)),
        ("1,1+2,2", (-1, -1)),
        ("x", (-1, -1)),
    ],
)
def test_the_pixel_of_a_press_is_read_from_its_text(table, press, pixel):
    sweeps = table("f/Hz,R,X", "1,1,-1", press=press)
    assert sweeps["press"].item() == press
    assert (sweeps["row"].item(), sweeps["column"].item()) == pixel


def test_files_are_joined_at_the_frequencies_of_the_first(tmp_path):
    paths = [tmp_path / "a.csv", tmp_path / "b.csv"]
    paths[0].write_text("f/Hz,R,X\n1000.0001,1,-1\n2000,2,-1")
    paths[1].write_text("f/kHz,R,X\n1,3,-1\n2,4,-1")
    joined = import_files(paths, [Defaults("none"), Defaults("1,1", session=2)])
    assert joined["frequency"].values.tolist() == [1000.0001, 2000]
    assert joined["Rs"].values.tolist() == [[[1, 2]], [[3, 4]]]
    assert joined["session"].values.tolist() == [0, 2]
    assert joined.attrs["source"] == "a.csv; b.csv"


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("f/Hz,R,X\n1,1,-1\n3,1,-1", "2 from 1 to 3 Hz are not the frequencies of"),
        ("f/Hz,R,X\n1,1,-1", "1 from 1 to 1 Hz are not the frequencies of"),
        ("interface,f/Hz,R,X\na,1,1,-1\na,2,1,-1", "interfaces a are not those of"),
    ],
)
def test_files_that_do_not_fit_together_are_reported(tmp_path, text, told):
    paths = [tmp_path / "a.csv", tmp_path / "b.csv"]
    paths[0].write_text("f/Hz,R,X\n1,1,-1\n2,1,-1")
    paths[1].write_text(text)
    with pytest.raises(InputError) as error:
        import_files(paths, [Defaults()] * 2)
    assert str(error.value).startswith(f"{paths[1]}: ")
    assert told in str(error.value)
    assert str(paths[0]) in str(error.value)


@pytest.mark.parametrize("order", [1, -1])
@pytest.mark.parametrize("off", [5e-7, 2e-5, 5e-4, -5e-4])
def test_sweeps_of_nearly_the_same_frequencies(table, order, off):
    rows = [f"{f:.9g},{f},-1" for f in (100, 200, 500, 1000)]
    more = [f"{f * (1 + off):.9g},{f},-1" for f in (100, 200, 500, 1000)]
    sweeps = table("f/Hz,R,X", *rows, *more[::order])
    assert sweeps["frequency"].values.tolist() == [100, 200, 500, 1000]
    assert sweeps["Rs"].values.tolist() == [[[100, 200, 500, 1000]]] * 2
    assert ("warnings" in sweeps.attrs) == (abs(off) > 1e-6)


def test_a_fine_grid_is_no_jitter(table):
    sweeps = table("f/Hz,R,X", *(f"{1e5 + f},1,-1" for f in range(5)))
    assert sweeps.sizes["frequency"] == 5 and "warnings" not in sweeps.attrs


SPECTRUM = [(1e5, "1,-5"), (3e4, "5,-14"), (1e4, "25,-23"), (3e3, "44,-12"), (1e3, "47,-4")]


@pytest.mark.parametrize("ends", [[2], [3], [2, 3]])
@pytest.mark.parametrize("overlap", [0, 1])
@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("label", [None, "Loop", "Sweep Number", "Cycle"])
def test_segments_of_one_spectrum_may_overlap(table, ends, overlap, direction, label):
    readings = SPECTRUM[::direction]
    starts = [0, *(end - overlap for end in ends)]
    parts = [
        [f"{f:.9g},{z}" for f, z in readings[start : end + 1]]
        for start, end in zip(starts, [*ends, len(readings)], strict=True)
    ]
    parts = [*parts, *parts]
    marked = [[f"{n},{row}" if label else row for row in part] for n, part in enumerate(parts, 1)]
    header = f"{label},f,R,X" if label else "f,R,X"
    sweeps = table(header, *(row for part in marked for row in part))
    assert sweeps.sizes["sweep"] == 2 and sweeps["frequency"].values.tolist() == sorted(
        f for f, _ in SPECTRUM
    )
    assert sweeps["Rs"].values[:, 0].tolist() == [[47, 44, 25, 5, 1]] * 2
    assert "which is kept: segments of one spectrum" in sweeps.attrs["left_out"]
    assert ("though" in sweeps.attrs.get("warnings", "")) == (label in ("Sweep Number", "Cycle"))


def test_the_first_reading_of_two_segments_is_kept_and_the_difference_named(table):
    sweeps = table("f,R,X", "1,4,-3", "2,3,-4", "2,3.03,-4.04", "3,2,-4")
    assert sweeps["Rs"].values.ravel().tolist() == [4, 3, 2]
    assert sweeps.attrs["left_out"] == (
        "line 4 (once more 2 Hz of line 3, which is kept: segments of one spectrum, 1 % apart)"
    )
    failed = table("f,R,X", "1,4,-3", "2,OL,-4", "2,3,-4", "3,2,-4")
    assert failed["Rs"].values.ravel().tolist() == [4, 3, 2]


def test_segments_without_a_common_frequency_are_one_spectrum(table):
    sweeps = table("f,R,X", *(f"{f},1,-1" for f in (8, 6, 4, 2, 3, 1.5, 1)))
    assert sweeps["frequency"].values.tolist() == [1, 1.5, 2, 3, 4, 6, 8]


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        (["1,4,-3", "2,3,-4", "2,6,-8", "3,2,-4"], "line 4: goes on with a spectrum from 2 Hz"),
        (["1,4,-3", "2,3,-4", "1,4,-3", "2,3,-4", "3,2,-4"], "line 4: the sweep from here on has"),
        (["1,4,-3", "2,3,-4", "3,1,-1", "2,3,-4", "1,2,-4"], "line 5: the sweep from here on has"),
    ],
)
def test_other_repeated_frequencies_begin_a_sweep(refusal, rows, message):
    assert message in refusal("f,R,X", *rows)


def test_segments_that_label_other_presses_are_not_joined(refusal):
    rows = ["press,f,R,X", "a,1,4,-3", "a,2,3,-4", "b,2,3,-4", "b,3,2,-4"]
    assert "line 4: the sweep from here on has 2" in refusal(*rows)


F = np.array([1e3, 2e3, 5e3])
G = np.array([0.95 * np.exp(-0.1j), 0.8 * np.exp(-0.5j), 0.4 * np.exp(-1.1j)], np.complex128)


@pytest.fixture
def gain_table(tmp_path):
    def gain_table(header, *columns):
        path = tmp_path / "gains.csv"
        rows = (",".join(f"{each:.9g}" for each in row) for row in zip(*columns, strict=True))
        path.write_text("\n".join([header, *rows]) + "\n")
        return path

    return gain_table


DEGREES, LEVEL = np.degrees(np.angle(G)), 20 * np.log10(np.abs(G))


@pytest.mark.parametrize(
    ("header", "columns"),
    [
        ("f/Hz,gain,gain phase (deg)", (F, np.abs(G), DEGREES)),
        ("f (kHz),Gain [dB],Phase [rad]", (F / 1e3, LEVEL, np.angle(G))),
        ("Frequency (Hz),Magnitude (dB),Phase (deg)", (F, LEVEL, DEGREES)),
        ("f,|Vout/Vin| (%),phase (deg)", (F, 100 * np.abs(G), DEGREES)),
        ("f,Re(gain),Im(gain)", (F, G.real, G.imag)),
        ("f,Re(gain),-Im(gain),gain,gain (dB)", (F, G.real, -G.imag, np.abs(G), LEVEL)),
    ],
)
def test_a_complex_gain_is_read_in_all_its_forms(gain_table, header, columns):
    sweeps = import_file(gain_table(header, *columns))
    assert kind_of(sweeps.variables) is GAIN
    np.testing.assert_allclose(complex_readings(sweeps)[0, 0], G, rtol=1e-8)
    assert "warnings" not in sweeps.attrs


@pytest.mark.parametrize(("name", "values"), [("gain", np.abs(G)), ("gain (dB)", LEVEL)])
def test_a_magnitude_alone_has_no_phase(gain_table, name, values):
    sweeps = import_file(gain_table(f"f,{name}", F, values))
    assert kind_of(sweeps.variables) is MAGNITUDE
    np.testing.assert_allclose(sweeps["gain"][0, 0], np.abs(G), rtol=1e-8)


def test_a_file_of_gains_in_our_own_form_is_imported_to_the_same_bits(gain_table, tmp_path):
    sweeps = import_file(gain_table("f,Re(gain),Im(gain)", F, G.real, G.imag))
    write(sweeps, tmp_path / "own.csv")
    again = import_file(tmp_path / "own.csv")
    for name in GAIN.names:
        np.testing.assert_array_equal(again[name], read(tmp_path / "own.csv")[name])


def test_what_was_taken_is_said(gain_table):
    path = gain_table("f,gain (dB),phase (deg),gain", F, LEVEL, DEGREES, np.abs(G))
    assert import_file(path).attrs["columns"] == (
        "header in line 1: frequency from `f`, gain from `gain`, phase from `phase (deg)`; "
        "`gain (dB)` agrees"
    )
    beside = gain_table("f,Rs,X,gain", F, F, -F, np.abs(G))
    assert import_file(beside).attrs["columns"].endswith("X from `X`; not used: `gain`")


def test_an_amplifying_gain_is_warned_about(gain_table):
    warnings = import_file(gain_table("f,gain", F, [0.5, 1.2, 0.4])).attrs["warnings"]
    assert warnings.startswith("|V / V_s| > 1 in 1 of 3 readings, the first in line 3")


@pytest.mark.parametrize(
    ("header", "columns", "refusal"),
    [
        ("f,gain", (F, [0.5, 0.0, 0.4]), "line 3: the gain is 0, which no reading is"),
        ("f,gain", (F, [0.5, -0.3, 0.4]), r"line 3: \|V / V_s\| must be >= 0 \(`gain`\)"),
        ("f,gain,gain phase (deg)", (F, [1, 1, 1], [0, -200, 0]), "line 3: the phase .* beyond"),
        ("f,gain,gain phase", (F, [1, 1, 1], [0, -0.2, 0]), "`gain phase` must be in deg or rad"),
        ("f,gain [V]", (F, [1, 1, 1]), r"column `gain \[V\]` must be in V/V, % or dB, got 'V'"),
        (
            "f,gain,gain (dB)",
            (F, np.abs(G), LEVEL + [0, 0, 2]),
            r"line 4: `gain \(dB\)` does not follow from `gain`: it is .* where it gives -7.95",
        ),
    ],
)
def test_gains_that_cannot_be_are_refused(gain_table, header, columns, refusal):
    with pytest.raises(InputError, match=refusal):
        import_file(gain_table(header, *columns))


def test_columns_named_by_the_user_may_hold_gains(gain_table):
    path = gain_table("1,2,3", F, np.abs(G), DEGREES)
    named = "f,gain,phase (deg)"
    np.testing.assert_allclose(complex_readings(import_file(path, columns=named))[0, 0, -1], G[-1])

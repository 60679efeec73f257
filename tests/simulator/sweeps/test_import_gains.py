"""Tables of gains from other tools."""

import numpy as np
import pytest
from rcskin.simulator.sweeps import InputError, read, write
from rcskin.simulator.sweeps.imports import import_file
from rcskin.simulator.sweeps.reading_quantities import GAIN, MAGNITUDE, kind_of
from rcskin.simulator.sweeps.schema import complex_readings

F = np.array([1e3, 2e3, 5e3])
G = np.array([0.95 * np.exp(-0.1j), 0.8 * np.exp(-0.5j), 0.4 * np.exp(-1.1j)], np.complex128)


@pytest.fixture
def table(tmp_path):
    def table(header, *columns):
        path = tmp_path / "gains.csv"
        rows = (",".join(f"{each:.9g}" for each in row) for row in zip(*columns, strict=True))
        path.write_text("\n".join([header, *rows]) + "\n")
        return path

    return table


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
def test_a_complex_gain_is_read_in_all_its_forms(table, header, columns):
    sweeps = import_file(table(header, *columns))
    assert kind_of(sweeps.variables) is GAIN
    np.testing.assert_allclose(complex_readings(sweeps)[0, 0], G, rtol=1e-8)
    assert "warnings" not in sweeps.attrs


@pytest.mark.parametrize(("name", "values"), [("gain", np.abs(G)), ("gain (dB)", LEVEL)])
def test_a_magnitude_alone_has_no_phase(table, name, values):
    sweeps = import_file(table(f"f,{name}", F, values))
    assert kind_of(sweeps.variables) is MAGNITUDE
    np.testing.assert_allclose(sweeps["gain"][0, 0], np.abs(G), rtol=1e-8)


def test_a_file_of_gains_in_our_own_form_is_imported_to_the_same_bits(table, tmp_path):
    sweeps = import_file(table("f,Re(gain),Im(gain)", F, G.real, G.imag))
    write(sweeps, tmp_path / "own.csv")
    again = import_file(tmp_path / "own.csv")
    for name in GAIN.names:
        np.testing.assert_array_equal(again[name], read(tmp_path / "own.csv")[name])


def test_what_was_taken_is_said(table):
    path = table("f,gain (dB),phase (deg),gain", F, LEVEL, DEGREES, np.abs(G))
    assert import_file(path).attrs["columns"] == (
        "header in line 1: frequency from `f`, gain from `gain`, phase from `phase (deg)`; "
        "`gain (dB)` agrees"
    )
    beside = table("f,Rs,X,gain", F, F, -F, np.abs(G))
    assert import_file(beside).attrs["columns"].endswith("X from `X`; not used: `gain`")


def test_an_amplifying_gain_is_warned_about(table):
    warnings = import_file(table("f,gain", F, [0.5, 1.2, 0.4])).attrs["warnings"]
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
def test_gains_that_cannot_be_are_refused(table, header, columns, refusal):
    with pytest.raises(InputError, match=refusal):
        import_file(table(header, *columns))


def test_columns_named_by_the_user_may_hold_gains(table):
    path = table("1,2,3", F, np.abs(G), DEGREES)
    named = "f,gain,phase (deg)"
    np.testing.assert_allclose(complex_readings(import_file(path, columns=named))[0, 0, -1], G[-1])

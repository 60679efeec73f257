"""Readings of every kind, from the meter to journal and file: none gets a number that it lacks."""

import json

import numpy as np
import pytest
from rcskin.hardware.meter.meter_reading import MeterReading, ReadingStatus
from rcskin.hardware.record.measured_sweep import InterfaceTrace, MeasuredSweep
from rcskin.hardware.record.recorder import record
from rcskin.hardware.record.recording_journal import (
    JournalEntry,
    RecordingHeader,
    RecordingJournal,
    recording_dataset,
)
from rcskin.hardware.virtual.served_skin import VIRTUAL_MODELS
from rcskin.simulator.sweeps import InputError, parallel_capacitance
from rcskin.simulator.sweeps.digests import sealed_json, unsealed_json
from rcskin.simulator.sweeps.reading_quantities import GAIN, IMPEDANCE, MAGNITUDE
from rcskin.tests.hardware.pillow import Pillow

FREQUENCIES = (1e3, 4e3)
AT = "2026-01-01T00:00:00.000+00:00"
HEADER = RecordingHeader(
    "", "", ("left",), FREQUENCIES, 2, 2, ("none",), {}, "HIOKI,IM3523,1", {}, AT, "one"
)
READINGS = {
    "shown by the meter": (
        MeterReading(1e4 - 2e4j, shown={"Cp": 3.18310e-9}),
        MeterReading(1e4 - 1e4j, ReadingStatus.OUTSIDE_GUARANTEE, shown={"Cp": 1.98944e-9}),
    ),
    "gain": (MeterReading(0.9 - 0.1j, kind=GAIN), MeterReading(0.5 - 0.4j, kind=GAIN)),
    "magnitude": (MeterReading(0.9 + 0j, kind=MAGNITUDE), MeterReading(0.5 + 0j, kind=MAGNITUDE)),
}


def entry_of(readings):
    trace = InterfaceTrace(FREQUENCIES, readings, "left", AT, AT)
    return JournalEntry("none", MeasuredSweep((trace,)), AT, AT)


@pytest.fixture
def journal(tmp_path):
    journal = RecordingJournal(tmp_path / "run.nc")
    journal.begin(HEADER)
    return journal


@pytest.mark.parametrize("readings", READINGS.values(), ids=READINGS)
def test_a_stopped_recording_continues_with_the_readings_that_it_had(journal, readings):
    journal.keep(0, entry_of(readings))
    assert journal.entries(HEADER) == {0: entry_of(readings)}
    before, after = (
        recording_dataset(HEADER, [entry])
        for entry in (entry_of(readings), journal.entries(HEADER)[0])
    )
    assert before.identical(after)
    assert set(before.data_vars) == set(readings[0].kind.names)


@pytest.mark.parametrize("readings", READINGS.values(), ids=READINGS)
def test_the_keys_of_a_sweep_in_a_journal_are_fixed(journal, readings):
    journal.keep(0, entry_of(readings))
    content = json.loads((journal.folder / "000000.json").read_text())
    (trace,) = content["sweep"]["traces"]
    kind = [] if readings[0].kind is IMPEDANCE else ["kind"]
    assert list(trace) == ["Cp", "Rs", "X", "status", "interface", "begun", "ended", *kind]
    assert [complex(*pair) for pair in zip(trace["Rs"], trace["X"], strict=True)] == [
        each.value for each in readings
    ]


@pytest.mark.parametrize(
    "damage",
    [
        {"kind": "impedence"},
        {"status": [0, 99]},
        {"Rs": [1e4]},
        {"Rs": [1e4, "1e4"]},
        {"interface": "top"},
        {"Cp": [1e-9], "Rs": [1e4], "X": [-1e4], "status": [0]},
        {"extra": 1},
    ],
    ids=str,
)
def test_a_sweep_of_a_journal_that_makes_no_sense_is_refused_in_one_line(journal, damage):
    journal.keep(0, entry_of(READINGS["shown by the meter"]))
    path = journal.folder / "000000.json"
    content = unsealed_json(path.read_text())
    content["sweep"]["traces"][0] |= damage
    path.write_text(sealed_json(content))
    with pytest.raises(InputError, match="is no part of a recording") as refusal:
        journal.entries(HEADER)
    assert "\n" not in str(refusal.value) and "000000.json" in str(refusal.value)


class Fractional(Pillow):
    """A pillow whose impedance has more digits than a meter shows."""

    def impedance(self, press, frequency):
        return super().impedance(press, frequency) * 1.0312345678


@pytest.mark.parametrize("model", VIRTUAL_MODELS)
class TestRecordedBy:
    """A recording by each model of virtual meter."""

    @pytest.fixture
    def instrument(self, make_instrument, model):
        return make_instrument(Fractional(), kind=VIRTUAL_MODELS[model])

    def test_the_file_has_the_digits_that_the_meter_shows(self, task, operator, model):
        """A Hioki shows Cp beside Rs and X, each to six digits; for others it follows from them."""
        sweeps = recording_dataset(*record(task, operator))
        Z, Cp = sweeps["Rs"].values + 1j * sweeps["X"].values, sweeps["Cp"].values
        follows = parallel_capacitance(Z, sweeps["frequency"].values)
        np.testing.assert_allclose(Cp, follows, rtol=2e-5)
        if model.startswith("IM"):
            assert (Cp != follows).any()
            assert Cp.ravel().tolist() == [float(f"{each:.6g}") for each in Cp.ravel()]
        else:
            assert (Cp == follows).all()

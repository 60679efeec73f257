"""The driver against the virtual meter, over TCP: every setting, readings, corrections."""

import math
import re

import pytest
from rcskin.hardware.meter.errors import (
    CorrectionError,
    FailedReadingError,
    NoConnectionError,
    RefusedError,
    RestartedError,
)
from rcskin.hardware.meter.instruments import open_meter, probe
from rcskin.hardware.meter.lcr_meter import correct, require_settings, restore_settings
from rcskin.hardware.meter.meter_reading import ReadingStatus, parse_reading
from rcskin.hardware.record.measured_sweep import check_frequencies, measure_sweep
from rcskin.simulator.sweeps import InputError, parallel_capacitance


def test_a_reading_is_the_skin_to_six_digits(meter, pillow):
    for frequency in (40.0, 1e3, 2e5):
        meter.frequency = frequency
        Z, reading = pillow.impedance("none", frequency), meter.read()
        assert reading.value.real == pytest.approx(Z.real, rel=5.1e-6)
        assert reading.value.imag == pytest.approx(Z.imag, rel=5.1e-6)
        assert reading.shown["Cp"] == pytest.approx(parallel_capacitance(Z, frequency), rel=5.1e-6)


def test_internal_trigger_gives_stale_values_until_it_has_had_its_time(make_instrument, say):
    slow = make_instrument(pace=1.0)
    setting = ":MEAS:ITEM 0,2;VALid 2;:FREQ 1E3;:RANG:SYNC:SPEEd ALL,FAST"
    first, waited, stale = say(
        f"{setting};*WAI;:MEAS?",
        ":MEAS:ITEM 0,16;:FREQ 2E3;*WAI;:MEAS?",
        ":FREQ 4E3;:MEAS?",
        to=slow,
    )
    assert first != waited == stale
    assert float(stale) == pytest.approx(-1 / (2 * math.pi * 2e3 * 1e-9), rel=1e-5)


def test_before_any_measurement_there_is_no_number(meter):
    with pytest.raises(FailedReadingError, match="status 1: nothing was measured"):
        meter.talk.query(":MEASure?", parse_reading)


@pytest.mark.parametrize(("range_number", "code"), [(3, 7), (10, 2), (8, 0)])
def test_ranges_end_in_overflow_or_lose_their_guarantee(meter, range_number, code):
    meter.range = range_number
    if code == 7:
        with pytest.raises(FailedReadingError, match="status 7: overflow"):
            meter.read()
    else:
        assert meter.read().status.code == code


def test_a_weak_signal_is_outside_guaranteed_accuracy(meter):
    meter.voltage = 0.005
    assert meter.read().status is ReadingStatus.OUTSIDE_GUARANTEE


def test_automatic_range_finds_the_range_of_the_skin(meter):
    meter.frequency = 1e3
    meter.read()
    assert meter.range == 8
    meter.frequency = 1e5
    meter.read()
    assert meter.range == 7
    assert meter.auto_range


@pytest.mark.parametrize(
    ("answer", "told"),
    [
        (lambda: 1 / 0, "division by zero"),
        (lambda: complex("nan"), "impedance is .*nan.* at 1000 Hz"),
    ],
)
def test_a_skin_that_has_no_answer_fails_inside_the_meter(
    make_instrument, serve, pillow, answer, told
):
    """Nothing that the mains or a lower speed could mend; the server tells why."""

    class Broken(type(pillow)):
        def impedance(self, press, frequency):
            return answer()

    heard = []
    with serve(make_instrument(Broken(), report_failure=heard.append)) as ports:
        with open_meter(ports.resource, 1) as meter:
            with pytest.raises(RefusedError, match="failed inside the meter"):
                meter.read()
    assert re.search(f"press none: no reading: .*{told}", heard[0])


def test_measuring_takes_its_time_by_speed_averaging_and_delay(make_instrument):
    from rcskin.simulator.meters.accuracy_table import ReadingConditions

    seconds = [
        ReadingConditions(1e4, 5, speed).seconds for speed in ("FAST", "MEDIUM", "SLOW", "SLOW2")
    ]
    assert seconds == sorted(set(seconds))
    assert ReadingConditions(1e4, 5, averaging=8).seconds == 8 * ReadingConditions(1e4, 5).seconds
    assert ReadingConditions(40, 5, "FAST").seconds == 1 / 40


@pytest.mark.parametrize(
    ("kind", "report"), [("open", "open_correction"), ("short", "short_correction")]
)
def test_corrections_are_acquired_and_ended(meter, kind, report):
    correct(meter, kind, "ALL", interval=0.001)
    assert getattr(meter, report) == "ALL"
    correct(meter, kind, "SPOT", interval=0.001)
    assert getattr(meter, report) == "SPOT"
    correct(meter, kind, "OFF")
    assert getattr(meter, report) == "OFF"


def test_a_correction_states_how_long_it_has_taken(instrument, meter):
    instrument.pace = 0.01
    seen = []
    correct(meter, "open", progress=seen.append, interval=0.005)
    assert seen and seen == sorted(seen)


def test_a_correction_that_never_ends_is_cancelled_with_advice(instrument, meter):
    instrument.pace = 10.0
    with pytest.raises(CorrectionError, match="did not end.*leads are apart"):
        correct(meter, "open", interval=0.001, patience=0.02)
    instrument.pace = 0.0
    correct(meter, "open", interval=0.001)
    assert meter.open_correction == "ALL"


def test_settings_are_restored_from_a_snapshot(meter):
    meter.apply_settings({"speed": "SLOW", "range": 5, "averaging": 4, "voltage": 0.5})
    kept = meter.snapshot()
    meter.talk.send("*RST")
    with pytest.raises(RestartedError, match="`voltage` is 1.0 and was 0.5"):
        require_settings(meter, kept)
    restore_settings(meter, kept)
    require_settings(meter, kept)
    assert meter.range == 5


def test_a_lost_correction_cannot_be_restored(meter):
    correct(meter, "open", interval=0.001)
    kept = meter.snapshot()
    correct(meter, "open", "OFF")
    with pytest.raises(CorrectionError, match="open correction was ALL.*is OFF now"):
        restore_settings(meter, kept)


def test_a_sweep_is_a_reading_at_each_frequency(meter, pillow):
    frequencies, seen = (1e3, 12345.678, 2e5), []
    watch = lambda f, reading: seen.append((f, reading.value))  # noqa: E731
    sweep = measure_sweep(meter, {"left": frequencies}, watch=watch)
    assert [f for f, _ in seen] == list(frequencies)
    exact = [pillow.impedance("none", f) for f in frequencies]
    assert sweep.traces[0].Z == pytest.approx(exact, rel=1e-4)


def test_frequencies_out_of_reach_are_reported_before_anything_is_measured(meter):
    with pytest.raises(InputError, match="meter IM3523 reads 40 Hz to 200 kHz; 20 Hz is outside"):
        check_frequencies(meter, (1e3, 20.0))


def test_what_answers_is_identified(ports):
    assert probe(ports.resource, 1, 9600).identity.model == "IM3523"


def test_nothing_behind_an_address_is_reported_with_what_to_check():
    silent = probe("TCPIP0::127.0.0.1::1::SOCKET", 0.3, 9600)
    assert silent.identity is None
    assert "check the cable" in silent.failure


@pytest.mark.parametrize(
    ("resource", "error", "told"),
    [
        ("nonsense", InputError, "'nonsense' is no VISA resource; examples: TCPIP0"),
        ("TCPIP0::127.0.0.1::1::SOCKET", NoConnectionError, "check"),
        ("ASRL/dev/absent::INSTR", NoConnectionError, "cannot be opened .* check the address"),
    ],
)
def test_a_meter_that_cannot_be_opened_is_reported_in_one_line(resource, error, told):
    with pytest.raises(error, match=told) as raised:
        open_meter(resource, 0.3)
    assert "\n" not in str(raised.value)


@pytest.mark.parametrize(("timeout", "baud"), [(0, 9600), (float("nan"), 9600), (1, 1200)])
def test_lines_out_of_range_are_refused(timeout, baud):
    with pytest.raises(InputError, match="`(timeout|baud)` must be"):
        open_meter("ASRL/dev/absent::INSTR", timeout, baud)


@pytest.mark.parametrize("model", ["IM3533", "IM3536", "IM3570"])
def test_siblings_speak_their_dialect(make_instrument, serve, model):
    with serve(make_instrument(model=model)) as ports, open_meter(ports.resource, 1) as meter:
        meter.speed, meter.averaging, meter.trigger_delay = "SLOW", 4, 0.5
        assert (meter.speed, meter.averaging, meter.trigger_delay) == ("SLOW", 4, 0.5)
        meter.trigger_delay = 0.0
        assert meter.read().value.real == pytest.approx(10e3)
        assert meter.model == model


def test_a_slow_reading_is_waited_for(make_instrument, serve):
    """Thirty-two averages at SLOW2 take longer than the time-out, here at a twentieth of it."""
    instrument = make_instrument(pace=0.05)
    with serve(instrument) as ports, open_meter(ports.resource, 0.1) as meter:
        meter.speed, meter.averaging = "SLOW2", 32
        assert meter.seconds == pytest.approx(6.4)
        assert meter.read().value.real == pytest.approx(10e3)

"""Whatever a meter does wrong: the driver says so, and never takes a number for another."""

import random
from contextlib import suppress

import numpy as np
import pytest
from rcskin.hardware.control_client import send_request
from rcskin.hardware.meter.correction import correct
from rcskin.hardware.meter.errors import (
    FailedReadingError,
    GarbledError,
    LostConnectionError,
    MeterError,
    NoAnswerError,
    RestartedError,
)
from rcskin.hardware.meter.instruments import INSTRUMENTS, open_meter
from rcskin.hardware.meter.meter_reading import ReadingStatus
from rcskin.hardware.record.measured_sweep import check_frequencies
from rcskin.hardware.virtual.faults import Fault
from rcskin.hardware.virtual.served_skin import instrument as instrument_of
from rcskin.hardware.virtual.served_skin import simulated
from rcskin.hardware.virtual.virtual_models import VIRTUAL_MODELS
from rcskin.simulator.sweeps import InputError

INSTRUMENTS_SERVED = [model for model in VIRTUAL_MODELS if model in INSTRUMENTS]
WAIT = 0.2
"""Time-out of the driver, s."""
EVERYWHERE = [
    ({"kind": "silent"}, NoAnswerError, "no whole answer within 0.2 s; check"),
    ({"kind": "half"}, NoAnswerError, "no whole answer within 0.2 s; check"),
    ({"kind": "garbage"}, GarbledError, "no line of text; check the baud rate"),
    ({"kind": "late", "seconds": 0.3}, NoAnswerError, "the time-out is long enough"),
    ({"kind": "forget"}, RestartedError, "settings and corrections are lost"),
]
OF_ONE = [
    ("IM3523", {"kind": "status"}, FailedReadingError, "status 7: overflow: check the leads"),
    ("IM3523", {"kind": "status", "status": -7}, FailedReadingError, "status -7: underflow"),
    (
        "IM3523",
        {"kind": "status", "status": 1},
        FailedReadingError,
        "status 1: nothing was measured",
    ),
    ("IM3523", {"kind": "status", "status": 9}, FailedReadingError, "status 9: sampling error"),
    ("IM3523", {"kind": "status", "status": 14}, FailedReadingError, "status 14: contact error"),
    ("E4980A", {"kind": "status"}, FailedReadingError, "status 1: overload: check the leads"),
    ("E4990A", {"kind": "status"}, FailedReadingError, "which stand for no reading"),
]


@pytest.mark.parametrize(
    ("model", "fault", "error", "told"),
    [*OF_ONE, *((model, *row) for model in INSTRUMENTS_SERVED for row in EVERYWHERE)],
)
def test_a_fault_is_reported_and_the_next_readings_are_right_again(
    make_instrument, serve, pillow, model, fault, error, told
):
    instrument = make_instrument(kind=VIRTUAL_MODELS[model])
    with serve(instrument) as ports, open_meter(ports.resource, WAIT) as meter:
        instrument.faults.add(Fault(**fault))
        with pytest.raises(error, match=told) as raised:
            meter.read_at(1e3)
        assert "\n" not in str(raised.value)
        meter.prepare()
        for frequency in (2e3, 5e4):
            reading = meter.read_at(frequency)
            assert reading.value.imag == pytest.approx(
                pillow.impedance("none", frequency).imag, rel=1e-5
            )
            assert reading.status is ReadingStatus.NORMAL


def test_a_dropped_connection_is_lost_and_a_new_one_works(instrument, ports, meter):
    instrument.faults.add(Fault("drop"))
    with pytest.raises(MeterError, match="check"):
        meter.read()
    with pytest.raises(LostConnectionError, match="connect again"):
        meter.read()
    with open_meter(ports.resource, 1) as again:
        assert again.read().status is ReadingStatus.NORMAL


def test_a_meter_that_stays_silent_is_let_go(instrument, meter):
    instrument.faults.add(Fault("silent", times=5))
    with pytest.raises(NoAnswerError):
        meter.read()
    with pytest.raises(LostConnectionError, match="connect again"):
        meter.read()


@pytest.mark.parametrize("kind", ["silent", "half", "garbage", "drop"])
def test_a_fault_while_connecting_is_an_error_too(instrument, ports, kind):
    instrument.faults.add(Fault(kind, times=3))
    with pytest.raises(MeterError):
        open_meter(ports.resource, 0.1)


def test_settings_lost_within_a_sweep_are_noticed_at_the_next_word(instrument, meter):
    meter.speed = "SLOW2"
    instrument.faults.add(Fault("forget"))
    with pytest.raises(RestartedError, match="check its power"):
        meter.frequency = 2e3


def test_faults_are_asked_for_through_the_side_door(ports, meter):
    send_request(f"127.0.0.1:{ports.control}", "misbehave", kind="status", times=2, status=12)
    for _ in range(2):
        with pytest.raises(FailedReadingError, match="status 12"):
            meter.read()
    assert meter.read().status is ReadingStatus.NORMAL


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"kind": "sing"}, "`kind` must be one of drop, late"),
        ({"kind": "late", "seconds": -1}, "`seconds` must be in"),
        ({"kind": "drop", "times": 0}, "`times` must be a whole number in"),
        ({"kind": "drop", "times": 1.5}, "`times` must be a whole number in 1..1000000, got 1.5"),
        ({"kind": "drop", "times": True}, "`times` must be a whole number"),
        ({"kind": "late", "seconds": "1"}, "`seconds` must be in"),
        ({"kind": "status", "status": 2}, "`status` must be 1, 7"),
    ],
)
def test_misbehaviour_out_of_range_is_refused(ports, given, told):
    with pytest.raises(InputError, match=told):
        send_request(f"127.0.0.1:{ports.control}", "misbehave", **given)


@pytest.mark.parametrize("frequencies", [(1e3, 3e5), (39.9, 1e3), (1e-3, 8e6)])
def test_a_scene_is_served_at_the_frequencies_that_are_recorded(scene, meter, frequencies):
    with pytest.raises(InputError, match="IM3523 reads 40 Hz to 200 kHz; .* outside"):
        setup = scene.parts.setup.taking(np.array(frequencies))
        instrument_of(simulated(scene.parts.read(setup)))
    with pytest.raises(InputError, match="IM3523 reads 40 Hz to 200 kHz; .* outside"):
        check_frequencies(meter, frequencies)


def _attempt(meter, pillow, dice):
    """One random action of the driver; what it reads is right, or it raises an error of its own."""
    frequencies = {"one": [2e3], "sweep": [1e3, 2e3, 5e3]}.get(dice.choice(["one", "sweep", ""]))
    try:
        if frequencies is None:
            correct(meter, "open", dice.choice(meter.extents))
            return
        found = meter.read_sweep(frequencies)
    except (MeterError, InputError) as error:
        assert "\n" not in str(error)
        with suppress(MeterError):
            meter.prepare()
        return
    expected = [pillow.impedance("none", frequency) for frequency in frequencies]
    assert [each.value for each in found] == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize("model", INSTRUMENTS_SERVED)
def test_random_faults_never_become_numbers(make_instrument, serve, pillow, model):
    dice = random.Random(1)
    instrument = make_instrument(kind=VIRTUAL_MODELS[model])
    kinds = ("silent", "half", "garbage", "late", "status", "forget", "correction")
    with serve(instrument) as ports:
        for _ in range(2):
            with open_meter(ports.resource, WAIT) as meter:
                for _ in range(6):
                    if dice.random() < 0.6:
                        instrument.faults.add(Fault(dice.choice(kinds), seconds=0.3))
                    _attempt(meter, pillow, dice)
                instrument.faults.waiting.clear()

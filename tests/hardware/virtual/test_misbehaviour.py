"""Whatever a meter does wrong: the driver says so, and never takes a number for another."""

import numpy as np
import pytest
from rcskin.hardware.control_client import send_request
from rcskin.hardware.meter.errors import (
    FailedReadingError,
    MeterError,
    RestartedError,
)
from rcskin.hardware.meter.instruments import open_meter
from rcskin.hardware.meter.meter_reading import ReadingStatus
from rcskin.hardware.record.measured_sweep import check_frequencies
from rcskin.hardware.virtual.served_skin import VIRTUAL_MODELS, simulated
from rcskin.hardware.virtual.served_skin import instrument as instrument_of
from rcskin.hardware.virtual.virtual_device import Fault
from rcskin.simulator.sweeps import InputError

WAIT = 0.2
"""Time-out of the driver, s."""
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
    OF_ONE,
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

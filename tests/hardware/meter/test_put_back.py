"""A meter is left as it was found, whatever was set and however the work with it ended."""

import copy
import signal
import time

import pytest
from rcskin.hardware.meter.correction import correct
from rcskin.hardware.meter.errors import MeterError
from rcskin.hardware.meter.hioki import open_meter
from rcskin.hardware.record.station import Station
from rcskin.hardware.virtual.faults import Fault
from rcskin.hardware.virtual.state import PerRange, Settings


@pytest.fixture
def as_found():
    """Settings that no command here leaves untouched, each range with its own."""
    each = {n: PerRange(("FAST", "SLOW")[n % 2], n, n / 10) for n in range(1, 11)}
    return Settings(
        header=True,
        mode="CONTINUOUS",
        frequency=2e3,
        level="CC",
        voltage=0.5,
        constant_voltage=0.25,
        constant_current=2e-3,
        range=7,
        auto_range=False,
        parameters=("CP", "D"),
        items=(1, 2),
        valid=2,
        each_range=each,
        load_correction=True,
        cable=1,
    )


@pytest.fixture
def instrument(make_instrument, as_found):
    return make_instrument(settings=copy.deepcopy(as_found))


SET = {
    "level": "V",
    "voltage": 1.0,
    "constant_voltage": 1.0,
    "constant_current": 1e-2,
    "auto_range": True,
    "speed": "SLOW2",
    "averaging": 2,
    "trigger_delay": 0.0,
    "cable": 0,
    "load_correction": False,
    "frequency": 5e3,
}


def test_everything_that_was_set_is_put_back(ports, instrument, as_found):
    with open_meter(ports.resource, 1) as meter:
        for name, value in SET.items():
            setattr(meter, name, value)
        meter.read()
        assert instrument.settings != as_found
    assert instrument.settings == as_found


@pytest.mark.parametrize("automatic", [True, False])
def test_a_range_that_was_set_or_searched_for_is_put_back(ports, instrument, automatic):
    instrument.settings.auto_range = automatic
    with open_meter(ports.resource, 1) as meter:
        meter.range = 9
        meter.auto_range = not automatic
        meter.read()
    assert (instrument.settings.range, instrument.settings.auto_range) == (7, automatic)


def test_only_what_was_set_is_touched(ports, instrument):
    with open_meter(ports.resource, 1) as meter:
        meter.read()
        instrument.settings.cable, instrument.settings.voltage = 0, 3.0
    assert (instrument.settings.cable, instrument.settings.voltage) == (0, 3.0)


def test_it_is_put_back_after_an_error_too(ports, instrument, as_found):
    with pytest.raises(MeterError), open_meter(ports.resource, 0.2) as meter:
        instrument.faults.add(Fault("garbage"))
        meter.read()
    assert instrument.settings == as_found


def test_an_acquired_correction_stays_and_the_trigger_goes_back(ports, instrument, as_found):
    with open_meter(ports.resource, 1) as meter:
        correct(meter, "open", interval=0.001)
    as_found.open_correction = "ALL"
    assert instrument.settings == as_found


def test_a_meter_that_came_back_is_put_back_to_what_it_was_at_first(ports, instrument, as_found):
    station = Station(lambda: open_meter(ports.resource, 1))
    station.ready().speed = "SLOW2"
    station.close()
    station.ready().cable = 0
    station.close()
    assert instrument.settings != as_found
    station.leave()
    assert instrument.settings == as_found


def test_a_meter_that_lost_its_settings_is_put_back_all_the_same(ports, instrument, as_found):
    station = Station(lambda: open_meter(ports.resource, 1))
    meter = station.ready()
    for name, value in SET.items():
        setattr(meter, name, value)
    instrument.faults.add(Fault("forget"))
    station.leave()
    as_found.parameters = Settings().parameters
    assert instrument.settings == as_found


def test_a_connection_lost_at_the_very_end_is_made_again(ports, instrument, as_found):
    station = Station(lambda: open_meter(ports.resource, 0.3))
    station.ready().speed = "SLOW2"
    instrument.faults.add(Fault("drop", times=2))
    station.leave()
    assert instrument.settings == as_found


def test_a_meter_that_stays_away_is_told_of(ports, instrument):
    told = []
    station = Station(lambda: open_meter(ports.resource, 0.2), tell=told.append)
    station.ready()
    instrument.faults.add(Fault("drop", times=10**6))
    station.leave()
    assert told == [
        "the meter does not answer: header, mode, trigger, items, valid could not be put back"
    ]


@pytest.mark.parametrize(
    "arguments",
    [["correct", "open"], ["correct", "short", "--extent", "OFF"], ["identify"]],
    ids=" ".join,
)
def test_small_commands_leave_it_as_found(command, ports, instrument, as_found, arguments):
    positional = arguments[0] == "identify"
    where = [ports.resource] if positional else ["--resource", ports.resource]
    assert command(*arguments, *where).exit_code == 0
    as_found.open_correction = instrument.settings.open_correction
    assert instrument.settings == as_found


@pytest.fixture
def recording(ports, tmp_path):
    """A function of a number of sweeps: words of the command that records them in `run.nc`."""

    def recording(sweeps):
        order = tmp_path / "order.txt"
        order.write_text("none\n" * sweeps)
        where = ["--resource", ports.resource, "--order", order, "-o", tmp_path / "run.nc"]
        return ["record", "pillow", *where, "--unattended", "--speed", "FAST", "--level", "V"]

    return recording


def test_a_recording_leaves_it_as_found(command, recording, instrument, as_found, tmp_path):
    assert command(*recording(3)).exit_code == 0
    assert instrument.settings == as_found
    assert (tmp_path / "run.nc").exists()


@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGTERM], ids=str)
def test_a_recording_that_is_ended_leaves_it_as_found(
    start_rig, recording, instrument, as_found, tmp_path, end
):
    instrument.pace = 0.05
    process = start_rig(*recording(5000))
    while not (tmp_path / "run.nc.sweeps" / "000001.json").exists():
        assert process.poll() is None, process.stderr.read()
        time.sleep(0.01)
    process.send_signal(end)
    _, err = process.communicate(timeout=30)
    assert "Traceback" not in err
    assert process.returncode != 0
    assert instrument.settings == as_found
    assert not (tmp_path / "run.nc").exists()

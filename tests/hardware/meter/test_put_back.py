"""A meter is left as it was found, whatever was set and however the work with it ended."""

import copy
import signal
import time

import pytest
from rcskin.hardware.meter.connection import VisaConnection
from rcskin.hardware.meter.correction import correct
from rcskin.hardware.meter.errors import MeterError
from rcskin.hardware.meter.hioki import IM3523, HiokiMeter
from rcskin.hardware.meter.instruments import open_meter
from rcskin.hardware.meter.setting import Setting
from rcskin.hardware.record.managed_meter import ManagedMeter
from rcskin.hardware.record.recording_journal import RecordingJournal
from rcskin.hardware.virtual.faults import Fault
from rcskin.hardware.virtual.hioki.meter_state import Settings

NOT_AS_FOUND = "the meter did not confirm these original settings; check them on the meter:"
SETTERS = {
    setting.command_text.split(" ")[0]: name
    for name in dir(IM3523)
    if isinstance(setting := getattr(IM3523, name), Setting)
}


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
    station = ManagedMeter(lambda: open_meter(ports.resource, 1))
    station.ready().speed = "SLOW2"
    station.close()
    station.ready().cable = 0
    station.close()
    assert instrument.settings != as_found
    station.release()
    assert instrument.settings == as_found


def test_a_meter_that_lost_its_settings_is_put_back_all_the_same(ports, instrument, as_found):
    station = ManagedMeter(lambda: open_meter(ports.resource, 1))
    meter = station.ready()
    for name, value in SET.items():
        setattr(meter, name, value)
    instrument.faults.add(Fault("forget"))
    station.release()
    as_found.parameters = Settings().parameters
    assert instrument.settings == as_found


def test_a_connection_lost_at_the_very_end_is_made_again(ports, instrument, as_found):
    station = ManagedMeter(lambda: open_meter(ports.resource, 0.3))
    station.ready().speed = "SLOW2"
    instrument.faults.add(Fault("drop", times=2))
    station.release()
    assert instrument.settings == as_found


def test_a_meter_that_stays_away_is_told_of(ports, instrument):
    told = []
    station = ManagedMeter(lambda: open_meter(ports.resource, 0.2), report=told.append)
    station.ready()
    instrument.faults.add(Fault("drop", times=10**6))
    station.release()
    assert told == [
        "the meter did not confirm these original settings; check them on the meter: "
        "header = True, mode = CONTINUOUS, trigger = INTERNAL, items = 1 2, valid = 2"
    ]


def test_a_slow_line_is_given_time_for_each_answer(ports, instrument, as_found, monkeypatch):
    monkeypatch.setattr("rcskin.hardware.record.managed_meter.GIVE_UP_AFTER", 0.3)
    station = ManagedMeter(lambda: open_meter(ports.resource, 1))
    station.ready().speed = "SLOW2"
    instrument.faults.add(Fault("late", times=10**6, seconds=0.06))
    begun = time.monotonic()
    station.release()
    assert time.monotonic() - begun > 3 * 0.3
    assert instrument.settings == as_found


def test_a_setting_that_the_meter_refuses_is_named_and_all_others_are_put_back(
    ports, instrument, as_found, monkeypatch
):
    told = []
    station = ManagedMeter(lambda: open_meter(ports.resource, 1), report=told.append)
    station.ready().cable = 0
    monkeypatch.setattr(HiokiMeter.cable, "command_text", ":CORRection:CABLe 1,")
    station.release()
    assert told == [f"{NOT_AS_FOUND} cable = 1"]
    as_found.cable = 0
    assert instrument.settings == as_found


def test_a_meter_switched_on_anew_in_the_midst_is_put_back_from_the_beginning(
    ports, instrument, as_found, monkeypatch
):
    station = ManagedMeter(lambda: open_meter(ports.resource, 1))
    meter = station.ready()
    for name, value in SET.items():
        setattr(meter, name, value)
    told = Setting.restore

    def restore(setting, meter, found):
        told(setting, meter, found)
        if setting.name == "trigger" and not instrument.faults.waiting:
            instrument.faults.add(Fault("forget"))
            monkeypatch.undo()

    monkeypatch.setattr(Setting, "restore", restore)
    station.release()
    as_found.parameters = Settings().parameters
    assert instrument.settings == as_found


def test_how_it_was_found_is_on_the_disk_before_anything_is_set(ports, tmp_path, monkeypatch):
    journal, wrote, seen = RecordingJournal(tmp_path / "run.nc"), VisaConnection.write, set()

    def write(line, message):
        name = SETTERS.get(message.split(" ")[0])
        if name:
            assert name in journal.original_settings()[1]
            seen.add(name)
        wrote(line, message)

    monkeypatch.setattr(VisaConnection, "write", write)
    station = ManagedMeter(lambda: open_meter(ports.resource, 1), journal=journal)
    station.ready().speed = "SLOW2"
    station.meter.range = 5
    assert {"header", "trigger", "items", "speed", "range"} <= seen
    station.release()
    assert not journal.folder.exists()


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


def test_a_correction_that_is_ended_is_cancelled(ports, start_rig, instrument, as_found):
    instrument.pace = 1.0
    process = start_rig("correct", "open", "--resource", ports.resource)
    while not instrument.corrections.busy:
        assert process.poll() is None, process.stderr.read()
        time.sleep(0.01)
    process.send_signal(signal.SIGHUP)
    process.communicate(timeout=30)
    assert process.returncode == 128 + signal.SIGHUP
    assert not instrument.corrections.busy and instrument.settings == as_found

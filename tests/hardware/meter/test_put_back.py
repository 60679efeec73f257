"""A meter is left as it was found, whatever was set and however the work with it ended."""

import copy
import gc
import os
import signal
import time

import pytest
from rcskin.hardware.meter.connection import VisaConnection
from rcskin.hardware.meter.correction import correct
from rcskin.hardware.meter.ending import Ending, ending_in_order, look, shielded
from rcskin.hardware.meter.errors import MeterError
from rcskin.hardware.meter.hioki import IM3523, HiokiMeter, open_meter
from rcskin.hardware.meter.setting import Setting
from rcskin.hardware.record.journal import FOUND, Journal
from rcskin.hardware.record.station import Station
from rcskin.hardware.virtual.faults import Fault
from rcskin.hardware.virtual.state import PerRange, Settings

NOT_AS_FOUND = "the meter is not as it was found; not confirmed is what should be"
SETTERS = {
    setting.tell.split(" ")[0]: name
    for name in dir(IM3523)
    if isinstance(setting := getattr(IM3523, name), Setting)
}
ENDS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT]


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
        "the meter is not as it was found; not confirmed is what should be header = True, "
        "mode = CONTINUOUS, trigger = INTERNAL, items = 1 2, valid = 2"
    ]


def test_a_slow_line_is_given_time_for_each_answer(ports, instrument, as_found, monkeypatch):
    monkeypatch.setattr("rcskin.hardware.record.station.PARTING", 0.3)
    station = Station(lambda: open_meter(ports.resource, 1))
    station.ready().speed = "SLOW2"
    instrument.faults.add(Fault("late", times=10**6, seconds=0.06))
    begun = time.monotonic()
    station.leave()
    assert time.monotonic() - begun > 3 * 0.3
    assert instrument.settings == as_found


def test_a_setting_that_the_meter_refuses_is_named_and_all_others_are_put_back(
    ports, instrument, as_found, monkeypatch
):
    told = []
    station = Station(lambda: open_meter(ports.resource, 1), tell=told.append)
    station.ready().cable = 0
    monkeypatch.setattr(HiokiMeter.cable, "tell", ":CORRection:CABLe 1,")
    station.leave()
    assert told == [f"{NOT_AS_FOUND} cable = 1"]
    as_found.cable = 0
    assert instrument.settings == as_found


def test_a_meter_switched_on_anew_in_the_midst_is_put_back_from_the_beginning(
    ports, instrument, as_found, monkeypatch
):
    station = Station(lambda: open_meter(ports.resource, 1))
    meter = station.ready()
    for name, value in SET.items():
        setattr(meter, name, value)
    told = Setting.put_back

    def put_back(setting, meter, found):
        told(setting, meter, found)
        if setting.name == "trigger" and not instrument.faults.waiting:
            instrument.faults.add(Fault("forget"))
            monkeypatch.undo()

    monkeypatch.setattr(Setting, "put_back", put_back)
    station.leave()
    as_found.parameters = Settings().parameters
    assert instrument.settings == as_found


def test_how_it_was_found_is_on_the_disk_before_anything_is_set(ports, tmp_path, monkeypatch):
    journal, wrote, seen = Journal(tmp_path / "run.nc"), VisaConnection.write, set()

    def write(line, message):
        name = SETTERS.get(message.split(" ")[0])
        if name:
            assert name in journal.found()[1]
            seen.add(name)
        wrote(line, message)

    monkeypatch.setattr(VisaConnection, "write", write)
    station = Station(lambda: open_meter(ports.resource, 1), journal=journal)
    station.ready().speed = "SLOW2"
    station.meter.range = 5
    assert {"header", "trigger", "items", "speed", "range"} <= seen
    station.leave()
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


def test_a_good_recording_that_leaves_it_changed_says_so_in_its_code(
    command, recording, instrument, tmp_path, monkeypatch
):
    monkeypatch.setattr("rcskin.hardware.record.station.PARTING", 0.2)
    keep = Journal.keep

    def last(journal, number, entry):
        keep(journal, number, entry)
        instrument.faults.add(Fault("drop", times=10**6))

    monkeypatch.setattr(Journal, "keep", last)
    done = command(*recording(1))
    assert done.exit_code == 3
    assert f"rcskin: {NOT_AS_FOUND} header = True, " in done.stderr
    assert "trigger = INTERNAL" in done.stderr and "speed = FAST SLOW FAST" not in done.stdout
    assert (tmp_path / "run.nc").exists()


@pytest.fixture
def under_way(start_rig, recording, instrument, tmp_path):
    """A function that gives a recording that has a sweep, as a process."""

    def under_way(sweeps):
        instrument.pace = 0.05
        process = start_rig(*recording(sweeps))
        while not (tmp_path / "run.nc.sweeps" / "000001.json").exists():
            assert process.poll() is None, process.stderr.read()
            time.sleep(0.01)
        return process

    return under_way


@pytest.mark.parametrize("end", ENDS, ids=str)
def test_a_recording_that_is_ended_leaves_it_as_found(
    under_way, instrument, as_found, tmp_path, end
):
    process = under_way(5000)
    process.send_signal(end)
    _, err = process.communicate(timeout=30)
    assert "Traceback" not in err
    assert process.returncode != 0
    assert instrument.settings == as_found
    assert not (tmp_path / "run.nc").exists()


def test_no_further_signal_ends_the_putting_back(under_way, instrument, as_found):
    process = under_way(5000)
    instrument.faults.add(Fault("late", times=10**6, seconds=0.04))
    process.send_signal(signal.SIGTERM)
    for each in (signal.SIGHUP, signal.SIGINT, signal.SIGTERM) * 3:
        time.sleep(0.15)
        assert process.poll() is None
        process.send_signal(each)
    _, err = process.communicate(timeout=30)
    assert "Traceback" not in err and process.returncode == 128 + signal.SIGTERM
    assert instrument.settings == as_found


def test_after_a_kill_the_same_command_puts_back_what_was_at_first(
    under_way, recording, command, instrument, as_found, tmp_path
):
    process = under_way(6)
    process.kill()
    process.communicate()
    assert instrument.settings.trigger == "EXTERNAL" and instrument.settings != as_found
    found = tmp_path / "run.nc.sweeps" / FOUND
    kept = found.read_text()
    found.write_text("{}")
    assert command(*recording(6)).exception.args[0].startswith(f"{found}: tells not how")
    found.write_text(kept)
    done = command(*recording(6))
    assert done.exit_code == 0
    assert instrument.settings == as_found
    assert [path.name for path in tmp_path.glob("run*")] == ["run.nc"]


class Deaf:
    """Is interrupted where Python lets no error out."""

    def __del__(self):
        os.kill(os.getpid(), signal.SIGINT)
        for _ in range(1000):
            pass


def test_a_ctrl_c_that_is_lost_in_a_library_is_raised_at_the_next_look(capfd):
    lost = Deaf()
    with pytest.raises(KeyboardInterrupt), ending_in_order():
        del lost
        gc.collect()
        with shielded():
            look()
        look()
    assert capfd.readouterr() == ("", "")


def test_an_ignored_signal_stays_ignored(monkeypatch):
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with ending_in_order():
            os.kill(os.getpid(), signal.SIGHUP)
            look()
    finally:
        signal.signal(signal.SIGHUP, before)


def test_who_insists_gets_out(monkeypatch, capfd):
    ending = Ending(shields=1)
    monkeypatch.setattr("rcskin.hardware.meter.ending._ending", ending)
    for seconds, number in enumerate((15, 2, 15, 2, 15, 2), start=1):
        with shielded() as insisting:
            assert not insisting()
        monkeypatch.setattr("rcskin.hardware.meter.ending.monotonic", lambda now=2 * seconds: now)
        ending.hear(number, None)
    with shielded() as insisting:
        assert insisting()
    assert "Ctrl-C 2 times more, a second apart, leaves it changed" in capfd.readouterr().err

"""A meter is left as it was found, whatever was set and however the work with it ended."""

import signal
import time

import pytest
from rcskin.hardware.meter.correction import correct
from rcskin.hardware.meter.errors import CorrectionError, MeterError
from rcskin.hardware.meter.hioki import HiokiMeter
from rcskin.hardware.meter.instruments import open_meter
from rcskin.hardware.meter.link.connection import VisaConnection
from rcskin.hardware.meter.setting import Setting
from rcskin.hardware.record.managed_meter import ManagedMeter
from rcskin.hardware.record.recording_journal import RecordingJournal
from rcskin.hardware.virtual.faults import Fault
from rcskin.hardware.virtual.virtual_models import VIRTUAL_MODELS
from rcskin.tests.hardware.instrument_cases import CASES, E4980A, E4990A, HP4284A, IM3523

NOT_AS_FOUND = "the meter did not confirm these original settings; check them on the meter:"
HIOKI_ONLY = pytest.mark.parametrize("case", [IM3523], indirect=True, ids=["IM3523"])


@pytest.fixture(params=CASES, ids=lambda case: case.model)
def case(request):
    """An instrument: how it is found, and what is set."""
    return request.param


@pytest.fixture
def as_found(case):
    """Settings that no command here leaves untouched."""
    return case.found()


@pytest.fixture
def instrument(make_instrument, case):
    """The virtual instrument, as found."""
    return make_instrument(kind=VIRTUAL_MODELS[case.model], settings=case.found())


def change_all(meter, case):
    """Set everything that the case names."""
    for name, value in case.changes.items():
        setattr(meter, name, value)
        assert getattr(meter, name) == value


def after_power_cut(case, as_found):
    """Settings as found, but those that a power cut changes and no driver knows."""
    return as_found.replaced(**(case.lost or {}))


def test_everything_that_was_set_is_put_back(ports, instrument, case, as_found):
    with open_meter(ports.resource, 1) as meter:
        change_all(meter, case)
        meter.read_sweep([1e3, 2e3])
        meter.read_at(1e3)
        assert instrument.settings != as_found
    assert instrument.settings == as_found


@HIOKI_ONLY
@pytest.mark.parametrize("automatic", [True, False])
def test_a_range_that_was_set_or_searched_for_is_put_back(ports, instrument, automatic):
    instrument.settings.auto_range = automatic
    with open_meter(ports.resource, 1) as meter:
        meter.range = 9
        meter.auto_range = not automatic
        meter.read()
    assert (instrument.settings.range, instrument.settings.auto_range) == (7, automatic)


@pytest.mark.parametrize("case", [E4980A, HP4284A], indirect=True, ids=lambda case: case.model)
def test_a_level_of_the_other_kind_is_put_back(ports, instrument, case, as_found):
    with open_meter(ports.resource, 0.3) as meter:
        for amplitude in ("0.25 V", "0.004 A"):
            meter.amplitude = amplitude
            assert meter.amplitude == amplitude
    now, found = instrument.settings, as_found
    assert (now.level, getattr(now, now.level)) == (found.level, getattr(found, found.level))


@pytest.mark.parametrize("case", [E4980A], indirect=True, ids=["E4980A"])
@pytest.mark.parametrize(("kind", "values"), [("frequency", ()), ("voltage", (0.5, 1.0))])
def test_a_list_that_is_empty_or_of_no_frequencies_is_emptied(ports, instrument, kind, values):
    instrument.settings.list_kind, instrument.settings.list_values = kind, values
    with open_meter(ports.resource, 0.2) as meter:
        assert len(meter.read_sweep([1e3, 2e3])) == 2
    assert instrument.settings.list_values == ()


@HIOKI_ONLY
def test_only_what_was_set_is_touched(ports, instrument):
    with open_meter(ports.resource, 1) as meter:
        meter.read()
        instrument.settings.cable, instrument.settings.voltage = 0, 3.0
    assert (instrument.settings.cable, instrument.settings.voltage) == (0, 3.0)


def test_it_is_put_back_after_an_error_too(ports, instrument, as_found):
    with pytest.raises(MeterError), open_meter(ports.resource, 0.2) as meter:
        instrument.faults.add(Fault("garbage"))
        meter.read_at(1e3)
    assert instrument.settings == as_found


def test_an_acquired_correction_stays_and_the_trigger_goes_back(ports, instrument, case, as_found):
    with open_meter(ports.resource, 1) as meter:
        correct(meter, "open", interval=0.001)
    as_found.open_correction = case.acquired
    assert instrument.settings == as_found


def test_a_meter_that_came_back_is_put_back_to_what_it_was_at_first(
    ports, instrument, case, as_found
):
    station = ManagedMeter(lambda: open_meter(ports.resource, 1))
    station.ready().speed = case.changes["speed"]
    station.close()
    station.ready().load_correction = False
    station.close()
    assert instrument.settings != as_found
    station.release()
    assert instrument.settings == as_found


def test_a_meter_that_lost_its_settings_is_put_back_all_the_same(ports, instrument, case, as_found):
    station = ManagedMeter(lambda: open_meter(ports.resource, 1))
    change_all(station.ready(), case)
    instrument.faults.add(Fault("forget"))
    station.release()
    assert instrument.settings == after_power_cut(case, as_found)


def test_a_connection_lost_at_the_very_end_is_made_again(ports, instrument, case, as_found):
    station = ManagedMeter(lambda: open_meter(ports.resource, 0.3))
    station.ready().speed = case.changes["speed"]
    instrument.faults.add(Fault("drop", times=2))
    station.release()
    assert instrument.settings == as_found


@HIOKI_ONLY
def test_a_meter_that_stays_away_is_reported(ports, instrument):
    told = []
    station = ManagedMeter(lambda: open_meter(ports.resource, 0.2), report=told.append)
    station.ready()
    instrument.faults.add(Fault("drop", times=10**6))
    station.release()
    assert told == [
        "the meter did not confirm these original settings; check them on the meter: "
        "header = True, mode = CONTINUOUS, trigger = INTERNAL, items = 1 2, valid = 2"
    ]


@HIOKI_ONLY
def test_a_slow_line_is_given_time_for_each_answer(ports, instrument, as_found, monkeypatch):
    monkeypatch.setattr("rcskin.hardware.record.managed_meter.GIVE_UP_AFTER", 0.3)
    station = ManagedMeter(lambda: open_meter(ports.resource, 1))
    station.ready().speed = "SLOW2"
    instrument.faults.add(Fault("late", times=10**6, seconds=0.06))
    begun = time.monotonic()
    station.release()
    assert time.monotonic() - begun > 3 * 0.3
    assert instrument.settings == as_found


@HIOKI_ONLY
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
    ports, instrument, case, as_found, monkeypatch
):
    station = ManagedMeter(lambda: open_meter(ports.resource, 1))
    change_all(station.ready(), case)
    told = Setting.restore

    def restore(setting, meter, found):
        told(setting, meter, found)
        if setting.name == case.driver.restored_last[0] and not instrument.faults.waiting:
            instrument.faults.add(Fault("forget"))
            monkeypatch.undo()

    monkeypatch.setattr(Setting, "restore", restore)
    station.release()
    assert instrument.settings == after_power_cut(case, as_found)


def test_how_it_was_found_is_on_the_disk_before_anything_is_set(ports, case, tmp_path, monkeypatch):
    journal, wrote, seen = RecordingJournal(tmp_path / "run.nc"), VisaConnection.write, set()
    setters = {
        setting.command_text.split(" ")[0]: name
        for name in dir(case.driver)
        if isinstance(setting := getattr(case.driver, name), Setting)
    }

    def write(line, message):
        name = setters.get(message.split(" ")[0])
        if name in ("voltage", "current") and hasattr(case.driver, "amplitude"):
            name = "amplitude"
        if name:
            assert name in journal.original_settings()[1]
            seen.add(name)
        wrote(line, message)

    monkeypatch.setattr(VisaConnection, "write", write)
    station = ManagedMeter(lambda: open_meter(ports.resource, 1), journal=journal)
    change_all(station.ready(), case)
    assert {"trigger", "load_correction"} <= seen and len(seen) > 8
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


def test_a_failed_correction_says_what_to_check_and_is_not_used(ports, instrument, as_found):
    instrument.faults.add(Fault("correction"))
    with open_meter(ports.resource, 1) as meter:
        with pytest.raises(CorrectionError, match="short correction failed.*shorting bar"):
            correct(meter, "short", interval=0.001)
        assert meter.short_correction == "OFF"
    assert instrument.settings == as_found


def acquires(instrument):
    """True while the virtual instrument acquires a correction."""
    if hasattr(instrument, "acquiring"):
        return instrument.acquiring is not None
    return instrument.corrections.busy


@pytest.mark.posix("there is no SIGHUP")
@pytest.mark.parametrize(
    "case", [IM3523, E4980A, E4990A], indirect=True, ids=lambda case: case.model
)
def test_a_correction_that_is_ended_is_cancelled(ports, start_rig, instrument, as_found):
    instrument.pace = 1.0
    process = start_rig("correct", "open", "--resource", ports.resource)
    while not acquires(instrument):
        assert process.poll() is None, process.stderr.read()
        time.sleep(0.01)
    process.send_signal(signal.SIGHUP)
    process.communicate(timeout=30)
    assert process.returncode == 128 + signal.SIGHUP
    assert not acquires(instrument) and instrument.settings == as_found

"""The laws that every meter keeps on every link, stated once. A meter is a dialect and its twin.

A case says how a meter is found and what is set. The last one is the meter that the page about
adding a meter adds, word for word.
"""

import asyncio
import random
import signal
import socket
import time
from contextlib import suppress

import pytest
from rcskin.hardware.meter.conversation import VisaConnection
from rcskin.hardware.meter.errors import (
    CorrectionError,
    FailedReadingError,
    GarbledError,
    LostConnectionError,
    MeterError,
    NoAnswerError,
    RefusedError,
    RestartedError,
)
from rcskin.hardware.meter.instruments import INSTRUMENTS, instrument_of, open_meter
from rcskin.hardware.meter.lcr_meter import correct
from rcskin.hardware.meter.meter_reading import ReadingStatus, parse_identity
from rcskin.hardware.meter.setting import FROM_MEMORY, MeterProperty, Setting, rows, source_of
from rcskin.hardware.record.managed_meter import ManagedMeter
from rcskin.hardware.record.recording_journal import RecordingJournal
from rcskin.hardware.virtual.instrument import answer
from rcskin.hardware.virtual.served_skin import VIRTUAL_MODELS
from rcskin.hardware.virtual.virtual_device import Fault
from rcskin.simulator.meters.accuracy_table import METER_BANDS
from rcskin.simulator.sweeps import InputError
from rcskin.tests.hardware.instrument_cases import CASES, of_the_page
from rcskin.tests.hardware.links import LINKS

WAIT = 0.3
"""Time-out of the driver, s."""
OWN_ANSWER = ("current", "constant_current", "voltage", "data_format", "segments")
"""Settings that have no answer while they are not in use, or one of another kind."""
ADDED, NAMES = of_the_page()
ALL = (*CASES, ADDED)


@pytest.fixture(autouse=True)
def as_the_page_says(monkeypatch):
    """The lines that the page has one add."""
    monkeypatch.setitem(METER_BANDS, "MODEL1", (20.0, 1e5))
    monkeypatch.setitem(INSTRUMENTS, "MODEL1", NAMES["Model1"])
    monkeypatch.setitem(VIRTUAL_MODELS, "MODEL1", NAMES["VirtualModel1"])


@pytest.fixture(params=ALL, ids=lambda case: case.model)
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


@pytest.fixture(
    params=[pytest.param("tcp"), pytest.param("serial", marks=pytest.mark.posix("pty"))]
)
def resource(request, ports):
    """Where the meter is found, by each link."""
    with LINKS[request.param](ports) as resource:
        yield resource


@pytest.fixture
def line(ports):
    """Where the meter is found by TCP, for laws that no link changes."""
    return ports.resource


def change_all(meter, case):
    """Set everything that the case names."""
    for name, value in case.changes.items():
        setattr(meter, name, value)
        assert getattr(meter, name) == value


def after_power_cut(case, as_found):
    """Settings as found, but those that a power cut changes and no driver knows."""
    return as_found.replaced(**(case.lost or {}))


def requires_right_readings(meter, pillow):
    """A reading and a sweep are those of the skin."""
    for frequency in (2e3, 5e4):
        reading = meter.read_at(frequency)
        assert reading.value == pytest.approx(pillow.impedance("none", frequency), rel=1e-5)
        assert reading.status is ReadingStatus.NORMAL
    found = [each.value for each in meter.read_sweep([1e3, 2e3, 5e3])]
    exact = [pillow.impedance("none", frequency) for frequency in (1e3, 2e3, 5e3)]
    assert found == pytest.approx(exact, rel=1e-5)


# What a dialect declares.


def test_a_dialect_and_its_driver_declare_all_that_is_needed(case):
    meter, table = case.driver, rows(case.driver)
    assert not meter.__abstractmethods__
    for name in (*meter.settable, *meter.reported, *meter.timing, *meter.restored_last):
        assert hasattr(meter, name), name
    for name in (*meter.timing, *meter.restored_last, *meter.needed):
        assert isinstance(getattr(meter, name), Setting)
    assert set(meter.meaning) <= set(meter.needed) and meter.meaning
    assert all(isinstance(getattr(meter, name), MeterProperty) for name in meter.reported)
    assert meter.extents[-1] == "OFF"
    named = {name for names in meter.sources.values() for name in names.split()}
    assert named <= set(table) and all(source_of(meter, name) for name in table)
    assert FROM_MEMORY in meter.facts.values()
    text = f"KEYSIGHT,{case.model},MY12345678,A.01.00"
    assert (parse_identity(text).model, instrument_of(text)) == (case.model, meter)
    assert case.model in METER_BANDS


def test_what_either_side_writes_of_a_row_the_other_one_reads(case, instrument):
    """Every row of the table: what the driver sends is taken, and the answer is the value."""

    async def answers():
        for name, row in rows(case.driver).items():
            each_range = getattr(row, "each_range", ())
            value = getattr(instrument.settings, name, None)
            if value is None or not isinstance(row, Setting) or name in OWN_ANSWER:
                continue
            value = value[0] if each_range else value
            text = row.allowed.write(value)
            query = f"{row.query} 1" if each_range else row.query
            said = await answer(instrument, f"*CLS;{row.command_text}{text};{query};*ESR?")
            shown, _, register = said.rpartition(";")
            assert (row.read_answer(shown.split(" ")[-1]), register) == (value, "0"), name

    if hasattr(instrument.settings, "header"):
        instrument.settings.header = False
    asyncio.run(answers())


# A set is verified, and what is not allowed is never set.


def test_everything_that_is_set_is_read_back_and_put_back(resource, instrument, case, as_found):
    with open_meter(resource, 1) as meter:
        change_all(meter, case)
        meter.read_sweep([1e3, 2e3])
        meter.read_at(1e3)
        assert instrument.settings != as_found
    assert instrument.settings == as_found


def test_what_is_not_allowed_is_never_set(line, instrument, case):
    with open_meter(line, 1) as meter:
        before = instrument.settings.replaced()
        for name, value in {"speed": "NEVER", "voltage": 1e9, "unknown": 1}.items():
            with pytest.raises(InputError, match=f"`({name}|amplitude)`|no setting `{name}`"):
                meter.apply_settings({name: value})
        for frequency in (1e12, -1.0, float("nan")):
            with pytest.raises(InputError, match="`frequency` must be from"):
                meter.read_at(frequency)
        assert instrument.settings == before


def test_a_set_that_the_meter_refuses_is_an_error(line, case, monkeypatch):
    name, value = list(case.changes.items())[-1]
    with open_meter(line, 1) as meter:
        monkeypatch.setattr(meter.talk, "_connection", Refusing(meter.talk._connection))
        with pytest.raises(RefusedError, match="the meter refused"):
            setattr(meter, name, value)
        monkeypatch.undo()


class Refusing:
    """A link on which each command that is no query is one that no meter knows."""

    def __init__(self, link):
        self._link = link

    def __getattr__(self, name):
        return getattr(self._link, name)

    def write(self, message):
        command, *more = message.split(";")
        self._link.write(message if "?" in command else ";".join([f":NONSENSE:{more}", *more]))


# A reading is triggered and new.


def test_readings_are_the_skin_and_never_older_than_their_call(resource, instrument, pillow, case):
    with open_meter(resource, 1) as meter:
        requires_right_readings(meter, pillow)
        stale = meter.read_at(1e3).value
        for press in ("5,1", "none", "9,1"):
            instrument.press = press
            fresh = meter.read_at(1e3).value
            assert fresh != stale
            stale = fresh


def test_without_its_trigger_a_reading_is_refused(line, case):
    with open_meter(line, 1) as meter:
        meter.trigger = "INTERNAL"
        with pytest.raises(RefusedError):
            meter.read_at(1e3)


QUANTITIES = [
    pytest.param(case, line, id=f"{case.model}-{line}")
    for case in ALL
    for line in case.quantities
    if line != ":FREQuency 2E3"  # which is set before each reading
]


@pytest.mark.parametrize(("case", "changed"), QUANTITIES, indirect=["case"])
def test_a_reading_of_what_another_client_changed_is_none(ports, line, pillow, case, changed):
    with open_meter(line, WAIT) as meter:
        meter.read_sweep([1e3, 2e3])
        with socket.create_connection(("127.0.0.1", ports.meter), timeout=5) as client:
            client.sendall(f"{changed}\n*IDN?\n".encode())
            client.recv(100)
        with suppress(MeterError):
            found = [each.value for each in meter.read_sweep([1e3, 2e3])]
            exact = [pillow.impedance("none", frequency) for frequency in (1e3, 2e3)]
            assert found == pytest.approx(exact, rel=1e-5)


# A fault is an error, and a late answer is survived.

FAULTS = [
    (Fault("silent"), NoAnswerError, "no whole answer within 0.3 s; check"),
    (Fault("half"), NoAnswerError, "no whole answer within 0.3 s; check"),
    (Fault("garbage"), GarbledError, "no line of text; check the baud rate"),
    (Fault("late", seconds=0.4), NoAnswerError, "the time-out is long enough"),
    (Fault("forget"), RestartedError, "settings and corrections are lost"),
]


@pytest.mark.parametrize(
    ("fault", "error", "told"), FAULTS, ids=lambda each: getattr(each, "kind", "")
)
def test_a_fault_is_reported_and_the_next_readings_are_right_again(
    resource, instrument, pillow, case, fault, error, told
):
    with open_meter(resource, WAIT) as meter:
        instrument.faults.add(Fault(fault.kind, seconds=fault.seconds))
        with pytest.raises(error, match=told) as raised:
            meter.read_at(1e3)
        assert "\n" not in str(raised.value)
        meter.prepare()
        requires_right_readings(meter, pillow)


def test_a_reading_that_failed_is_no_number(line, instrument, case):
    with open_meter(line, WAIT) as meter:
        instrument.faults.add(Fault("status"))
        with pytest.raises(FailedReadingError, match="overflow|overload|no reading"):
            meter.read_at(1e3)
        assert meter.read_at(1e3).status.has_values


def test_a_dropped_or_silent_line_is_lost_and_a_new_one_works(line, instrument, pillow, case):
    for fault in (Fault("drop"), Fault("silent", times=5)):
        with open_meter(line, 0.1) as meter:
            instrument.faults.add(fault)
            with pytest.raises(MeterError, match="check"):
                meter.read_at(1e3)
            with pytest.raises(LostConnectionError, match="connect again"):
                meter.read_at(1e3)
        instrument.faults.waiting.clear()
    with open_meter(line, WAIT) as meter:
        requires_right_readings(meter, pillow)


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


def test_random_faults_never_become_numbers(line, instrument, pillow, case):
    dice = random.Random(1)
    kinds = ("silent", "half", "garbage", "late", "status", "forget", "correction")
    for _ in range(2):
        with open_meter(line, 0.2) as meter:
            for _ in range(6):
                if dice.random() < 0.6:
                    instrument.faults.add(Fault(dice.choice(kinds), seconds=0.3))
                _attempt(meter, pillow, dice)
            instrument.faults.waiting.clear()


# All is left as found, after every way of ending.


def test_it_is_put_back_after_an_error_too(resource, instrument, as_found):
    with pytest.raises(MeterError), open_meter(resource, WAIT) as meter:
        instrument.faults.add(Fault("garbage"))
        meter.read_at(1e3)
    assert instrument.settings == as_found


def test_an_acquired_correction_stays_and_the_trigger_goes_back(line, instrument, case, as_found):
    with open_meter(line, 1) as meter:
        correct(meter, "open", interval=0.001)
    as_found.open_correction = case.acquired
    assert instrument.settings == as_found


def test_a_failed_correction_says_what_to_check_and_is_not_used(line, instrument, as_found):
    instrument.faults.add(Fault("correction"))
    with open_meter(line, 1) as meter:
        with pytest.raises(CorrectionError, match="short correction failed.*shorting bar"):
            correct(meter, "short", interval=0.001)
        assert meter.short_correction == "OFF"
    assert instrument.settings == as_found


def test_a_meter_that_came_back_is_put_back_to_what_it_was_at_first(
    resource, instrument, case, as_found
):
    station = ManagedMeter(lambda: open_meter(resource, 1))
    for name in list(case.changes)[:2]:
        setattr(station.ready(), name, case.changes[name])
        station.close()
    assert instrument.settings != as_found
    station.release()
    assert instrument.settings == as_found


def test_a_meter_that_lost_its_settings_is_put_back_all_the_same(
    resource, instrument, case, as_found
):
    station = ManagedMeter(lambda: open_meter(resource, 1))
    change_all(station.ready(), case)
    instrument.faults.add(Fault("forget"))
    station.release()
    assert instrument.settings == after_power_cut(case, as_found)


def test_a_connection_lost_at_the_very_end_is_made_again(resource, instrument, case, as_found):
    station = ManagedMeter(lambda: open_meter(resource, WAIT))
    station.ready().speed = case.changes["speed"]
    instrument.faults.add(Fault("drop", times=2))
    station.release()
    assert instrument.settings == as_found


def test_a_meter_switched_on_anew_in_the_midst_is_put_back_from_the_beginning(
    line, instrument, case, as_found
):
    station = ManagedMeter(lambda: open_meter(line, 1))
    change_all(station.ready(), case)
    told = Setting.restore

    def restore(setting, meter, found):
        told(setting, meter, found)
        if setting.name == case.driver.restored_last[0] and not instrument.faults.waiting:
            instrument.faults.add(Fault("forget"))
            patch.undo()

    patch = pytest.MonkeyPatch()
    patch.setattr(Setting, "restore", restore)
    station.release()
    assert instrument.settings == after_power_cut(case, as_found)


def test_how_it_was_found_is_on_the_disk_before_anything_is_set(line, case, tmp_path, monkeypatch):
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
    station = ManagedMeter(lambda: open_meter(line, 1), journal=journal)
    change_all(station.ready(), case)
    assert {"trigger"} <= seen and len(seen) > 4
    station.release()
    assert not journal.folder.exists()


@pytest.mark.parametrize(
    "arguments",
    [["correct", "open"], ["correct", "short", "--extent", "OFF"], ["identify"]],
    ids=" ".join,
)
def test_small_commands_leave_it_as_found(command, line, instrument, as_found, arguments):
    where = [line] if arguments[0] == "identify" else ["--resource", line]
    assert command(*arguments, *where).exit_code == 0
    as_found.open_correction = instrument.settings.open_correction
    assert instrument.settings == as_found


def acquires(instrument):
    """True while the virtual instrument acquires a correction."""
    if hasattr(instrument, "acquiring"):
        return instrument.acquiring is not None
    return instrument.corrections.busy


@pytest.mark.posix("there is no SIGHUP")
@pytest.mark.parametrize("case", CASES, indirect=True, ids=lambda case: case.model)
def test_a_correction_that_is_ended_is_cancelled(line, start_rig, instrument, as_found):
    instrument.pace = 1.0
    process = start_rig("correct", "open", "--resource", line)
    while not acquires(instrument):
        assert process.poll() is None, process.stderr.read()
        time.sleep(0.01)
    process.send_signal(signal.SIGHUP)
    process.communicate(timeout=30)
    assert process.returncode == 128 + signal.SIGHUP
    assert not acquires(instrument) and instrument.settings == as_found

"""A recording leaves the meter as it was found, however it ends, or says what it did not."""

import copy
import signal
import sys
import time
from threading import Thread

import numpy as np
import pytest
from rcskin.hardware.meter.termination import orderly_termination
from rcskin.hardware.record.operators import MachineOperator
from rcskin.hardware.record.recorder import record
from rcskin.hardware.record.recording_journal import METER_FILE, RecordingJournal
from rcskin.hardware.virtual.virtual_device import Fault

NOT_AS_FOUND = "the meter did not confirm these original settings; check them on the meter:"
ENDS = [signal.SIGINT]
if hasattr(signal, "SIGHUP"):
    ENDS += [signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT]
KILLED = "there one process ends another without a word to it"


@pytest.fixture
def instrument(make_instrument, as_found):
    return make_instrument(settings=copy.deepcopy(as_found))


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
    monkeypatch.setattr("rcskin.hardware.record.managed_meter.GIVE_UP_AFTER", 0.2)
    keep = RecordingJournal.keep

    def last(journal, number, entry):
        keep(journal, number, entry)
        instrument.faults.add(Fault("drop", times=10**6))

    monkeypatch.setattr(RecordingJournal, "keep", last)
    done = command(*recording(1))
    assert done.exit_code == 3
    assert f"rcskin: {NOT_AS_FOUND} header = True, " in done.stderr
    assert "trigger = INTERNAL" in done.stderr and "speed = FAST SLOW FAST" not in done.stdout
    assert [path.name for path in tmp_path.glob("run*")] == ["run.nc"]


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


@pytest.mark.posix(KILLED)
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


@pytest.mark.posix(KILLED)
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
    under_way, recording, command, instrument, as_found, tmp_path, caplog
):
    process = under_way(6)
    process.kill()
    process.communicate()
    assert instrument.settings.trigger == "EXTERNAL" and instrument.settings != as_found
    found = tmp_path / "run.nc.sweeps" / METER_FILE
    kept = found.read_text()
    found.write_text("{}")
    assert (
        command(*recording(6))
        .exception.args[0]
        .startswith(f"{found}: does not hold a meter's original settings")
    )
    found.write_text(kept)
    assert command("gather", tmp_path / "run.nc", "-o", tmp_path / "part.nc").exit_code == 0
    done = command(*recording(6))
    assert done.exit_code == 0
    told = [each.getMessage() for each in caplog.records]
    assert len(told) == 2 and all("header = True" in each for each in told)
    assert instrument.settings == as_found
    assert [path.name for path in tmp_path.glob("run*")] == ["run.nc"]


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_signals_at_any_moment_end_it_and_it_goes_on(
    command, recording, instrument, as_found, tmp_path
):
    """Also between the opening of a file and the block that closes it: Python then warns of it."""
    instrument.pace = 0.05  # or thousands of sweeps are read before a sender wakes
    folder = RecordingJournal(tmp_path / "run.nc").folder

    def send(kept, number, seconds):
        while sum(1 for _ in folder.glob("0*.json")) <= kept:
            time.sleep(0.005)
        time.sleep(seconds)
        signal.raise_signal(number)

    random = np.random.default_rng(1)
    for number in [*ENDS, *ENDS]:
        kept = sum(1 for _ in folder.glob("0*.json"))
        sender = Thread(target=send, args=(kept, number, random.uniform(0, 0.1)))
        sender.start()
        assert command(*recording(5000)).exit_code != 0
        sender.join()
        assert instrument.settings == as_found


class Hidden:
    """A display that is gone, and a trace that sends SIGHUP at the n-th line after that."""

    def __init__(self, last):
        self.lines, self.last, self.gone = 0, last, False

    def begin(self, title, baseline): ...
    def turn(self, interface): ...
    def end(self, remarks): ...

    def reading(self, frequency, reading):
        self.gone = True
        raise OSError("the display is gone")

    def trace(self, frame, event, argument):
        if self.gone and event == "line":
            self.lines += 1
            if self.lines == self.last:
                signal.raise_signal(signal.SIGHUP)
        return self.trace


@pytest.fixture
def traced():
    """A function that sets a trace, taken away at the end."""
    before = sys.gettrace()
    yield sys.settrace
    sys.settrace(before)


@pytest.mark.posix("there is no SIGHUP")
def test_a_signal_at_any_moment_after_a_failure_leaves_the_meter_as_found(
    task, instrument, as_found, traced
):
    """Also between the failure and the restoring, which an error ends that is raised there."""
    last, reached = 0, True
    while reached:
        last += 1 if last < 24 else 23
        hidden = Hidden(last)
        operator = MachineOperator(lambda step: None, hidden)
        with pytest.raises((OSError, SystemExit)):
            with orderly_termination():
                traced(hidden.trace)
                try:
                    record(task, operator)
                finally:
                    traced(None)
        reached = hidden.lines >= last
        assert instrument.settings == as_found, f"signal at line {last}"
    assert last > 100

"""`rcskin live` as its user meets it: a process of its own, in a pipe or on a terminal."""

import copy
import json
import os
import select
import signal
import time
from datetime import datetime

import numpy as np
import pytest
from rcskin.hardware.control_client import send_request
from rcskin.hardware.meter.errors import NoConnectionError
from rcskin.hardware.virtual.virtual_device import Fault
from rcskin.simulator.sweeps import UNPRESSED, read, write

SOON = 30
"""Seconds that the end may take on a very busy machine; alone it takes half a second."""
pty = pytest.importorskip("pty", reason="Windows has no terminals of Unix")
termios = pytest.importorskip("termios", reason="Windows has no terminals of Unix")
CONTROL_CODE, SHOWN_CURSOR = "\x1b", "\x1b[?25h"


@pytest.fixture
def terminal():
    """Both ends of a terminal of 30 lines of 100 characters."""
    ours, theirs = pty.openpty()
    termios.tcsetwinsize(theirs, (30, 100))
    yield ours, theirs
    os.close(ours)
    os.close(theirs)


def until(ours, wanted, seconds=2 * SOON):
    """What a terminal showed until it showed this."""
    shown, end = "", time.monotonic() + seconds
    while wanted not in shown:
        assert select.select([ours], [], [], max(0, end - time.monotonic()))[0], shown
        shown += os.read(ours, 65536).decode(errors="replace")
    return shown


def set_otherwise(instrument):
    """Settings of a meter's user that the command changes, as they are before it."""
    settings = instrument.settings
    settings.header, settings.items = True, (1, 1)
    settings.averaging = (1, 1, 7, *settings.averaging[3:])
    return copy.deepcopy(settings)


def test_in_a_pipe_each_answer_is_a_line(start, ports):
    process = start("--sweeps", 4)
    first = process.stdout.readline()
    send_request(f"127.0.0.1:{ports.control}", "press", press="2,3")
    out, err = process.communicate(timeout=SOON)
    assert process.returncode == 0
    assert CONTROL_CODE not in out + err
    lines = [line.split("\t") for line in [first, *out.splitlines()]]
    assert len(lines) == 4
    assert lines[0][1] == "nothing pressed" and lines[-1][1] == "column 3"
    for when, _, probability, latency in lines:
        assert datetime.fromisoformat(when)
        assert 0 <= float(probability) <= 1 and 0 < float(latency) < 20e3
    assert "leave the skin untouched: unpressed sweep 1 of 3" in err


@pytest.mark.posix("there one process ends another without a word to it")
def test_ctrl_c_ends_it_and_leaves_meter_and_log_in_order(start, instrument, tmp_path):
    before = set_otherwise(instrument)
    instrument.pace = 1.0
    process = start("--log", tmp_path / "run.nc")
    process.stdout.readline()
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=SOON)
    assert process.returncode == 130
    assert "Traceback" not in err
    assert instrument.settings == before and before.trigger == "INTERNAL"
    assert [path.name for path in tmp_path.iterdir()] == ["run.nc"]
    kept = read(tmp_path / "run.nc").sizes["sweep"]
    assert kept >= 4
    last = f"{kept} sweeps x 3 frequencies -> {tmp_path / 'run.nc'}; --rest-file "
    assert err.splitlines()[-2].startswith(last)


@pytest.mark.posix("there one process ends another without a word to it")
def test_ctrl_c_ends_it_while_an_answer_is_awaited(start, instrument):
    process = start("--timeout", 60)
    process.stdout.readline()
    instrument.faults.add(Fault("silent", times=1000))
    while instrument.faults.waiting[0].times == 1000:
        assert process.poll() is None, process.stderr.read()
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=SOON)
    assert process.returncode == 130


def test_an_unplugged_meter_is_given_up_with_code_1(start, instrument):
    process = start("--patience", 0.3, "--timeout", 0.2)
    process.stdout.readline()
    instrument.faults.add(Fault("drop", times=10**6))
    _, err = process.communicate(timeout=SOON)
    assert process.returncode == 1
    assert "trying again for up to 0.3 s" in err and "Traceback" not in err
    notes = err.splitlines()
    assert notes[-1].startswith("rcskin: the meter gave no sweep for 0.3 s")
    assert len({*notes}) == len(notes)


def test_a_meter_that_is_not_there_is_said_once(start):
    process = start("--patience", 0.6, resource="TCPIP0::127.0.0.1::1::SOCKET")
    out, err = process.communicate(timeout=SOON)
    assert (process.returncode, out) == (1, "") and err.count("cannot be made") == 1
    assert err.endswith("trying again for up to 0.6 s\nrcskin: the meter gave no sweep for 0.6 s\n")


def test_a_terminal_shows_the_grid_and_is_left_clean(start, terminal, instrument):
    ours, theirs = terminal
    instrument.pace = 1.0
    before = termios.tcgetattr(theirs)
    process = start(stdin=theirs, stdout=theirs, stderr=theirs)
    shown = until(ours, "nothing pressed")
    assert "rcskin live: column" in shown and "leave the skin untouched" in shown
    process.send_signal(signal.SIGINT)
    until(ours, SHOWN_CURSOR)
    assert process.wait(SOON) == 130
    assert termios.tcgetattr(theirs) == before


def test_a_key_ends_it_on_a_terminal(start, terminal):
    ours, theirs = terminal
    before = termios.tcgetattr(theirs)
    process = start(stdin=theirs, stdout=theirs, stderr=theirs)
    until(ours, "nothing pressed")
    os.write(ours, b"q")
    until(ours, SHOWN_CURSOR)
    assert process.wait(SOON) == 0
    assert termios.tcgetattr(theirs) == before


def test_plain_on_a_terminal_has_no_control_codes(start, terminal):
    ours, theirs = terminal
    process = start("--plain", "--sweeps", 2, stdin=theirs, stdout=theirs, stderr=theirs)
    shown = until(ours, "\tnothing pressed\t")
    assert process.wait(SOON) == 0
    assert CONTROL_CODE not in shown


def test_an_absent_meter_is_given_up_in_one_line(live):
    error = live("--patience", 0.1, "--resource", "TCPIP0::127.0.0.1::1::SOCKET").exception
    assert isinstance(error, NoConnectionError)
    assert "gave no sweep for 0.1 s" in str(error) and "\n" not in str(error)


def test_the_log_holds_sweeps_answers_and_the_rest(live, tmp_path):
    log = tmp_path / "run.nc"
    assert live("--sweeps", 3, "--rest", 2, "--log", log).exit_code == 0
    sweeps = read(log)
    assert list(sweeps["press"].values) == [UNPRESSED] * 2 + ["?"] * 3
    assert list(sweeps["row"].values) == [0, 0, -1, -1, -1]
    answers = json.loads(sweeps.attrs["answers"])
    assert [label for label, _ in answers] == [UNPRESSED] * 2 + ["nothing pressed"] * 3
    assert sweeps.attrs["meter"].startswith("HIOKI,IM3523")
    assert len(json.loads(sweeps.attrs["times"])) == 5


def test_the_rest_of_a_log_serves_again(live, tmp_path, instrument):
    log = tmp_path / "run.csv"
    live("--sweeps", 1, "--log", log)
    instrument.press = "1,2"
    output = live("--sweeps", 1, "--rest-file", log).output
    assert "column 2" in output and "untouched" not in output


def test_a_rest_file_of_fewer_sweeps_than_asked_for_is_enough(live, tmp_path, instrument):
    log = tmp_path / "run.csv"
    live("--sweeps", 1, "--rest", 2, "--log", log)
    instrument.press = "1,2"
    output = live("--sweeps", 1, "--rest", 3, "--rest-file", log).output
    assert "column 2" in output and "untouched" not in output


def test_a_rest_of_other_frequencies_is_refused(live, tmp_path):
    log, other = tmp_path / "run.csv", tmp_path / "other.csv"
    live("--sweeps", 1, "--log", log)
    sweeps = read(log)
    write(sweeps.assign_coords(frequency=[*sweeps["frequency"].values[:-1], 5000.0]), other)
    error = live("--rest-file", other).exception
    assert "other interfaces or frequencies than the model" in str(error)


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["--model", "two.npz"], "the interfaces left, bottom need a switch that works"),
        (["--interface", "up"], "the model was trained on interface left, got 'up'"),
        (["--rest", "0"], "`rest` must be in 1..1000, got 0"),
        (["--sweeps", "0"], "--sweeps must be from 1 to"),
        (["--patience", "0"], "`patience` must be in (0, 1e6] s, got 0"),
        (["--log", "a.xlsx"], "must end in .nc or .csv"),
        (["--rest-file", "absent.nc"], "absent.nc: no such file"),
        (["--accuracy", "absent.toml"], "absent.toml: no such file"),
        (["--timeout", "0", "--sweeps", "1"], "`timeout` must be in (0, 3600] s, got 0"),
    ],
)
def test_bad_input_is_one_line(live, arguments, told):
    error = live(*arguments).exception
    assert told in str(error)
    assert "\n" not in str(error)


def test_sweeps_are_those_of_the_skin(live, cushion, tmp_path):
    log = tmp_path / "run.nc"
    live("--sweeps", 2, "--log", log)
    truth = [cushion.impedance("none", f).imag for f in (1e3, 4e3, 16e3)]
    assert np.allclose(read(log)["X"].values, truth, rtol=1e-5)


@pytest.mark.posix("there one process ends another without a word to it")
def test_asked_to_end_it_leaves_the_meter_as_found_and_the_log_whole(start, instrument, tmp_path):
    before, log = set_otherwise(instrument), tmp_path / "run.nc"
    process = start("--log", log)
    process.stdout.readline()
    assert instrument.settings != before
    process.send_signal(signal.SIGTERM)
    process.communicate(timeout=30)
    assert process.returncode == 128 + signal.SIGTERM
    assert instrument.settings == before
    assert read(log).sizes["sweep"] >= 4

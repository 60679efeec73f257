"""Signals end a command that works with a meter, once, and never while it puts things in order."""

import ctypes
import gc
import signal
import sys
import time
from threading import Thread
from types import SimpleNamespace

import pytest
from rcskin.hardware.meter import termination
from rcskin.hardware.meter.termination import (
    Termination,
    interruptible,
    orderly_termination,
    raise_pending_signal,
    shielded,
)


class Deaf:
    """Is interrupted where Python lets no error out."""

    def __del__(self):
        signal.raise_signal(signal.SIGINT)
        for _ in range(1000):
            pass


def test_a_ctrl_c_that_is_lost_in_a_library_is_raised_at_the_next_look(capfd):
    lost = Deaf()
    with pytest.raises(KeyboardInterrupt), orderly_termination(), interruptible():
        del lost
        gc.collect()
        with shielded():
            raise_pending_signal()
        raise_pending_signal()
        pytest.fail("the work went on")
    assert capfd.readouterr() == ("", "")


@pytest.mark.posix("there is no SIGHUP")
def test_an_ignored_signal_stays_ignored(monkeypatch):
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with orderly_termination(), interruptible():
            signal.raise_signal(signal.SIGHUP)
            raise_pending_signal()
    finally:
        signal.signal(signal.SIGHUP, before)


class Clock:
    """A time that goes on by two seconds at each look."""

    now = 0.0

    def __call__(self):
        self.now += 2
        return self.now


@pytest.fixture
def apart(monkeypatch):
    """Signals are far apart."""
    monkeypatch.setattr(termination, "monotonic", Clock())


def test_each_ctrl_c_counts_while_the_meter_is_restored(apart):
    ending = Termination()
    with pytest.raises(KeyboardInterrupt), ending:
        ending.on_signal(signal.SIGINT)
    assert ending.interrupts == 0
    for count in (1, 2, 3):
        ending.on_signal(signal.SIGTERM)
        ending.on_signal(signal.SIGINT)
        assert ending.interrupts == count


def test_the_work_ends_once_whatever_signals_follow(apart):
    """Not a second time, also while the first exception is on its way out of the work."""
    ending, unwound = Termination(), []
    with pytest.raises(SystemExit) as ended, ending:
        try:
            ending.on_signal(signal.SIGTERM)
        finally:
            ending.on_signal(signal.SIGINT)
            unwound.append("work")
    ending.on_signal(signal.SIGINT)
    assert unwound == ["work"] and ended.value.code == 128 + signal.SIGTERM
    assert not ending.pending


def test_a_signal_while_the_meter_is_restored_ends_the_command_afterwards():
    done = []
    with pytest.raises(SystemExit) as ended, orderly_termination():
        with interruptible():
            done.append("work")
        signal.raise_signal(signal.SIGTERM)
        done.append("restored")
        with interruptible():
            done.append("written")
    assert done == ["work", "restored", "written"]
    assert ended.value.code == 128 + signal.SIGTERM


def test_writing_after_the_work_was_ended_can_be_ended_too(apart):
    ending = Termination()
    for _ in range(2):
        with pytest.raises(KeyboardInterrupt), ending:
            ending.on_signal(signal.SIGINT)
            pytest.fail("the work went on")


def test_a_console_of_windows_that_is_closed_is_kept_until_all_is_in_order(monkeypatch):
    kernel, handlers = "rcskin.hardware.meter.termination.sys", []
    keep = lambda handler, add: (handlers.append if add else handlers.remove)(handler)  # noqa: E731
    windll = SimpleNamespace(kernel32=SimpleNamespace(SetConsoleCtrlHandler=keep))
    monkeypatch.setattr(kernel, SimpleNamespace(**{**vars(sys), "platform": "win32"}))
    closing = getattr(signal, "SIGBREAK", None) or signal.SIGUSR1
    monkeypatch.setattr(signal, "SIGBREAK", closing, raising=False)
    monkeypatch.setattr(ctypes, "windll", windll, raising=False)
    monkeypatch.setattr(ctypes, "WINFUNCTYPE", lambda *types: lambda made: made, raising=False)
    with pytest.raises(SystemExit) as ended, orderly_termination(), interruptible():
        (closed,) = handlers
        assert closed(0) == closed(1) == 0
        system = Thread(target=closed, args=(2,))
        system.start()
        try:
            time.sleep(5)
        finally:
            assert system.is_alive()
    system.join(1)
    assert not system.is_alive() and handlers == []
    assert ended.value.code == 128 + closing

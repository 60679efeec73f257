"""Signals end a command that works with a meter, once, and never while it puts things in order."""

import ctypes
import gc
import signal
import time
from threading import Thread
from types import SimpleNamespace

import pytest
from rcskin.hardware.meter.restoring.termination import (
    Termination,
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
    with pytest.raises(KeyboardInterrupt), orderly_termination():
        del lost
        gc.collect()
        with shielded():
            raise_pending_signal()
        raise_pending_signal()
    assert capfd.readouterr() == ("", "")


@pytest.mark.posix("there is no SIGHUP")
def test_an_ignored_signal_stays_ignored(monkeypatch):
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with orderly_termination():
            signal.raise_signal(signal.SIGHUP)
            raise_pending_signal()
    finally:
        signal.signal(signal.SIGHUP, before)


def test_who_insists_gets_out(monkeypatch, capfd):
    ending = Termination(shields=1)
    monkeypatch.setattr("rcskin.hardware.meter.restoring.termination._ending", ending)
    for seconds, number in enumerate((15, 2, 15, 2, 15, 2), start=1):
        with shielded() as insisting:
            assert not insisting()
        later = 2 * seconds
        monkeypatch.setattr(
            "rcskin.hardware.meter.restoring.termination.monotonic", lambda now=later: now
        )
        ending.on_signal(number, None)
    with shielded() as insisting:
        assert insisting()
    err = capfd.readouterr().err
    assert "Ctrl-C 2 times more, a second apart, leaves them changed" in err and "once more" in err


def test_a_console_of_windows_that_is_closed_is_kept_until_all_is_in_order(monkeypatch):
    kernel, handlers = "rcskin.hardware.meter.restoring.windows_console.sys", []
    keep = lambda handler, add: (handlers.append if add else handlers.remove)(handler)  # noqa: E731
    windll = SimpleNamespace(kernel32=SimpleNamespace(SetConsoleCtrlHandler=keep))
    monkeypatch.setattr(kernel, SimpleNamespace(platform="win32"))
    closing = getattr(signal, "SIGBREAK", None) or signal.SIGUSR1
    monkeypatch.setattr(signal, "SIGBREAK", closing, raising=False)
    monkeypatch.setattr(ctypes, "windll", windll, raising=False)
    monkeypatch.setattr(ctypes, "WINFUNCTYPE", lambda *types: lambda made: made, raising=False)
    with pytest.raises(SystemExit) as ended, orderly_termination():
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

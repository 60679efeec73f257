"""Signals, processes and clocks of other systems."""

import asyncio
import builtins
import importlib
import multiprocessing
import multiprocessing.context
import os
import selectors
import signal
import subprocess
import sys
import time

OF_UNIX = {
    os: ("fork", "forkpty", "getpgid", "killpg", "sync", "mkfifo"),
    signal: ("SIGHUP", "SIGQUIT", "SIGALRM", "SIGUSR1", "pthread_sigmask", "setitimer", "alarm"),
}
MODULES = ("termios", "tty", "pty", "resource", "pwd", "grp", "fcntl")
OF_WINDOWS = ("SIGINT", "SIGTERM", "SIGABRT", "SIGFPE", "SIGILL", "SIGSEGV", "SIGBREAK")
SIGBREAK = 21
TICK = 1 / 64
"""Seconds between two values of Windows' clocks."""


def spawn_only(context):
    """Each process begins anew; it may run on every processor."""
    for name in ("sched_getaffinity", "posix_fadvise"):
        context.delattr(os, name, raising=False)
    spawn = multiprocessing.get_context("spawn")
    context.setattr(multiprocessing.context, "_concrete_contexts", {"spawn": spawn})
    context.setattr(multiprocessing, "get_all_start_methods", lambda: ["spawn"])
    default = multiprocessing.context._default_context
    context.setattr(default, "_default_context", spawn)
    context.setattr(default, "_actual_context", None)
    context.setattr(selectors, "DefaultSelector", selectors.SelectSelector)


def without_unix(context):
    """No signals but Windows', no terminals of Unix, and clocks that tick 64 times a second."""
    for module, names in OF_UNIX.items():
        for name in names:
            context.delattr(module, name, raising=False)
    context.setattr(builtins, "__import__", _hiding(builtins.__import__))
    context.setattr(importlib, "import_module", _absent(importlib.import_module))
    context.setattr(signal, "SIGBREAK", signal.Signals(SIGBREAK), raising=False)
    context.setattr(signal, "signal", _of_windows(signal.signal))
    context.setattr(os, "kill", _at_once(os.kill))
    context.setattr(subprocess.Popen, "send_signal", _two_alone(subprocess.Popen.send_signal))
    loop = asyncio.unix_events._UnixSelectorEventLoop
    context.setattr(loop, "add_signal_handler", _not_here)
    tracker = sys.modules.get("multiprocessing.resource_tracker")
    if tracker is not None:
        context.setattr(tracker, "_HAVE_SIGMASK", False)


def _hiding(call):
    """Libraries of this system, such as pyserial, go on importing what Windows lacks."""

    def import_(name, globals=None, *more, **named):
        importer = str((globals or {}).get("__name__", "")).partition(".")[0]
        if name in MODULES and importer in ("rcskin", "_pytest"):
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)
        return call(name, globals, *more, **named)

    return import_


def _absent(call):
    def import_module(name, package=None):
        importer = sys._getframe(1).f_globals
        return __import__(name, importer) if name in MODULES else call(name, package)

    return import_module


def coarse_clocks(context):
    for name, unit in {"time": 1, "monotonic": 1, "time_ns": 10**9, "monotonic_ns": 10**9}.items():
        context.setattr(time, name, _ticking(getattr(time, name), unit))
    info = time.get_clock_info
    context.setattr(time, "get_clock_info", lambda name: _coarse(info(name)))


def _coarse(info):
    if info.implementation != "clock_gettime(CLOCK_MONOTONIC)":
        return info
    return type(info)(**{**vars(info), "resolution": TICK})


def _ticking(clock, unit):
    tick = TICK * unit if unit == 1 else int(TICK * unit)
    return lambda: clock() // tick * tick


def _not_here(*arguments):
    raise NotImplementedError


def _of_windows(call):
    def handle(number, handler):
        if number not in [getattr(signal, name) for name in OF_WINDOWS]:
            raise ValueError("invalid signal value")
        return call(number, handler)

    return handle


def _at_once(call):
    """Any signal ends a process without a word to it; 0 is Ctrl-C, for the whole console."""

    def kill(process, number):
        if number == 0 or process == os.getpid():
            raise AssertionError(f"os.kill(PROCESS, {number}) ends the caller, too, on Windows")
        call(process, signal.SIGKILL)

    return kill


def _two_alone(call):
    """A process can be ended; the console's own signals go to groups of processes."""

    def send_signal(process, number):
        if number not in (signal.SIGTERM, signal.SIGKILL):
            raise ValueError(f"Unsupported signal: {number}")
        call(process, number)

    return send_signal

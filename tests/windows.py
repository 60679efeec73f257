"""Windows as far as it can be imitated: calls that it lacks are taken away, open files stay.

`python windows.py ARGUMENTS` runs rcskin so.
"""

import asyncio
import multiprocessing
import multiprocessing.context
import os
import signal
import sys
from pathlib import Path

OF_UNIX = {
    os: ("fork", "forkpty", "sched_getaffinity", "getpgid", "killpg", "sync"),
    signal: ("SIGHUP", "SIGQUIT", "SIGALRM", "SIGUSR1", "pthread_sigmask", "setitimer", "alarm"),
}
MODULES = ("termios", "tty", "pty", "resource", "pwd", "grp")
REMOVING = ("unlink", "remove", "rename", "replace", "rmdir")
OPEN = Path("/proc/self/fd")


def take_away(context):
    """Takes all that away. context: a pytest.MonkeyPatch."""
    for module, names in OF_UNIX.items():
        for name in names:
            context.delattr(module, name, raising=False)
    for name in MODULES:
        context.setitem(sys.modules, name, None)
    for name in REMOVING:
        context.setattr(os, name, _refusing(getattr(os, name)))
    loop = asyncio.unix_events._UnixSelectorEventLoop
    context.setattr(loop, "add_signal_handler", _not_here)
    spawn = multiprocessing.get_context("spawn")
    context.setattr(multiprocessing.context, "_concrete_contexts", {"spawn": spawn})
    context.setattr(multiprocessing, "get_all_start_methods", lambda: ["spawn"])
    context.setattr(multiprocessing.context._default_context, "_default_context", spawn)
    context.setattr(multiprocessing.context._default_context, "_actual_context", None)


def _not_here(*arguments):
    raise NotImplementedError


def _refusing(call):
    """The call, which refuses what is open in this process, or a folder with what is."""

    def refuse(*paths, **options):
        places = [_place(path, options) for path in paths]
        for file in _open_files():
            if any(file == place or file.startswith(f"{place}/") for place in places):
                raise PermissionError(13, "The process cannot access the file", file)
        return call(*paths, **options)

    return refuse


def _place(path, options):
    folder = options.get("dir_fd") or options.get("src_dir_fd")
    beneath = os.readlink(OPEN / str(folder)) if folder is not None else ""
    return os.path.realpath(os.path.join(beneath, os.fspath(path)))


def _open_files():
    found = []
    for entry in os.listdir(OPEN):
        try:
            found.append(os.readlink(OPEN / entry))
        except OSError:  # the listing itself
            continue
    return [path for path in found if os.path.isfile(path)]


if __name__ == "__main__":
    import pytest

    with pytest.MonkeyPatch.context() as patch:
        take_away(patch)
        from rcskin.__main__ import main

        main()

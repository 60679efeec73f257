"""What rcskin calls of Windows' kernel32 through ctypes."""

import ctypes
import os
from types import SimpleNamespace


def add(context):
    """Adds `ctypes.windll` with the free memory of this machine and a console without events."""
    kernel = SimpleNamespace(
        GlobalMemoryStatusEx=_state_memory, SetConsoleCtrlHandler=lambda handler, add: 1
    )
    context.setattr(ctypes, "windll", SimpleNamespace(kernel32=kernel), raising=False)
    context.setattr(ctypes, "WINFUNCTYPE", ctypes.CFUNCTYPE, raising=False)


def _state_memory(reference):
    status = reference._obj
    assert status.length == ctypes.sizeof(status)
    status.free = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_AVPHYS_PAGES")
    return 1

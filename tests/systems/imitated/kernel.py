"""What rcskin calls of Windows' kernel32 through ctypes."""

import ctypes
from types import SimpleNamespace


def add(context):
    """Adds `ctypes.windll` with a console without events."""
    kernel = SimpleNamespace(SetConsoleCtrlHandler=lambda handler, add: 1)
    context.setattr(ctypes, "windll", SimpleNamespace(kernel32=kernel), raising=False)
    context.setattr(ctypes, "WINFUNCTYPE", ctypes.CFUNCTYPE, raising=False)

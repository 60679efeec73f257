"""Checks before work begins that it fits into the free memory and on the disk."""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path

from .errors import InputError

SHARE = 0.9
"""Fraction of the free space that one piece of work may take; the rest is a reserve."""
ALWAYS_FREE = 2**20
"""Bytes that are not checked: an interpreter takes a hundred times as much, a question 50 µs."""
PREFIXES = ("bytes", "kB", "MB", "GB", "TB", "PB")
CONTROL_GROUP = Path("/sys/fs/cgroup")
"""Folder in which Linux states the memory limits of a container."""


def check_memory(needed: float, what: str, instead: str) -> None:
    """Raises InputError if more bytes are needed than memory is free.

    what: the data in plural. instead: advice for the user.
    """
    if needed > ALWAYS_FREE and needed > (free := SHARE * free_memory()):
        raise InputError(
            f"{what} would need {amount(needed)} of memory; at most {amount(free)} are free here: "
            f"{instead}"
        )


def check_count(name: str, count: int, bytes_of_each: float, instead: str) -> None:
    """Raises InputError, with the largest count, if so many do not fit in the free memory.

    name: of the argument. bytes_of_each: memory for one. instead: advice for the user.
    """
    most = int(SHARE * free_memory() / bytes_of_each)
    if count > most:
        raise InputError(
            f"`{name}` must be at most {most} here, since each takes {amount(bytes_of_each)} of "
            f"memory, got {count}: {instead}"
        )


def check_disk(needed: float, path: Path, what: str, instead: str) -> None:
    """Raises InputError if more bytes are needed than the disk of a path has free."""
    folder = path.absolute().parent
    free = SHARE * shutil.disk_usage(folder).free if folder.is_dir() else needed
    if needed > free:
        raise InputError(
            f"{path}: {what} need {amount(needed)}; at most {amount(free)} are free on that disk: "
            f"{instead}"
        )


def amount(size: float) -> str:
    """A number of bytes with a unit, such as 3.2 GB."""
    power = 0
    while size >= 1000 and power < len(PREFIXES) - 1:
        size, power = size / 1000, power + 1
    return f"{size:.2g} {PREFIXES[power]}" if size < 100 else f"{size:.0f} {PREFIXES[power]}"


def free_memory() -> float:
    """Bytes of memory available without swapping, as the system estimates them."""
    if sys.platform == "win32":
        return _free_on_windows()
    found = [each for each in (_free_on_linux(), _free_in_group(), _limit()) if each is not None]
    if found:
        return min(found)
    return float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))  # macOS: all memory


def _free_on_linux() -> float | None:
    try:
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
    except OSError:
        return None
    available = [line.split()[1] for line in lines if line.startswith("MemAvailable:")]
    return 1024.0 * int(available[0]) if available else None


def _free_in_group() -> float | None:
    try:
        limit, used = (
            (CONTROL_GROUP / f"memory.{name}").read_text() for name in ("max", "current")
        )
        return max(0.0, float(limit) - float(used))
    except (OSError, ValueError):  # no such group, or "max": no limit
        return None


def _limit() -> float | None:
    """The limit of `ulimit -v`; None if the system has no such limit."""
    if sys.platform == "win32":
        return None
    try:
        import resource
    except ImportError:
        return None
    soft, _ = resource.getrlimit(resource.RLIMIT_AS)
    return None if soft == resource.RLIM_INFINITY else float(soft)


def _free_on_windows() -> float:
    """Free memory by GlobalMemoryStatusEx."""
    import ctypes

    class Status(ctypes.Structure):
        _fields_ = [("length", ctypes.c_ulong), ("load", ctypes.c_ulong)] + [
            (name, ctypes.c_ulonglong)
            for name in ("total", "free", "page_total", "page_free", "all", "virtual", "extended")
        ]

    status = Status(length=ctypes.sizeof(Status))
    ctypes.windll.kernel32.GlobalMemoryStatusEx(ctypes.byref(status))  # pyright: ignore
    return float(status.free)

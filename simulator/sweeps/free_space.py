"""Checks before work begins that it fits into the free memory and on the disk."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from .errors import InputError

SHARE = 0.9
"""Fraction of the free space that one piece of work may take; the rest is a reserve."""
ALWAYS_FREE = 2**20
"""Bytes that are not checked: an interpreter takes a hundred times as much, a question 50 µs."""
PREFIXES = ("bytes", "kB", "MB", "GB", "TB", "PB")
CONTROL_GROUP = Path("/sys/fs/cgroup")
"""Folder in which Linux states the limits of control groups."""


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
    """Bytes of memory that this process can take without swapping."""
    import psutil

    free = [float(psutil.virtual_memory().available), *_free_in_groups()]
    if psutil.LINUX:  # `ulimit -v`, which other systems do not apply
        process = psutil.Process()
        limit, _ = process.rlimit(psutil.RLIMIT_AS)
        if limit != psutil.RLIM_INFINITY:
            free.append(max(0.0, limit - process.memory_info().vms))
    return min(free)


def _free_in_groups() -> Iterator[float]:
    """Bytes that each control group of this process allows, as of a container or a batch job.

    psutil knows no such limits. Cached files count as free: the system drops them.
    """
    with suppress(OSError):  # other systems have none
        own = Path("/proc/self/cgroup").read_text(encoding="ascii").rpartition("0::/")[2].strip()
        for group in (CONTROL_GROUP / own, *(CONTROL_GROUP / own).parents):
            with suppress(OSError, ValueError):  # it does not limit memory, or by "max": nothing
                limit, used, stated = (
                    (group / f"memory.{name}").read_text() for name in ("max", "current", "stat")
                )
                cached = dict(map(str.split, stated.splitlines()))["inactive_file"]
                yield max(0.0, float(limit) - float(used) + float(cached))

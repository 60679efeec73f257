"""Kernels compiled by numba and cached on disk between runs.

The cache is in the user's cache folder, or in NUMBA_CACHE_DIR if that is set. It is never beside
the source, where numba would put it: pip does not know these files and leaves them when it removes
a package, and the remaining folder hides the next installation. Installations of the same source
share their kernels. No cache file and no folder is required: a kernel that cannot be read is
compiled again. If several processes need the same kernel for the first time, one compiles it and
the others wait for the cached result.

Kernels are loops over numbers. Array assignments and whole-array arithmetic take numba seconds to
compile; the loop takes a tenth of that.
"""

from __future__ import annotations

import hashlib
import inspect
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from numbers import Number
from pathlib import Path
from typing import Any, TypeVar

import platformdirs
from numba import config, njit
from numba.core.caching import InTreeCacheLocator
from numba.core.errors import NumbaError
from numba.extending import is_jitted

Kernel = TypeVar("Kernel", bound=Callable[..., Any])
PATIENCE, POLL = 120.0, 0.01
"""Seconds to wait for another process that compiles the same kernel, and between two attempts."""
_SETTINGS: Any = config  # numba makes its names from the environment
_CHOOSING = threading.Lock()
"""Lock while a setting differs from that of the process."""


class SourceLocator(InTreeCacheLocator):
    """Names the cache folder of a kernel after its source, wherever that is installed.

    numba takes it by `NUMBA_CACHE_LOCATOR_CLASSES`, and fixes the folder of a function with it.
    """

    def __init__(self, function: Callable[..., Any], path: str) -> None:
        super().__init__(function, path)
        self._stamp = _stamp(function)
        users = platformdirs.user_cache_path("rcskin", appauthor=False) / "kernels"
        self._folder = str(Path(_SETTINGS.CACHE_DIR or users) / self._stamp[:40])

    def get_cache_path(self) -> str:
        """The folder."""
        return self._folder

    def get_source_stamp(self) -> str:
        """What differs once a cached kernel is outdated."""
        return self._stamp


def compiled(**options: Any) -> Callable[[Kernel], Kernel]:
    """`numba.njit` with these options, cached between runs."""

    def compile_once(function: Kernel) -> Kernel:
        uncached: Any = njit(**options)
        try:
            with _own_locator():
                kernel: Any = njit(cache=True, **options)(function)
        except (RuntimeError, OSError):  # no folder can be written, no source can be read
            return uncached(function)
        if kernel is not function:  # NUMBA_DISABLE_JIT leaves it as it is
            kernel.compile = _safe_compile(kernel, uncached)
        return kernel

    return compile_once


@contextmanager
def _own_locator() -> Iterator[None]:
    """Within the block, numba caches by `SourceLocator`, in the whole process."""
    with _CHOOSING:
        before = _SETTINGS.CACHE_LOCATOR_CLASSES
        _SETTINGS.CACHE_LOCATOR_CLASSES = f"{__name__}.{SourceLocator.__name__}"
        try:
            yield
        finally:
            _SETTINGS.CACHE_LOCATOR_CLASSES = before


def _safe_compile(kernel: Any, uncached: Callable[..., Any]) -> Callable[[Any], Any]:
    """The method `compile` of a kernel, for which no cache file is required.

    Processes take turns: numba's index names wrong files if two processes write it at once. A file
    that cannot be read is removed and made again. If that fails, too, nothing is cached.
    uncached: makes a kernel that is not cached of a function.
    """
    function: Any = kernel.py_func
    compile_cached, folder = kernel.compile, Path(kernel.stats.cache_path)
    name = f"{function.__name__}-{function.__code__.co_firstlineno}"

    def compile_safely(sig: Any) -> Any:
        with _turn(folder / f"{name}.lock"):
            for _ in range(2):
                try:
                    return compile_cached(sig)
                except NumbaError:
                    raise
                except Exception:  # whatever unpickling a corrupt file raises, a full disk
                    for file in folder.glob(f"*.{name}.*.nb[ic]"):
                        with suppress(OSError):
                            file.unlink()
        same = uncached(function)
        same.compile(sig)
        for result in same.overloads.values():
            kernel.add_overload(result)
        return compile_cached(sig)

    return compile_safely


@contextmanager
def _turn(path: Path) -> Iterator[None]:
    """Waits for this process's turn, of which all its threads make use.

    There are no turns if no lock can be made, and no more after PATIENCE.
    """
    from filelock import FileLock, Timeout

    lock = FileLock(path, thread_local=False, is_singleton=True)
    taken = False
    with suppress(OSError, NotImplementedError, Timeout):
        lock.acquire(timeout=PATIENCE, poll_interval=POLL)
        taken = True
    try:
        yield
    finally:
        if taken:
            lock.release()


def _stamp(function: Callable[..., Any]) -> str:
    """Digest of all source that is compiled into a kernel.

    numba reads only the file of the function. Kernels and constants imported from other files are
    compiled in as well, and so is the order of fields of named tuples; a kernel cached before one
    of these changed is outdated.
    """
    digest, used, seen = hashlib.sha256(), [function], set()
    while used:
        known = used.pop()
        path = inspect.getfile(known)
        if path in seen:
            continue
        seen.add(path)
        digest.update(Path(path).read_bytes())
        for name, value in sorted(known.__globals__.items()):
            if isinstance(value, Number):
                digest.update(f"{name} = {value!r}".encode())
            elif isinstance(value, type) and issubclass(value, tuple):
                digest.update(f"{name}: {getattr(value, '_fields', ())}".encode())
            elif is_jitted(value):
                used.append(value.py_func)
    return digest.hexdigest()

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
from contextlib import contextmanager
from numbers import Number
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import platformdirs
from numba import config, njit
from numba.core.caching import FunctionCache, IndexDataCacheFile
from numba.extending import is_jitted

if TYPE_CHECKING:
    from filelock import FileLock

Kernel = TypeVar("Kernel", bound=Callable[..., Any])
PATIENCE = 120.0
"""Seconds to wait for another process that compiles the same kernel."""
_CHOOSING = threading.Lock()
"""Lock while numba's settings differ from those of the process."""


class KernelCache(FunctionCache):
    """Cache of one compiled function; a corrupt or unwritable file counts as a cache miss.

    After a miss, processes take turns: numba's index names wrong files if two processes write it at
    once. The folder is named after the source, wherever that is installed. numba documents how to
    choose the folder that contains it, but nothing for corrupt files, turns and imported sources.
    Therefore this class uses undocumented parts of numba.
    """

    _turn: FileLock | None = None

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)
        stamp = _stamp(function)
        self._cache_path = str(Path(self._cache_path).with_name(stamp[:40]))
        self._impl.locator._cache_path = self._cache_path
        self._cache_file = IndexDataCacheFile(self._cache_path, self._impl.filename_base, stamp)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The compiled function for these types, or None if this process has to compile it."""
        found = self._loaded(sig, target_context)
        if found is None and self._take_turn():
            found = self._loaded(sig, target_context)
        return found

    def _loaded(self, sig: Any, target_context: Any) -> Any:
        try:
            return super().load_overload(sig, target_context)
        except Exception:  # whatever unpickling a spoilt file raises
            self._forget()
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Stores a compiled function if the folder can be written."""
        try:
            super().save_overload(sig, data)
        except Exception:  # a full disk, a folder that went away, a spoilt index
            self._forget()

    def _take_turn(self) -> bool:
        """Waits for this process's turn; False if there are no turns: no folder can be written."""
        from filelock import FileLock, Timeout

        try:
            self._impl.locator.ensure_cache_path()
            turn = FileLock(Path(self.cache_path) / f"{self._impl.filename_base}.lock")
            turn.acquire(timeout=PATIENCE)
        except (OSError, NotImplementedError, Timeout):
            return False
        self._turn = turn
        return True

    def end_turn(self) -> None:
        """Ends this process's turn: another process may compile the function."""
        if self._turn is not None:
            self._turn.release()
            self._turn = None

    def _forget(self) -> None:
        try:
            self.flush()
        except OSError:
            self.disable()


def compiled(**options: Any) -> Callable[[Kernel], Kernel]:
    """`numba.njit` with these options, cached between runs."""

    def compile_once(function: Kernel) -> Kernel:
        kernel: Any = njit(**options)(function)
        if kernel is not function:  # NUMBA_DISABLE_JIT leaves it as it is
            try:
                with _in_folder_of_user():
                    kernel._cache = KernelCache(function)
            except (RuntimeError, OSError):  # no folder can be written, no source can be read
                pass
            else:
                kernel.compile = _in_turn(kernel.compile, kernel._cache)
        return kernel

    return compile_once


@contextmanager
def _in_folder_of_user() -> Iterator[None]:
    """Within the block, numba caches in the user's cache folder, or in NUMBA_CACHE_DIR.

    The two settings apply to the whole process, also to functions of other packages.
    """
    settings: Any = config  # numba makes its names from the environment
    with _CHOOSING:
        before = settings.CACHE_DIR, settings.CACHE_LOCATOR_CLASSES
        folder = platformdirs.user_cache_path("rcskin", appauthor=False) / "kernels"
        settings.CACHE_DIR = settings.CACHE_DIR or str(folder)
        settings.CACHE_LOCATOR_CLASSES = "UserProvidedCacheLocator"
        try:
            yield
        finally:
            settings.CACHE_DIR, settings.CACHE_LOCATOR_CLASSES = before


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


def _in_turn(compile_one: Callable[[Any], Any], kept: KernelCache) -> Callable[[Any], Any]:
    def compile_in_turn(sig: Any) -> Any:
        try:
            return compile_one(sig)
        finally:
            kept.end_turn()

    return compile_in_turn

"""Kernels compiled by numba, kept between runs where a folder for them can be written.

They are kept in the user's cache folder, or in NUMBA_CACHE_DIR where that is set; never beside the
source, where numba would put them: pip does not know these files and leaves them when it removes a
package, and the folder that remains hides the next installation. No kept file, and no folder, is
needed: what cannot be read is compiled anew. Of several processes that need the same kernel for the
first time one compiles it, and the others wait for what it keeps.

Kernels are loops over numbers: an array assigned to a part of another, or arithmetic of whole
arrays, takes numba seconds to compile where the loop takes a tenth of that.
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
from numba.core.caching import FunctionCache
from numba.extending import is_jitted

if TYPE_CHECKING:
    from filelock import FileLock

Kernel = TypeVar("Kernel", bound=Callable[..., Any])
PATIENCE = 120.0
"""s that another process may take to compile a kernel before this one compiles it, too."""
_CHOOSING = threading.Lock()
"""Held while numba's settings differ from the process's own."""


class KernelCache(FunctionCache):
    """What numba keeps of a function; a file that is spoilt or cannot be written is as none.

    Who misses a function takes turns with other processes: numba's own index of what is kept names
    wrong files where two write into it at once. numba documents a way to choose the folder, but
    none for spoilt files, turns and imported sources: hence this use of what it does not document.
    """

    _turn: FileLock | None = None

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)
        self._cache_file._source_stamp = _stamp(function)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The compiled function of these types, or None; then it is this process's turn."""
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
        """Keep a compiled function, where that can be done."""
        try:
            super().save_overload(sig, data)
        except Exception:  # a full disk, a folder that went away, a spoilt index
            self._forget()

    def _take_turn(self) -> bool:
        """Whether there are turns: no folder that can be written has any."""
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
        """Let another process compile the function."""
        if self._turn is not None:
            self._turn.release()
            self._turn = None

    def _forget(self) -> None:
        try:
            self.flush()
        except OSError:
            self.disable()


def compiled(**options: Any) -> Callable[[Kernel], Kernel]:
    """`numba.njit` with these options, kept between runs."""

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
    """Within the block numba chooses the user's cache folder, or NUMBA_CACHE_DIR, for a function.

    These two settings hold for the whole process and for other packages' functions, too.
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
    """Digest of the source that is compiled into kernels of a function's module.

    numba itself reads the file of the function only. Kernels and numbers imported from other files
    are compiled in, too, and a kernel kept before one of these changed is of no use.
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

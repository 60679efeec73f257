"""Kernels compiled by numba, kept between runs where a folder for them can be written.

They are kept beside the source, or in NUMBA_CACHE_DIR, or in the user's own cache folder where the
package cannot be written. No kept file, and no folder, is needed: what cannot be read is compiled
anew. Of several processes that need the same kernel for the first time one compiles it, and the
others wait for what it keeps.

Kernels are loops over numbers: an array assigned to a part of another, or arithmetic of whole
arrays, takes numba seconds to compile where the loop takes a tenth of that.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from numba import njit
from numba.core.caching import FunctionCache

if TYPE_CHECKING:
    from filelock import FileLock

Kernel = TypeVar("Kernel", bound=Callable[..., Any])
PATIENCE = 120.0
"""s that another process may take to compile a kernel before this one compiles it, too."""


class Kept(FunctionCache):
    """What numba keeps of a function; a file that is spoilt or cannot be written is as none.

    Who misses a function takes turns with other processes: numba's own index of what is kept names
    wrong files where two write into it at once.
    """

    _turn: FileLock | None = None

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
                kernel._cache = Kept(function)
            except RuntimeError:  # no folder can be written
                pass
            else:
                kernel.compile = _in_turn(kernel.compile, kernel._cache)
        return kernel

    return compile_once


def _in_turn(compile_one: Callable[[Any], Any], kept: Kept) -> Callable[[Any], Any]:
    def compile_in_turn(sig: Any) -> Any:
        try:
            return compile_one(sig)
        finally:
            kept.end_turn()

    return compile_in_turn

"""Kernels compiled by numba, kept between runs where a folder for them can be written.

They are kept beside the source, or in NUMBA_CACHE_DIR, or in the user's own cache folder where the
package cannot be written. No kept file, and no folder, is needed: what cannot be read is compiled
anew.

Kernels are loops over numbers: an array assigned to a part of another, or arithmetic of whole
arrays, takes numba seconds to compile where the loop takes a tenth of that.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from numba import njit
from numba.core.caching import FunctionCache

Kernel = TypeVar("Kernel", bound=Callable[..., Any])


class Kept(FunctionCache):
    """What numba keeps of a function; a file that is spoilt or cannot be written is as none."""

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The compiled function of these types, or None."""
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
        return kernel

    return compile_once

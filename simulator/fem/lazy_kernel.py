"""Kernels that Python reads until their work is worth loading numba: a few presses never are.

To import numba and load what it compiled takes as long as some hundred sweeps of a small skin. Both
ways give the same bits.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

import numpy as np

WORTH = 0.3
"""s of a kernel's readable twin, altogether, that loading numba is worth."""


class LazyKernel:
    """A kernel and its readable twin.

    kernel: gives it, of the module `fem.kernels`, which is imported at need. cost: s that the twin
    takes for such arguments, about.
    """

    spent = 0.0

    def __init__(
        self,
        kernel: Callable[[Any], Callable[..., Any]],
        twin: Callable[..., Any],
        cost: Callable[..., float],
    ) -> None:
        self._kernel, self._twin, self._cost = kernel, twin, cost

    def __call__(self, *arguments: Any) -> Any:
        """What the kernel returns."""
        if "numba" in sys.modules:
            return self._kernel(_kernels())(*map(_in_c_order, arguments))
        LazyKernel.spent += self._cost(*arguments)
        if LazyKernel.spent > WORTH:
            _kernels()
        return self._twin(*arguments)


def _kernels() -> Any:
    from . import kernels

    return kernels


def _in_c_order(argument: Any) -> Any:
    """The same or its copy: for another order of axes a kernel would be compiled anew.

    Arrays of one axis, which kernels write into, are never copied.
    """
    if isinstance(argument, np.ndarray) and argument.ndim > 1 and not argument.flags.c_contiguous:
        return argument.copy(order="C")
    return argument

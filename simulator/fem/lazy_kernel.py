"""Kernels that run as plain Python until their work is worth loading numba.

A few presses are not: importing numba and loading the compiled code takes as long as some hundred
sweeps of a small skin. Both ways give the same bits.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

import numpy as np

WORTH = 0.3
"""Total time of readable twins, s, from which on loading numba pays."""


class LazyKernel:
    """A kernel and its readable twin.

    kernel: returns it from the module `fem.kernels`, which is imported on demand. cost: approximate
    time of the twin for these arguments, s.
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
        """Call the kernel or its twin."""
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
    """The argument or a copy in C order: a kernel would be compiled again for another order of
    axes.

    Arrays of one axis, which kernels write into, are never copied.
    """
    if isinstance(argument, np.ndarray) and argument.ndim > 1 and not argument.flags.c_contiguous:
        return argument.copy(order="C")
    return argument

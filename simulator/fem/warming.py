"""Kernels that Python reads until their work is worth loading numba: a few presses never are.

To import numba and load what it compiled takes as long as some hundred sweeps of a small skin. Both
ways give the same bits.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from importlib import import_module
from typing import Any

import numpy as np

WORTH = 0.3
"""s of a kernel's readable twin, altogether, that loading numba is worth."""


class Warming:
    """A kernel of `fem.kernels` and its readable twin.

    cost: s that the twin takes for such arguments, about.
    """

    spent = 0.0

    def __init__(self, twin: Callable[..., Any], cost: Callable[..., float]) -> None:
        self._twin, self._cost = twin, cost
        self._name = twin.__name__.removesuffix("_readable")

    def __call__(self, *arguments: Any) -> Any:
        """What the kernel returns."""
        if "numba" in sys.modules:
            kernel = getattr(import_module(".kernels", __package__), self._name)
            return kernel(*map(_in_c_order, arguments))
        Warming.spent += self._cost(*arguments)
        if Warming.spent > WORTH:
            import_module(".kernels", __package__)
        return self._twin(*arguments)


def _in_c_order(argument: Any) -> Any:
    """The same or its copy: for another order of axes a kernel would be compiled anew.

    Arrays of one axis, which kernels write into, are never copied.
    """
    if isinstance(argument, np.ndarray) and argument.ndim > 1 and not argument.flags.c_contiguous:
        return argument.copy(order="C")
    return argument

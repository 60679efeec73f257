"""Kernels that Python reads until their work is worth loading numba: a few presses never are.

To import numba and load what it compiled takes as long as some hundred sweeps of a small skin. Both
ways give the same bits.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from importlib import import_module
from typing import Any

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
            return getattr(import_module(".kernels", __package__), self._name)(*arguments)
        Warming.spent += self._cost(*arguments)
        if Warming.spent > WORTH:
            import_module(".kernels", __package__)
        return self._twin(*arguments)

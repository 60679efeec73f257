"""Distributions as even steps, each of which stands for a normal distribution around it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

OVERLAP = 0.5
"""Deviation that a value stands for, over the step to the next: their sum is flat to 1 %."""


def covered(quantile: Callable[[NDArray], NDArray], count: int) -> tuple[NDArray, NDArray, float]:
    """So many steps over a distribution, the chance of each, and the deviation it stands for."""
    draws = quantile((np.arange(2000) + 0.5) / 2000)
    low, high = quantile(np.array([0.0, 1.0]))
    if not high > low:
        return np.array([low]), np.ones(1), 0.0
    edges = np.linspace(low, high, count + 1)
    counts, _ = np.histogram(draws, edges)
    step = edges[1] - edges[0]
    return (edges[:-1] + edges[1:]) / 2, np.maximum(counts, 1) / counts.sum(), OVERLAP * step

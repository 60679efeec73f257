"""Distributions approximated by normal distributions at equally spaced values."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

OVERLAP = 0.5
"""Standard deviation of each value over the step to the next: their sum is flat to 1 %."""


def normal_mixture(
    quantile: Callable[[NDArray], NDArray], count: int
) -> tuple[NDArray, NDArray, float]:
    """Values at `count` equal steps of a distribution, their probabilities and their deviation."""
    draws = quantile((np.arange(2000) + 0.5) / 2000)
    low, high = quantile(np.array([0.0, 1.0]))
    if not high > low:
        return np.array([low]), np.ones(1), 0.0
    edges = np.linspace(low, high, count + 1)
    counts, _ = np.histogram(draws, edges)
    step = edges[1] - edges[0]
    return (edges[:-1] + edges[1:]) / 2, np.maximum(counts, 1) / counts.sum(), OVERLAP * step

"""Statistics of features that are added part by part."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...arrays import Real

QUANTILES = {"q01": 0.01, "q10": 0.1, "q50": 0.5, "q90": 0.9, "q99": 0.99}


class RunningStatistics:
    """Extrema, mean, standard deviation and quantiles of vectors.

    Quantiles are those of the parts averaged by their counts, exact for one part, as LeRobot joins
    episodes.
    """

    def __init__(self) -> None:
        self.count, self._values = 0, dict[str, Real]()

    def add(self, values: NDArray[Any]) -> None:
        """Add a part. values: shape (row, number)."""
        rows = values.astype(np.float64)
        part = {
            "min": rows.min(axis=0),
            "max": rows.max(axis=0),
            "mean": rows.mean(axis=0),
            "std": rows.std(axis=0),
            **dict(zip(QUANTILES, np.quantile(rows, [*QUANTILES.values()], axis=0), strict=True)),
        }
        self._join(part, len(rows))

    def join(self, other: RunningStatistics) -> None:
        """Add all parts of other statistics."""
        self._join(other._values, other.count)

    def _join(self, part: dict[str, Real], count: int) -> None:
        if self.count == 0:
            self.count, self._values = count, dict(part)
            return
        own, whole = self._values, self.count + count
        weight = count / whole
        apart = part["mean"] - own["mean"]
        variance = (1 - weight) * own["std"] ** 2 + weight * part["std"] ** 2
        averaged = {
            name: own[name] + weight * (part[name] - own[name]) for name in ("mean", *QUANTILES)
        }
        self._values = {
            "min": np.minimum(own["min"], part["min"]),
            "max": np.maximum(own["max"], part["max"]),
            **averaged,
            "std": np.sqrt(variance + weight * (1 - weight) * apart**2),
        }
        self.count = whole

    def values(self, shape: tuple[int, ...]) -> dict[str, Any]:
        """The statistics as nested lists of this shape by name, and `count`."""
        return {
            **{name: each.reshape(shape).tolist() for name, each in self._values.items()},
            "count": [self.count],
        }

"""What a meter reads of pressed pixels, turned so that its errors are 1 and independent."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from simulator.distribution import AnyDistribution
from simulator.frequency import laplace_variable
from simulator.limits.hypotheses import Pixel
from simulator.limits.meter import error_model
from simulator.observation import observed
from simulator.progress import Track, silent
from simulator.reduced import Reduced
from simulator.reduction import pixel_touches, reduce
from simulator.scene import Scene

RTOL = 1e-4
LEAST_FACTOR, LARGEST_FACTOR = 0.5, 3.0
"""Trained on at least."""


class Readings:
    """One skin, known, and its meter: from pixels and factors to whitened readings."""

    def __init__(self, scene: Scene, presses: AnyDistribution, against_rest: int = 0) -> None:
        """presses: factors that are asked for. Raises InputError for a meter without noise."""
        self.scene = scene
        self.model = error_model(scene, len(scene.frequencies), against_rest)
        self._factors = (
            min(LEAST_FACTOR, float(presses.low)),
            max(LARGEST_FACTOR, float(presses.high)),
        )

    def train(self, track: Track = silent) -> None:
        """Train the reduced model, if it is not yet, and show that this goes on."""
        for _ in track([self.scene.name], "training"):
            _ = self._reduced

    def of(self, pixels: Sequence[Pixel], factors: NDArray[np.float64]) -> NDArray[np.float64]:
        """Readings of the same pixels pressed in many ways, shape (press, number).

        pixels: (row, column) from 0. factors: of each, shape (pixel, press).
        """
        cells = np.array([i * self.scene.pixels.columns + j for i, j in pixels], dtype=np.int64)
        count = factors.shape[1]
        return self.of_each(
            np.tile(cells, count), factors.T.ravel() - 1, np.arange(count + 1) * len(cells)
        )

    def of_each(
        self, cells: NDArray[np.int64], rises: NDArray[np.float64], starts: NDArray[np.int64]
    ) -> NDArray[np.float64]:
        """Readings of many presses, see `ReducedSkin.sweeps`; shape (press, number)."""
        frequency = self.scene.frequencies
        s = laplace_variable(frequency, self.scene.skin.foam.loss)
        Z = self._reduced.skin(None).sweeps(cells, rises, starts, s)
        return self.model.whitened(observed(self.scene.leads.seen_through(Z, frequency)))

    @cached_property
    def _reduced(self) -> Reduced:
        return reduce(self.scene, RTOL, pixel_touches(self.scene, self._factors))

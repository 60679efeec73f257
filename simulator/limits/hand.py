"""What a meter reads when a hand presses beside what it means, on a skin that is known."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from simulator.distribution import AnyDistribution, truncated_normal
from simulator.frequency import laplace_variable
from simulator.limits.hypotheses import Hypothesis
from simulator.limits.meter import error_model
from simulator.limits.readings import LARGEST_FACTOR, LEAST_FACTOR
from simulator.observation import observed
from simulator.reduced import Reduced
from simulator.reduction import Case, reduce
from simulator.scene import Pixels, Scene

RTOL = 1e-3
CELLS = 3
"""Along each side of a pixel, that touches are laid on by the area they cover."""
CUT = 3.0
"""Deviations beyond which no hand presses."""
MOST_TOUCHES = 2
AT_ONCE = 20_000
Array = NDArray[np.float64]


class Hand:
    """Rectangles on a skin, pressed here and there, more or less: what the meter reads of them.

    presses: factors of capacitance. size: sides of a touch along x and y, m. offset: standard
    deviation of its middle from what was meant, along each side, over that side. What would lie
    beyond the skin is cut off.
    """

    def __init__(
        self,
        scene: Scene,
        presses: AnyDistribution,
        *,
        size: tuple[float, float],
        offset: float = 0.0,
        against_rest: int = 0,
    ) -> None:
        """Raises InputError for a meter without noise."""
        skin, pixels = scene.skin, scene.pixels
        self.scene, self._presses, self._offset = scene, presses, offset
        self._sides, self._extent = np.array(size), np.array([skin.length, skin.width])
        self.grid = CELLS * pixels.rows, CELLS * pixels.columns
        self._model = error_model(scene, len(scene.frequencies), against_rest)

    def pressed(self, meant: Hypothesis, random: np.random.Generator, count: int) -> Array:
        """Whitened readings, without noise, of pixels pressed so many times; (press, number)."""
        pixels = self.scene.pixels
        pitch = self._extent / [pixels.columns, pixels.rows]
        middles = np.array([(j + 0.5, i + 0.5) for i, j in meant.pixels]).reshape(-1, 2) * pitch
        aside = truncated_normal(random.random((count, len(middles), 2)), CUT)
        return self.read(middles + self._offset * self._sides * aside, random)

    def anywhere(self, random: np.random.Generator, count: int) -> tuple[Array, Array]:
        """Middles of touches that lie on the skin whole, m, shape (press, 2), and readings."""
        room = self._extent - self._sides
        middles = self._sides / 2 + random.random((count, 2)) * room
        return middles, self.read(middles[:, None], random)

    def read(self, middles: Array, random: np.random.Generator) -> Array:
        """Of touches around middles, m, shape (press, touch, 2), of random strength."""
        factors = self._presses.at(random.random(middles.shape[:2]))
        parts = range(0, len(middles), AT_ONCE)
        return np.concatenate(
            [self._read(middles[k : k + AT_ONCE], factors[k : k + AT_ONCE]) for k in parts]
        )

    def _read(self, middles: Array, factors: Array) -> Array:
        cells, rises, starts = self._laid(middles, factors)
        frequency = self.scene.frequencies
        s = laplace_variable(frequency, self.scene.skin.foam.loss)
        Z = self._reduced.skin(None).sweeps(cells, rises, starts, s)
        return self._model.whitened(observed(self.scene.leads.seen_through(Z, frequency)))

    def _laid(
        self, middles: Array, factors: Array
    ) -> tuple[NDArray[np.int64], Array, NDArray[np.int64]]:
        """Cells, rises and starts, see `ReducedSkin.sweeps`; overlapping touches multiply."""
        along, across = (
            _covered(middles[..., k], self._sides[k], np.linspace(0, self._extent[k], count + 1))
            for k, count in ((0, self.grid[1]), (1, self.grid[0]))
        )
        each = 1 + (factors - 1)[..., None, None] * across[..., :, None] * along[..., None, :]
        rises = each.prod(axis=1).reshape(len(middles), -1) - 1
        press, cells = np.nonzero(rises)
        starts = np.searchsorted(press, np.arange(len(middles) + 1))
        return cells, rises[press, cells], starts

    @cached_property
    def _reduced(self) -> Reduced:
        rows, columns = self.grid
        divided = self.scene.model_copy(update={"pixels": Pixels(rows=rows, columns=columns)})
        low, high = float(self._presses.low), float(self._presses.high)
        range_of = min(LEAST_FACTOR, low), max(LARGEST_FACTOR, high)

        def draw(random: np.random.Generator) -> Case:
            touches = int(random.integers(1, MOST_TOUCHES, endpoint=True))
            middles = random.random((1, touches, 2)) * self._extent
            cells, rises, _ = self._laid(middles, random.uniform(*range_of, (1, touches)))
            return Case(None, cells, rises)

        return reduce(divided, RTOL, draw)


def _covered(middle: Array, side: float, lines: Array) -> Array:
    """Fraction of each cell that lies within half a side of the middle, shape (..., cell)."""
    low, high = middle[..., None] - side / 2, middle[..., None] + side / 2
    inside = np.minimum(high, lines[1:]) - np.maximum(low, lines[:-1])
    return np.maximum(inside, 0.0) / np.diff(lines)

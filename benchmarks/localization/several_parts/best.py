"""The best test for a second touch on a skin that is known exactly: a likelihood ratio."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray
from rcskin.localization.inputs.baselines import RECENT
from rcskin.simulator.dataset.skin_model import reduced
from rcskin.simulator.press.batch import PressBatch
from rcskin.simulator.scene.scene import Scene

Array = NDArray[np.float64]

DIRECTIONS = 10
"""Of readings that presses lead in: in others they differ by less than a hundredth of the noise."""


class KnownSkin:
    """What one and two touches look like on a scene's skin as it is, in units of the meter's noise.

    Readings are changes of ln Z from the mean of RECENT sweeps at rest: white noise, for what errs
    alike in a session drops out. A touch is of any pixel and of a strength as the scene draws it.
    """

    def __init__(self, scene: Scene, rtol: float) -> None:
        self.factor = scene.dataset.press.factor_within(scene.skin.foam)
        self.pixels = scene.pixels.rows * scene.pixels.columns
        self._skin = reduced(scene.parts, rtol).skin(None)
        self._at_rest = self.log_impedance(np.zeros((1, 0), dtype=np.int64), np.ones((1, 0)))
        noise = np.array([scene.readout.magnitude_noise, scene.readout.phase_noise])
        self._noise = noise * np.sqrt(1 + 1 / RECENT)

    def changes(self, cells: NDArray[np.int64], factors: Array) -> Array:
        """Of presses of some pixels by such factors, both (press, touch); (press, reading)."""
        change = self.log_impedance(cells, factors) - self._at_rest
        return np.concatenate([change.real, change.imag], axis=1) / np.repeat(
            self._noise, change.shape[1]
        )

    def drawn(self, random: np.random.Generator, touches: int, count: int) -> Array:
        """Noisy readings of so many presses at random, (press, reading)."""
        seen = self.changes(*self.presses(random, touches, count))
        return seen + random.standard_normal(seen.shape)

    def presses(
        self, random: np.random.Generator, touches: int, count: int
    ) -> tuple[NDArray[np.int64], Array]:
        """Pixels and factors of so many at random, both (press, touch)."""
        among = np.array(list(itertools.combinations(range(self.pixels), touches)))
        cells = among[random.integers(len(among), size=count)]
        return cells, self.factor.at(random.random(cells.shape))

    def every(self, touches: int, strengths: int) -> Array:
        """Readings of all presses by so many strengths of the same chance, (press, reading)."""
        each = self.factor.at((np.arange(strengths) + 0.5) / strengths)
        factors = np.array(list(itertools.product(each, repeat=touches)))
        return np.concatenate(
            [
                self.changes(np.tile(cells, (len(factors), 1)), factors)
                for cells in itertools.combinations(range(self.pixels), touches)
            ]
        )

    def log_impedance(self, cells: NDArray[np.int64], factors: Array) -> NDArray[np.complex128]:
        """Of presses, without noise, (press, frequency)."""
        return np.log(self._skin.sweeps(PressBatch.even(cells, factors - 1)))[:, 0]


def log_ratio(skin: KnownSkin, seen: Array, strengths: int) -> Array:
    """ln of the likelihood of two touches over that of one, of each sweep, shape (sweep,).

    strengths: that each of two touches is integrated over; as many in a pair give those of one.
    """
    one, two = skin.every(1, strengths * strengths), skin.every(2, strengths)
    turn = np.linalg.svd(np.concatenate([one, two[::strengths]]), full_matrices=False)[2]
    turn = turn[:DIRECTIONS].T
    return _log_evidence(two @ turn, seen @ turn) - _log_evidence(one @ turn, seen @ turn)


def _log_evidence(presses: Array, seen: Array) -> Array:
    """ln of the mean likelihood over presses, less what is the same for all of them, (sweep,)."""
    presses, seen = presses.astype(np.float32), seen.astype(np.float32)
    half = np.square(presses).sum(axis=1) / 2
    found = [presses @ each - half for each in seen]
    return np.array(
        [best + np.log(np.mean(np.exp(f - best))) for f in found for best in (f.max(),)]
    )

"""Bayes' accuracy of pressed pixels for many skins and readings, with the same draws for all.

All use the same random pixels, strengths and errors of the meter, so that the difference of two
accuracies has a far smaller error than each of them.
"""

from __future__ import annotations

import zlib

import numpy as np
from numpy.typing import NDArray

from ..measure.experiment import own_presses
from ..measure.readout import errors_of, observed
from ..method_cache import cached_method
from ..models.reduced.reduced_skin import ReducedSkin
from ..scene.draw_distributions import AnyDistribution
from ..scene.frequency import laplace_variable
from ..scene.reading_setup import ReadingSetup
from ..scene.scene import Scene
from ..sweeps import InputError
from .bayes import Array, Draws, DrawScores
from .touch_readings import hypotheses

NODES = 6
"""Number of strengths of each touch, the same for all skins. Interpolation between them has an
error far below the meter's."""
TARGETS = ("column", "row", "pixel", "pair")
CACHED = 256
"""Number of interfaces whose errors are cached."""


class CommonDraws:
    """Random presses and errors of the meter, and the scores of the best classifier on them."""

    def __init__(
        self,
        scene: Scene,
        target: str = "pixel",
        presses: AnyDistribution | None = None,
        *,
        seed: int = 1,
        draws: int = 2000,
        against_rest: int = 0,
    ) -> None:
        """scene: for its pixels and meter. Other arguments: see `bayes_accuracy`.

        Raises InputError for a target other than column, row, pixel and pair, and for a meter
        without noise.
        """
        if target not in TARGETS:
            raise InputError(f"`target` must be one of {', '.join(TARGETS)}, got {target!r}")
        self._scene, self._seed, self._against_rest = scene, seed, against_rest
        self._among, random = hypotheses(scene, target), np.random.default_rng(seed)
        self._draws = Draws(self._among, presses or own_presses(scene), random, draws, NODES)

    def score(
        self, skin: ReducedSkin, reading: ReadingSetup, taken: NDArray[np.bool_] | None = None
    ) -> DrawScores:
        """Scores for one skin with these readings.

        taken: True for readings that are used, shape (interface, frequency); None: all of
        `reading`.
        """
        taken = reading.read if taken is None else taken
        each = zip(reading.interfaces, taken, strict=True)
        noise = [self._noise(interface.name, len(f))[..., f] for interface, f in each]
        errors = np.concatenate([each.reshape(len(each), -1) for each in noise], axis=1)
        return self._draws.score(self._whitened(skin, reading, taken), errors)

    @cached_method(CACHED)
    def _noise(self, interface: str, frequencies: int) -> Array:
        """Whitened errors of one interface, shape (draw, 2, frequency)."""
        random = np.random.default_rng([self._seed, zlib.crc32(interface.encode())])
        return random.standard_normal((len(self._draws), 2, frequencies))

    def _whitened(
        self, skin: ReducedSkin, reading: ReadingSetup, taken: NDArray[np.bool_]
    ) -> Array:
        """Whitened readings of all hypotheses at all nodes, (hypothesis, combination, number)."""
        frequency = reading.frequency
        batch = self._draws.batch(self._among, self._scene)
        Z = skin.sweeps(batch, laplace_variable(frequency, skin.loss))
        readings = observed(reading.leads.at_meter(Z, frequency))
        numbers = np.moveaxis(readings.reshape(-1, 2, *reading.shape), 1, 2)
        whitened = [self._of_interface(numbers[:, k], own) for k, own in enumerate(taken)]
        flat = np.concatenate(whitened, axis=1)
        return flat.reshape(len(self._among), -1, flat.shape[1])

    def _of_interface(self, numbers: Array, taken: NDArray[np.bool_]) -> Array:
        """Whitens numbers (press, 2, frequency) of one interface, to shape (press, n).

        The session's errors, common to all frequencies, reduce the mean over frequencies.
        """
        readout, kept = self._scene.readout, numbers[..., taken]
        noise = errors_of(self._scene, self._against_rest).noise[:, None]
        shared = np.array([[readout.magnitude_accuracy], [readout.phase_accuracy]])
        shrinkage = 1 - 1 / np.sqrt(1 + taken.sum() * (shared / noise) ** 2)
        if taken.any() and not self._against_rest:
            kept = kept - shrinkage * kept.mean(axis=-1, keepdims=True)
        return (kept / noise).reshape(len(kept), -1)

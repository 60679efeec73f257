"""Bayes' accuracy of pressed pixels for many skins and readings, with the same draws for all.

All use the same random pixels, strengths and errors of the meter, so that the difference of two
accuracies has a far smaller error than each of them.
"""

from __future__ import annotations

import zlib

import numpy as np

from ..arrays import Complex, Mask, Real
from ..measure.experiment import own_presses
from ..measure.readout import ErrorModel, errors_of, observed, require_noise
from ..method_cache import cached_method
from ..models.reduced.reduced_skin import ReducedSkin
from ..press.batch import NOTHING, PressBatch
from ..scene.draws.draw_distributions import AnyDistribution
from ..scene.parts import SceneParts, Setup
from ..sweeps import InputError
from .bayes import Draws, DrawScores
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
        parts: SceneParts,
        target: str = "pixel",
        presses: AnyDistribution | None = None,
        *,
        seed: int = 1,
        draws: int = 2000,
        against_rest: int = 0,
    ) -> None:
        """parts: for their pixels and meter. Other arguments: see `bayes_accuracy`.

        Raises InputError for a target other than column, row, pixel and pair, and for a meter
        without noise.
        """
        if target not in TARGETS:
            raise InputError(f"`target` must be one of {', '.join(TARGETS)}, got {target!r}")
        require_noise(parts.meter.readout)
        self._skin, self._meter, self._seed = parts.skin, parts.meter, seed
        self._against_rest = against_rest
        self._among = hypotheses(parts.skin, parts.plan, target)
        random = np.random.default_rng(seed)
        self._draws = Draws(
            self._among, presses or own_presses(parts.skin, parts.plan.press), random, draws, NODES
        )

    def score(self, skin: ReducedSkin, reading: Setup, taken: Mask | None = None) -> DrawScores:
        """Scores for one skin with these readings.

        taken: True for readings that are used, shape (interface, frequency); None: all of
        `reading`.
        """
        taken = reading.read if taken is None else taken
        each = zip(reading.interfaces, taken, strict=True)
        own = slice(2 if reading.phases else 1)
        noise = [self._noise(interface.name, len(f))[:, own, f] for interface, f in each]
        errors = np.concatenate([each.reshape(len(each), -1) for each in noise], axis=1)
        return self._draws.score(self._whitened(skin, reading, taken), errors)

    @cached_method(CACHED)
    def _noise(self, interface: str, frequencies: int) -> Real:
        """Whitened errors of one interface, shape (draw, 2, frequency)."""
        random = np.random.default_rng([self._seed, zlib.crc32(interface.encode())])
        return random.standard_normal((len(self._draws), 2, frequencies))

    def _whitened(self, skin: ReducedSkin, reading: Setup, taken: Mask) -> Real:
        """Whitened readings of all hypotheses at all nodes, (hypothesis, combination, number)."""

        def impedances(batch: PressBatch) -> Complex:
            return reading.at_meter(skin.sweeps(batch, reading.frequency))

        model = errors_of(
            reading,
            self._meter,
            self._against_rest,
            unpressed=lambda: impedances(PressBatch.of([NOTHING]))[0],
        )
        readings = observed(impedances(self._draws.batch(self._among, self._skin)))
        numbers = np.moveaxis(readings.reshape(-1, 2, *reading.shape), 1, 2)
        each = enumerate(taken)
        whitened = [whitened_interface(numbers[:, k], model, k, own) for k, own in each]
        flat = np.concatenate(whitened, axis=1)
        return flat.reshape(len(self._among), -1, flat.shape[1])


def whitened_interface(numbers: Real, model: ErrorModel, interface: int, taken: Mask) -> Real:
    """Whitens numbers (press, 2, frequency) of one interface, to shape (press, n).

    With x and the errors of the session e in units of the noise, the covariance is I + ee', whose
    inverse root is I - (1 - 1/sqrt(1 + e'e)) ee'/(e'e).
    """
    quantities = slice(2 if model.phases else 1)
    noise, kept = model.noise[quantities, interface][:, taken], numbers[:, quantities][..., taken]
    accuracy = model.accuracy[quantities, interface][:, taken]
    largest = accuracy.max(axis=-1, initial=0.0, keepdims=True)
    if not largest.any():
        return (kept / noise).reshape(len(kept), -1)
    relative = np.divide(accuracy, largest, out=np.ones_like(accuracy), where=largest > 0)
    lowest = noise.min(axis=-1, keepdims=True)
    weight = relative * (lowest / noise) ** 2
    sum_of_weights = (weight * relative).sum(axis=-1, keepdims=True)
    mean = (kept * weight).sum(axis=-1, keepdims=True) / sum_of_weights
    shrinkage = 1 - 1 / np.sqrt(1 + sum_of_weights * (largest / lowest) ** 2)
    return ((kept - shrinkage * relative * mean) / noise).reshape(len(kept), -1)

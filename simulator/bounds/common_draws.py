"""Bayes' accuracy of pressed pixels for many skins and readings, with the same draws for all.

All use the same random pixels, strengths and errors of the meter, so that the difference of two
accuracies has a far smaller error than each of them.
"""

from __future__ import annotations

import zlib
from collections.abc import Sequence

import numpy as np

from ..arrays import Mask, Real
from ..measure.experiment import own_presses
from ..method_cache import cached_method
from ..scene.draws.draw_distributions import AnyDistribution
from ..scene.parts import SceneParts
from ..sweeps import InputError
from .bayes import Draws, DrawScores
from .likelihood import Likelihood
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
    ) -> None:
        """parts: for their pixels. Other arguments: see `bayes_accuracy`.

        Raises InputError for a target other than column, row, pixel and pair.
        """
        if target not in TARGETS:
            raise InputError(f"`target` must be one of {', '.join(TARGETS)}, got {target!r}")
        self._skin, self._seed = parts.skin, seed
        self._among = hypotheses(parts.skin, parts.plan, target)
        random = np.random.default_rng(seed)
        self._draws = Draws(
            self._among, presses or own_presses(parts.skin, parts.plan.press), random, draws, NODES
        )

    def score(self, known: Likelihood, taken: Mask | None = None) -> DrawScores:
        """Scores for the likelihood of one skin.

        taken: True for readings that are used, shape (interface, frequency); None: all of them.
        """
        errors = known.errors if taken is None else known.among(taken)
        nodes = errors.whitened(known.observed(self._draws.batch(self._among, self._skin)))
        return self._draws.score(
            nodes.reshape(len(self._among), -1, nodes.shape[-1]),
            self._errors(known.setup.names, errors.values),
        )

    def _errors(self, interfaces: Sequence[str], values: Mask) -> Real:
        """Whitened errors, shape (draw, number). values: see `ErrorModel`."""
        found = np.zeros((len(self._draws), *values.shape))
        for k, (name, read) in enumerate(zip(interfaces, values[0], strict=True)):
            found[:, :, k, read] = self._noise(name, int(read.sum()))
        return found[:, values]

    @cached_method(CACHED)
    def _noise(self, interface: str, frequencies: int) -> Real:
        """Whitened errors of one interface, shape (draw, 2, frequency)."""
        random = np.random.default_rng([self._seed, zlib.crc32(interface.encode())])
        return random.standard_normal((len(self._draws), 2, frequencies))

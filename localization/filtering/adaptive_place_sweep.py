"""Adaptive sweeps whose readings are chosen to locate a touch."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...simulator.arrays import Real
from ..inversion.place_posterior import PlacePosterior, log_prior_of
from ..inversion.position import BLUR, CELLS, ModelBasedPosition, cells_of
from ..inversion.region import Region, region_of
from ..inversion.regions import PROBABILITY
from ..trust.answers import CANNOT_TELL
from .adaptive_settings import AdaptiveSettings
from .adaptive_sweep import MIN_PRIOR, AdaptiveSweep
from .cell_grid import cell_grid_of
from .chain import Evidence
from .follower import FollowedAnswer

UNPRESSED_PRIOR = 0.5
"""Prior probability of the unpressed skin."""


class PlaceSweep(AdaptiveSweep):
    """Adaptive sweep for a model of positions."""

    def __init__(
        self, settings: AdaptiveSettings, step: ModelBasedPosition, baseline: NDArray, gap: float
    ) -> None:
        super().__init__(settings, baseline, gap)
        self._grid = cell_grid_of(settings.model)
        self._placing = PlacePosterior(step, self._prior(step, gap))

    @property
    def posterior(self) -> PlacePosterior:
        """Posterior by the readings so far."""
        return self._placing

    @property
    def is_certain(self) -> bool:
        """True if the skin is certainly unpressed, or the region of the touch is small enough."""
        rest, certain = self._placing.unpressed, self._terms.certain
        if rest > 1 - certain:
            return rest >= certain
        return self._region().area <= math.pi * self._terms.within**2

    def answer(self, during: float) -> FollowedAnswer:
        """Answer by the readings so far. during: their duration, s."""
        placing, follower = self._placing, self._terms.follower
        if follower is not None:
            likelihoods = placing.log_densities[0 if self._terms.model.knows_unpressed else 1 :]
            cells = self._grid.with_calibrated_deviations(cells_of(placing.posterior))
            return follower.update(Evidence(likelihoods), self.gap, during, cells)
        rest, nothing = placing.unpressed, np.zeros(0)
        chance = max(rest, 1 - rest)
        if placing.novel or chance < self._terms.certain:
            return FollowedAnswer(CANNOT_TELL, chance, nothing, 0.0)
        if rest > 0.5:
            return FollowedAnswer("0", chance, nothing, 0.0)
        return FollowedAnswer("1", chance, nothing, 0.0, self._place(), self._region())

    def _place(self) -> tuple[float, ...]:
        """Peak x and y of the blurred posterior, and its deviations from there, mm."""
        places = self._placing.places
        best = places.peak(BLUR)
        squares = (places.mean - best) ** 2 + np.einsum("eii->ei", places.covariance)
        off = self._grid.learned.factor[:2] * np.sqrt(places.weight @ squares)
        return (*best.tolist(), *off.tolist())

    def _region(self) -> Region:
        return region_of(self._placing.places, PROBABILITY)

    def _prior(self, step: ModelBasedPosition, gap: float) -> Real:
        """ln prior of the unpressed skin and of each cell."""
        terms = self._terms
        rest = UNPRESSED_PRIOR if terms.model.knows_unpressed else 0.0
        own = log_prior_of(step, rest)
        if terms.follower is None:
            return own
        known = np.maximum(terms.follower.expected(gap)[:-1], MIN_PRIOR / CELLS)
        if not rest:
            return np.append(-np.inf, np.log(known) + own[1:])
        return np.log(known) + own - np.log(np.append(rest, np.full(CELLS, (1 - rest) / CELLS)))

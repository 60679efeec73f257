"""Adaptive sweeps: the previous readings choose the next one, until the answer is certain."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from ...simulator.arrays import Complex, Real
from ...simulator.sweeps import InputError
from ...simulator.sweeps.errors import named
from ...simulator.sweeps.schema import taken_of
from ..inputs.baselines import mean_baselines
from ..inputs.features import at_interfaces
from ..inversion.adapted import AdaptedClassifier, AdaptedPosition
from ..inversion.classifier import ModelBased
from ..inversion.position import BLUR, CELLS, ModelBasedPosition, cells_of
from ..inversion.region import Region, region_of
from ..inversion.regions import PROBABILITY
from ..inversion.sequential_posterior import ClassPosterior, PlacePosterior, log_prior_of
from ..model.localizer_model import Model
from ..trust.answers import CANNOT_TELL
from ..trust.fitted import Classifier
from .cell_grid import cell_grid_of
from .chain import Evidence
from .follower import FollowedAnswer, Follower

MIN_PRIOR = 1e-6


class AdaptiveSweep(ABC):
    """An adaptive sweep: `next` chooses a reading, `add_reading` takes it.

    It ends when `next` is None.
    """

    def __init__(self, policy: AdaptivePolicy, baseline: Complex, gap: float) -> None:
        self._policy, self.gap, self._at_rest = policy, gap, baseline
        self._interfaces = policy.model.interfaces
        self._frequencies = np.array(policy.model.frequencies)
        taken = np.array(policy.model.problem.taken, dtype=bool)
        shape = len(self._interfaces), self._frequencies.size
        self._places = np.argwhere(taken if taken.size else np.ones(shape, dtype=bool))

    @property
    @abstractmethod
    def posterior(self) -> ClassPosterior | PlacePosterior:
        """Posterior by the readings so far."""

    @property
    @abstractmethod
    def is_certain(self) -> bool:
        """True if the answer is certain."""

    @abstractmethod
    def answer(self, during: float) -> FollowedAnswer:
        """Answer by the readings so far. during: their duration, s."""

    def next(self, seconds: Real) -> tuple[str, float] | None:
        """Interface and frequency [Hz] of the reading with most expected information per second.

        seconds: duration of a reading at each of the model's interfaces and frequencies, switching
        included, shape (interface, frequency). The result is None if the answer is certain and the
        sweep not novel, or if nothing is left to read.
        """
        posterior = self.posterior
        left = np.setdiff1d(np.arange(len(self._places)), posterior.used_readings)
        if not left.size or (posterior.used_readings and not posterior.novel and self.is_certain):
            return None
        rates = posterior.gains(left) / seconds[tuple(self._places[left].T)]
        where, at = self._places[left[rates.argmax()]]
        return self._interfaces[where], float(self._frequencies[at])

    def add_reading(self, interface: str, frequency: float, Z: complex) -> None:
        """Take the reading Z [ohm] at an interface and a frequency [Hz]."""
        at = int(np.abs(self._frequencies - frequency).argmin())
        place = self._interfaces.index(interface), at
        reading = int(np.flatnonzero((self._places == place).all(axis=1))[0])
        change = np.log(complex(Z)) - self._at_rest[reading]
        self.posterior.update(reading, np.array([change.real, change.imag]))


class ClassSweep(AdaptiveSweep):
    """Adaptive sweep for a classifier."""

    def __init__(
        self, policy: AdaptivePolicy, step: ModelBased, baseline: NDArray, gap: float
    ) -> None:
        super().__init__(policy, baseline, gap)
        learned, prior = policy.model.learned, None
        if policy.follower is not None:
            known = policy.follower.expected(gap)[:-1]
            prior = np.log(np.maximum(known / known.sum(), MIN_PRIOR))
        assert isinstance(learned, Classifier)
        self._posterior, self._sharpness = (
            ClassPosterior(step, prior, learned.sharpness),
            learned.sharpness,
        )

    @property
    def posterior(self) -> ClassPosterior:
        """Posterior by the readings so far."""
        return self._posterior

    @property
    def is_certain(self) -> bool:
        """True if a class is probable enough."""
        return bool(self._posterior.probabilities.max() >= self._policy.certain)

    def answer(self, during: float) -> FollowedAnswer:
        """Answer by the readings so far. during: their duration, s."""
        posterior, policy = self._posterior, self._policy
        if policy.follower is not None:
            likelihoods = self._sharpness * posterior.log_densities
            return policy.follower.update(Evidence(likelihoods), self.gap, during)
        probabilities = posterior.probabilities
        best = int(probabilities.argmax())
        chance = float(probabilities[best])
        silent = posterior.novel or chance < policy.certain
        label = CANNOT_TELL if silent else str(policy.model.classes[best])
        return FollowedAnswer(label, chance, probabilities, 0.0)


UNPRESSED_PRIOR = 0.5
"""Prior probability of the unpressed skin."""


class PlaceSweep(AdaptiveSweep):
    """Adaptive sweep for a model of positions."""

    def __init__(
        self, policy: AdaptivePolicy, step: ModelBasedPosition, baseline: NDArray, gap: float
    ) -> None:
        super().__init__(policy, baseline, gap)
        self._grid = cell_grid_of(policy.model)
        self._placing = PlacePosterior(step, self._prior(step, gap))

    @property
    def posterior(self) -> PlacePosterior:
        """Posterior by the readings so far."""
        return self._placing

    @property
    def is_certain(self) -> bool:
        """True if the skin is certainly unpressed, or the region of the touch is small enough."""
        rest, certain = self._placing.unpressed, self._policy.certain
        if rest > 1 - certain:
            return rest >= certain
        return self._region().area <= math.pi * self._policy.within**2

    def answer(self, during: float) -> FollowedAnswer:
        """Answer by the readings so far. during: their duration, s."""
        placing, follower = self._placing, self._policy.follower
        if follower is not None:
            likelihoods = placing.log_densities[0 if self._policy.model.knows_unpressed else 1 :]
            cells = self._grid.with_calibrated_deviations(cells_of(placing.posterior))
            return follower.update(Evidence(likelihoods), self.gap, during, cells)
        rest, nothing = placing.unpressed, np.zeros(0)
        chance = max(rest, 1 - rest)
        if placing.novel or chance < self._policy.certain:
            return FollowedAnswer(CANNOT_TELL, chance, nothing, 0.0)
        if rest > 0.5:
            return FollowedAnswer("0", chance, nothing, 0.0)
        return FollowedAnswer("1", chance, nothing, 0.0, self._place(), self._region())

    def _place(self) -> tuple[float, ...]:
        """Peak x and y of the blurred posterior, and its deviations from there, mm."""
        best, off = self._placing.places.peak_and_deviation(BLUR)
        return (*best.tolist(), *(self._grid.learned.factor[:2] * off).tolist())

    def _region(self) -> Region:
        return region_of(self._placing.places, PROBABILITY)

    def _prior(self, step: ModelBasedPosition, gap: float) -> Real:
        """ln prior of the unpressed skin and of each cell."""
        policy = self._policy
        rest = UNPRESSED_PRIOR if policy.model.knows_unpressed else 0.0
        own = log_prior_of(step, rest)
        if policy.follower is None:
            return own
        known = np.maximum(policy.follower.expected(gap)[:-1], MIN_PRIOR / CELLS)
        if not rest:
            return np.append(-np.inf, np.log(known) + own[1:])
        return np.log(known) + own - np.log(np.append(rest, np.full(CELLS, (1 - rest) / CELLS)))


CERTAIN = 0.95
"""Probability of an answer at which a sweep may end."""
INVERTING = ModelBased | AdaptedClassifier | ModelBasedPosition | AdaptedPosition


class AdaptivePolicy:
    """Starts an `AdaptiveSweep` for each sweep.

    model: localizer of the answers. certain: probability of an answer at which a sweep may end,
    CERTAIN by default. follower: its belief is the prior of a sweep; None without one. within: mm;
    a place is known well enough if its region is no larger than a disc of this radius. Raises
    InputError for a model that has no likelihoods of parts of a sweep.
    """

    def __init__(
        self,
        model: Model,
        certain: float | None = None,
        follower: Follower | None = None,
        within: float = 10.0,
    ) -> None:
        step = model.predictor
        if not isinstance(step, INVERTING):
            raise InputError(
                "--adaptive takes models by model-based or model-adapted; this is one by "
                f"{model.estimator} of {model.target}"
            )
        if certain is not None and not 0 < certain < 1:
            raise InputError(f"{named('certain')} must be between 0 and 1, got {certain:g}")
        if not 0 < within < np.inf:
            raise InputError(f"`within` must be above 0 mm, got {within:g}")
        self.model, self.certain = model, certain or CERTAIN
        self.follower, self.within = follower, within
        self._skin: tuple[xr.Dataset, tuple[Any, Complex]] | None = None

    def begin(self, rest: xr.Dataset, gap: float) -> AdaptiveSweep:
        """Start the next sweep. rest: baseline sweeps. gap: s since the previous sweep."""
        if self._skin is None or self._skin[0] is not rest:
            self._skin = rest, inverter_for(self.model, rest)
        step, baseline = self._skin[1]
        if isinstance(step, ModelBased):
            return ClassSweep(self, step, baseline, gap)
        return PlaceSweep(self, step, baseline, gap)


def inverter_for(model: Model, rest: xr.Dataset) -> tuple[Any, Complex]:
    """Estimator that inverts the simulator for a skin, and its mean baseline ln (Z / ohm).

    Shape of the baseline: (reading,). Missing tables of the skin are computed. For other models the
    estimator is its predictor.
    """
    sweeps = at_interfaces(rest, model.interfaces)
    taken = taken_of(sweeps)
    latest, opening = (
        mean.ravel() if taken is None else mean[taken] for mean in mean_baselines(sweeps)
    )
    step = model.predictor
    if isinstance(step, AdaptedClassifier | AdaptedPosition):
        step = step.for_baseline(np.concatenate([opening.real, opening.imag]))
    return step, latest

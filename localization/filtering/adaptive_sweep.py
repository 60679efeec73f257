"""One sweep whose readings are chosen one by one, and the class from it."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import NDArray

from ...simulator.arrays import Complex, Real
from ..inversion.class_posterior import ClassPosterior
from ..inversion.classifier import ModelBased
from ..inversion.place_posterior import PlacePosterior
from ..trust.answers import CANNOT_TELL
from ..trust.fitted import Classifier
from .adaptive_settings import AdaptiveSettings
from .chain import Evidence
from .follower import FollowedAnswer

MIN_PRIOR = 1e-6


class AdaptiveSweep(ABC):
    """An adaptive sweep: `next` chooses a reading, `add_reading` takes it.

    It ends when `next` is None.
    """

    def __init__(self, settings: AdaptiveSettings, baseline: Complex, gap: float) -> None:
        self._terms, self.gap, self._at_rest = settings, gap, baseline
        self._interfaces = settings.model.interfaces
        self._frequencies = np.array(settings.model.frequencies)
        taken = np.array(settings.model.problem.taken, dtype=bool)
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
        self, settings: AdaptiveSettings, step: ModelBased, baseline: NDArray, gap: float
    ) -> None:
        super().__init__(settings, baseline, gap)
        learned, prior = settings.model.learned, None
        if settings.follower is not None:
            known = settings.follower.expected(gap)[:-1]
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
        return bool(self._posterior.probabilities.max() >= self._terms.certain)

    def answer(self, during: float) -> FollowedAnswer:
        """Answer by the readings so far. during: their duration, s."""
        posterior, terms = self._posterior, self._terms
        if terms.follower is not None:
            likelihoods = self._sharpness * posterior.log_densities
            return terms.follower.update(Evidence(likelihoods), self.gap, during)
        probabilities = posterior.probabilities
        best = int(probabilities.argmax())
        chance = float(probabilities[best])
        silent = posterior.novel or chance < terms.certain
        label = CANNOT_TELL if silent else str(terms.model.classes[best])
        return FollowedAnswer(label, chance, probabilities, 0.0)

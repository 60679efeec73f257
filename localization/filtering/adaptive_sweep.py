"""One sweep whose readings are chosen one after the other, and which class it tells of."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import NDArray

from ..inversion.class_posterior import Inquiry
from ..inversion.classifier import ModelBased
from ..inversion.place_posterior import Placing
from ..trust.answers import CANNOT_TELL
from ..trust.fitted import Classifier
from .adaptive_settings import Terms
from .chain import Evidence
from .follower import Followed

LEAST_PRIOR = 1e-6


class Questioning(ABC):
    """One sweep: `next` tells what to read, `tell` what was read there, until `next` is None."""

    def __init__(self, terms: Terms, at_rest: NDArray[np.complex128], gap: float) -> None:
        self._terms, self.gap, self._at_rest = terms, gap, at_rest
        self._interfaces = terms.model.interfaces
        self._frequencies = np.array(terms.model.frequencies)
        taken = np.array(terms.model.problem.taken, dtype=bool)
        shape = len(self._interfaces), self._frequencies.size
        self._places = np.argwhere(taken if taken.size else np.ones(shape, dtype=bool))

    @property
    @abstractmethod
    def inquiry(self) -> Inquiry | Placing:
        """By the readings so far."""

    @property
    @abstractmethod
    def enough(self) -> bool:
        """Whether the answer is certain."""

    @abstractmethod
    def answer(self, during: float) -> Followed:
        """By the readings so far. during: s that they took."""

    def next(self, seconds: NDArray[np.float64]) -> tuple[str, float] | None:
        """Interface and frequency [Hz] whose reading is expected to tell most in its time.

        seconds: that a reading takes at each of the model's interfaces and frequencies, with the
        turn of a switch, shape (interface, frequency). None where the answer is certain and no
        novelty, or nothing is left to read.
        """
        inquiry = self.inquiry
        left = np.setdiff1d(np.arange(len(self._places)), inquiry.told)
        if not left.size or (inquiry.told and not inquiry.novel and self.enough):
            return None
        rates = inquiry.gains(left) / seconds[tuple(self._places[left].T)]
        where, at = self._places[left[rates.argmax()]]
        return self._interfaces[where], float(self._frequencies[at])

    def tell(self, interface: str, frequency: float, Z: complex) -> None:
        """What was read at an interface and a frequency in Hz: Z in ohm."""
        at = int(np.abs(self._frequencies - frequency).argmin())
        place = self._interfaces.index(interface), at
        reading = int(np.flatnonzero((self._places == place).all(axis=1))[0])
        change = np.log(complex(Z)) - self._at_rest[reading]
        self.inquiry.tell(reading, np.array([change.real, change.imag]))


class OfClasses(Questioning):
    """Which class it is."""

    def __init__(self, terms: Terms, step: ModelBased, at_rest: NDArray, gap: float) -> None:
        super().__init__(terms, at_rest, gap)
        learned, prior = terms.model.learned, None
        if terms.follower is not None:
            known = terms.follower.expected(gap)[:-1]
            prior = np.log(np.maximum(known / known.sum(), LEAST_PRIOR))
        assert isinstance(learned, Classifier)
        self._inquiry, self._sharpness = Inquiry(step, prior, learned.sharpness), learned.sharpness

    @property
    def inquiry(self) -> Inquiry:
        """By the readings so far."""
        return self._inquiry

    @property
    def enough(self) -> bool:
        """Whether a class is probable enough."""
        return bool(self._inquiry.probabilities.max() >= self._terms.certain)

    def answer(self, during: float) -> Followed:
        """By the readings so far. during: s that they took."""
        inquiry, terms = self._inquiry, self._terms
        if terms.follower is not None:
            told = self._sharpness * inquiry.log_densities
            return terms.follower.seen(Evidence(told), self.gap, during)
        probabilities = inquiry.probabilities
        best = int(probabilities.argmax())
        chance = float(probabilities[best])
        silent = inquiry.novel or chance < terms.certain
        label = CANNOT_TELL if silent else str(terms.model.classes[best])
        return Followed(label, chance, probabilities, 0.0)

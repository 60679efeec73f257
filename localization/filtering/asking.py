"""Sweeps whose frequencies are chosen one after the other, and end where the answer is certain."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...simulator.sweeps import InputError, impedance
from ..inputs.features import seen_from
from ..inversion.adapted import AdaptedClassifier, AdaptedPosition
from ..inversion.classifier import ModelBased
from ..inversion.inquiry import Inquiry
from ..model.model import Model
from ..trust.answers import CANNOT_TELL
from ..trust.fitted import Classifier
from .chain import Evidence
from .evidence import inverts
from .follower import Followed, Follower

if TYPE_CHECKING:
    import xarray as xr

CERTAIN = 0.95
"""Probability of an answer at which a sweep may end."""
LEAST_PRIOR = 1e-6


class Asker:
    """Begins a `Questioning` for each sweep. follower: by whose belief sweeps begin; may be none.

    Raises InputError for a model that does not know how likely parts of a sweep are.
    """

    def __init__(
        self, model: Model, certain: float | None = None, follower: Follower | None = None
    ) -> None:
        if not inverts(model) or len(model.interfaces) > 1:
            raise InputError(
                "--adaptive takes models by model-based or model-adapted of column, row, pixel, "
                f"touches or pair, of one interface; this is one by {model.estimator} of "
                f"{model.target}, of {len(model.interfaces)}"
            )
        if certain is not None and not 0 < certain < 1:
            raise InputError(f"`certain` must be between 0 and 1, got {certain:g}")
        self.model, self.certain, self.follower = model, certain or CERTAIN, follower

    def begin(self, rest: xr.Dataset, gap: float) -> Questioning:
        """Of the next sweep. rest: sweeps of the skin at rest. gap: s since the one before."""
        return Questioning(self, *skin_at_hand(self.model, rest), gap)


def skin_at_hand(model: Model, rest: xr.Dataset) -> tuple[Any, NDArray[np.complex128]]:
    """Who inverts the simulator for a skin, and the mean of ln (Z / ohm) of sweeps of it at rest.

    Tables that have yet to be made of it are made. Of other models, the last step of its pipeline.
    """
    known = np.log(impedance(seen_from(rest, model.interfaces)).astype(complex))
    at_rest, step = known.mean(axis=0).ravel(), model.pipeline[-1]
    if isinstance(step, AdaptedClassifier | AdaptedPosition):
        step = step.at_hand(np.concatenate([at_rest.real, at_rest.imag]))
    return step, at_rest


class Questioning:
    """One sweep: `next` tells a frequency, `tell` what was read there, until `next` is None."""

    def __init__(
        self, asker: Asker, step: ModelBased, at_rest: NDArray[np.complex128], gap: float
    ) -> None:
        self._asker, self._at_rest, self._gap = asker, at_rest, gap
        model, follower = asker.model, asker.follower
        prior = None
        if follower is not None:
            known = follower.expected(gap)[:-1]
            prior = np.log(np.maximum(known / known.sum(), LEAST_PRIOR))
        assert isinstance(model.learned, Classifier)
        self._inquiry = Inquiry(step, prior, model.learned.sharpness)
        self._frequencies = np.array(model.frequencies)

    def next(self, seconds: NDArray[np.float64]) -> float | None:
        """The frequency in Hz whose reading is expected to tell most in its time.

        seconds: that a reading takes at each of the model's frequencies, shape (frequency,). None
        where the answer is certain and no novelty, or nothing is left to read.
        """
        inquiry = self._inquiry
        left = np.setdiff1d(np.arange(self._frequencies.size), inquiry.told)
        enough = inquiry.told and inquiry.probabilities.max() >= self._asker.certain
        if not left.size or (enough and not inquiry.novel):
            return None
        rates = inquiry.gains(left) / seconds[left]
        return float(self._frequencies[left[rates.argmax()]])

    def tell(self, frequency: float, Z: complex) -> None:
        """What was read at a frequency in Hz: Z in ohm."""
        reading = int(np.abs(self._frequencies - frequency).argmin())
        change = np.log(complex(Z)) - self._at_rest[reading]
        self._inquiry.tell(reading, np.array([change.real, change.imag]))

    def answer(self, during: float) -> Followed:
        """By the readings so far. during: s that they took."""
        inquiry, follower = self._inquiry, self._asker.follower
        if follower is not None:
            assert isinstance(follower.model.learned, Classifier)
            told = follower.model.learned.sharpness * inquiry.log_densities
            return follower.seen(Evidence(told), self._gap, during)
        probabilities = inquiry.probabilities
        best = int(probabilities.argmax())
        chance = float(probabilities[best])
        silent = inquiry.novel or chance < self._asker.certain
        label = CANNOT_TELL if silent else str(self._asker.model.classes[best])
        return Followed(label, chance, probabilities, 0.0)

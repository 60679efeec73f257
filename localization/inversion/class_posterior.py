"""Frequencies one at a time: what the readings so far tell, and which would tell most next."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import softmax

from .classifier import ModelBased
from .sequential_posterior import SequentialPosterior

LIKELIEST = 64
"""Entries by which gains are reckoned."""


class ClassPosterior(SequentialPosterior):
    """Of one touch, by the tables of a localizer of classes. Noise and skin are as in its mixture.

    log_prior: ln of the chance of each class; the tables' own without. sharpness: of decisions.
    """

    def __init__(
        self,
        localizer: ModelBased,
        log_prior: NDArray[np.float64] | None = None,
        sharpness: float = 1.0,
    ) -> None:
        mixture, chances = localizer.part(None)
        super().__init__(mixture, localizer.noise_, localizer.doubt)
        self._answer, self._sharpness = localizer.answer_, sharpness
        self._of_class = mixture.log_chance - chances[localizer.answer_]
        self._log_prior = chances if log_prior is None else log_prior

    @property
    def log_densities(self) -> NDArray[np.float64]:
        """As of `ModelBased.log_densities` of the readings so far, (class + 1,)."""
        joint, count = self._of_class + self.fit, self._log_prior.size
        of_class = [float(np.logaddexp.reduce(joint[self._answer == k])) for k in range(count)]
        return np.append(of_class, self.just_novel)

    @property
    def probabilities(self) -> NDArray[np.float64]:
        """Of each class, by the readings so far, shape (class,)."""
        joint = self._sharpness * self.log_densities[:-1] + self._log_prior
        return np.asarray(softmax(joint))

    def gains(self, readings: NDArray[np.intp]) -> NDArray[np.float64]:
        """Information on the class that each further reading is expected to give, nat, (reading,).

        By the LIKELIEST entries, see `SequentialPosterior.expected_information`.
        """
        joint = self._of_class + self.fit + self._log_prior[self._answer]
        entry = np.sort(np.argsort(-joint, kind="stable")[:LIKELIEST])
        return self.expected_information(
            entry, softmax(joint[entry]), self._answer[entry], readings
        )

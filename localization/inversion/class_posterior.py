"""Posterior of the class, updated by each reading, and the information of the next one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import softmax

from ...simulator.arrays import Real
from .classifier import ModelBased
from .sequential_posterior import SequentialPosterior

LIKELIEST = 64
"""Number of most likely entries that estimate gains."""


class ClassPosterior(SequentialPosterior):
    """Posterior of the class of one touch, from the tables of a localizer of classes.

    Noise and skin are as in its mixture. log_prior: ln of the prior of each class; by default the
    tables' own. sharpness: factor of the decisions.
    """

    def __init__(
        self, localizer: ModelBased, log_prior: Real | None = None, sharpness: float = 1.0
    ) -> None:
        mixture, chances = localizer.part(None)
        super().__init__(mixture, localizer.noise, localizer.doubt)
        self._answer, self._sharpness = localizer.answer, sharpness
        self._of_class = mixture.log_chance - chances[localizer.answer]
        self._log_prior = chances if log_prior is None else log_prior

    @property
    def log_densities(self) -> Real:
        """`ModelBased.log_densities` of the readings so far, (class + 1,)."""
        joint, count = self._of_class + self.fit, self._log_prior.size
        of_class = [float(np.logaddexp.reduce(joint[self._answer == k])) for k in range(count)]
        return np.append(of_class, self.just_novel)

    @property
    def probabilities(self) -> Real:
        """Probability of each class by the readings so far, shape (class,)."""
        joint = self._sharpness * self.log_densities[:-1] + self._log_prior
        return np.asarray(softmax(joint))

    def gains(self, readings: NDArray[np.intp]) -> Real:
        """Information on the class that each further reading is expected to give, nat, (reading,).

        It is estimated by the LIKELIEST entries, see `SequentialPosterior.expected_information`.
        """
        joint = self._of_class + self.fit + self._log_prior[self._answer]
        entry = np.sort(np.argsort(-joint, kind="stable")[:LIKELIEST])
        return self.expected_information(
            entry, softmax(joint[entry]), self._answer[entry], readings
        )

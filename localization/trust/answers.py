"""What a localizer answers, and when it rather says that it cannot tell."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.sweeps import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

CANNOT_TELL = "cannot tell"
"""The answer where no class is probable enough, or the sweep is like none of the training."""
NOTHING_PRESSED = ("0", "0,0")
"""Labels of the skin at rest, as text."""


@dataclass(frozen=True, eq=False)
class Answers:
    """An answer to each sweep.

    labels: text of the class or CANNOT_TELL, shape (sweep,). probability: of the most probable
    class, also where it is not told, shape (sweep,). novel: whether the sweep is unlike all of the
    training, shape (sweep,).
    """

    labels: NDArray[np.str_]
    probability: NDArray[np.float64]
    novel: NDArray[np.bool_]

    @property
    def told(self) -> NDArray[np.bool_]:
        """Where there is an answer, shape (sweep,)."""
        return self.labels != CANNOT_TELL


def decide(
    classes: NDArray, probabilities: NDArray[np.float64], novel: NDArray[np.bool_], threshold: float
) -> Answers:
    """The most probable class where it is no novelty and as probable as the threshold.

    classes: shape (K,). probabilities: shape (sweep, K). novel: shape (sweep,).
    """
    best = probabilities.argmax(axis=1)
    probability = probabilities.max(axis=1)
    silent = novel | (probability < threshold)
    text = classes[best].astype(str).astype(object)
    return Answers(np.where(silent, CANNOT_TELL, text).astype(str), probability, novel)


def threshold_of(
    probability: NDArray[np.float64], right: NDArray[np.bool_], certain: float
) -> float:
    """The least probability from which on answers are right at the rate `certain`.

    probability: of the best class of sweeps that were not trained on. right: whether it was theirs.
    Raises InputError where `certain` is not within (0, 1), or no threshold reaches it.
    """
    if not 0 < certain < 1:
        raise InputError(f"`certain` must be between 0 and 1, got {certain:g}")
    order = np.argsort(-probability, kind="stable")
    rate = np.cumsum(right[order]) / np.arange(1, right.size + 1)
    last_of_ties = np.append(np.diff(probability[order]) != 0, True)
    enough = np.flatnonzero((rate >= certain) & last_of_ties)
    if not enough.size:
        raise InputError(
            f"`certain` {certain:g} is out of reach: of the held-out sweeps answered most surely "
            f"only {100 * rate[last_of_ties].max():.1f} % are right"
        )
    return float(probability[order][enough[-1]])

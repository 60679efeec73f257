"""What answers for a localizer: decisions of classes, or positions, from features."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from ...simulator.arrays import Mask, Real
from .parts import Part
from .plain import Plain, Sizes, require

MIN_PROBABILITY = 1e-12
"""Smallest probability whose logarithm is a decision."""
OUTPUTS = 3
"""Number of outputs of a position: x, y and strength."""
Classes = Annotated[NDArray, "K classes"]


class Predictor(Plain):
    """A trained learner: it has `classes` and gives `decisions`, or gives `positions`.

    classes: ascending, shape (K,); None if it predicts positions.
    """

    classes: NDArray | None
    detects_novelty: ClassVar[bool] = False
    """True if `novel` tells sweeps unlike all that it knows."""

    @property
    def features(self) -> int:
        """Number of features."""
        raise NotImplementedError

    def decisions(self, X: Real) -> Real:
        """Decision for each class, larger if more probable, shape (n, K). X: (n, feature)."""
        raise NotImplementedError

    def positions(self, X: Real) -> tuple[Real, Real | None]:
        """x, y [mm] and strength, shape (n, 3), and their deviations if it knows them."""
        raise NotImplementedError

    def novel(self, X: Real) -> Mask:
        """True if even the best fit exceeds what noise and skin allow, shape (n,)."""
        raise NotImplementedError

    def predict(self, X: Real) -> NDArray:
        """The most probable class of each row, shape (n,), or its position, shape (n, 3)."""
        if self.classes is None:
            return self.positions(X)[0]
        return self.classes[self.decisions(X).argmax(axis=1)]


@dataclass(frozen=True, eq=False)
class Chain(Predictor):
    """Parts, one after the other: from features to decisions of classes, or to positions.

    classes: ascending, shape (K,); None for positions.
    """

    parts: tuple[Part, ...]
    classes: Classes | None = None

    def _check(self, sizes: Sizes) -> None:
        require(self.parts and self.parts[0].sizes[0], "parts", "must begin with one of known size")
        size = self.features
        for k, part in enumerate(self.parts):
            taken, given = part.sizes
            require(taken in (None, size), f"parts.{k}", f"takes {taken} numbers, and gets {size}")
            size = self._after(k, given or size)
        expected = OUTPUTS if self.classes is None else self.classes.size
        require(size == expected, "parts", f"give {size} numbers, where {expected} belong")

    def _after(self, k: int, size: int) -> int:
        """Size after a part: log-odds of two classes become two decisions."""
        return 2 if size == 1 and self.parts[k].sizes[1] is None else size

    @property
    def features(self) -> int:
        return self.parts[0].sizes[0] or 0

    def decisions(self, X: Real) -> Real:
        return self._output(X)

    def positions(self, X: Real) -> tuple[Real, None]:
        return np.asarray(self._output(X), np.float64), None

    def then(self, part: Part) -> Chain:
        """The chain with another part at its end."""
        return replace(self, parts=(*self.parts, part))

    def _output(self, X: Real) -> Real:
        for part in self.parts:
            X = part(X)
        return X

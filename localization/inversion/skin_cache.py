"""Skins that tables were made for, found again by their curve at rest."""

from __future__ import annotations

from collections.abc import Callable
from threading import Thread
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

ALIKE = 0.015
"""Root mean square of the change of ln Z, up to which a skin is the same."""
AHEAD = 0.5
"""Of ALIKE, from where on tables are made ahead of their need."""
SKINS_KEPT = 16


class Skin(NamedTuple):
    """An estimator, and the curve at rest that it was fitted to, shape (number,)."""

    curve: NDArray[np.float64]
    estimator: Any


class Skins:
    """The latest SKINS_KEPT of them. fit: makes the estimator of a curve."""

    def __init__(self, fit: Callable[[NDArray[np.float64]], Any]) -> None:
        self._fit, self.kept = fit, ()
        self._failure: BaseException | None = None
        self._making: Thread | None = None

    def of(self, curve: NDArray[np.float64]) -> Skin | None:
        """The one that was fitted to this very curve; None where there is none."""
        return next((skin for skin in self.kept if np.array_equal(skin.curve, curve)), None)

    def made(self, curve: NDArray[np.float64]) -> Skin:
        """One fitted to this curve, now."""
        skin = Skin(curve, self._fit(curve))
        self.kept = (*self.kept, skin)[-SKINS_KEPT:]
        return skin

    def at_once(self, curve: NDArray[np.float64]) -> Skin:
        """The nearest there is, while one for this curve is made beside where it is needed soon.

        Only the first is waited for. Raises what the making of one before raised.
        """
        if self._failure:
            failure, self._failure = self._failure, None
            raise failure
        nearest = self._nearest(curve)
        if nearest is None:
            return self.made(curve)
        if away(nearest.curve, curve) > AHEAD * ALIKE and not self.busy:
            self._making = Thread(target=self._make, args=(curve,), daemon=True)
            self._making.start()
        return nearest

    @property
    def busy(self) -> bool:
        """Whether one is being made beside."""
        return self._making is not None and self._making.is_alive()

    def _nearest(self, curve: NDArray[np.float64]) -> Skin | None:
        return min(self.kept, key=lambda skin: float(away(skin.curve, curve)), default=None)

    def _make(self, curve: NDArray[np.float64]) -> None:
        try:
            self.made(curve)
        except Exception as failure:  # of whatever makes tables; told by the next that asks
            self._failure = failure


def away(curve: NDArray[np.float64], other: NDArray[np.float64]) -> NDArray[np.float64]:
    """Root mean square of |ln Z - ln Z'|, whose real and imaginary parts are the numbers, (...)."""
    return np.sqrt(np.square(curve - other).mean(axis=-1) * 2)

"""Cache of estimators with tables for a skin, found by its baseline curve."""

from __future__ import annotations

from collections.abc import Callable
from threading import Thread
from typing import Any, NamedTuple

import numpy as np

from ...simulator.arrays import Real

SAME_SKIN_RMS = 0.015
"""Maximum root mean square change of ln Z for which a skin counts as the same."""
REFIT_SHARE = 0.5
"""Fraction of SAME_SKIN_RMS from which on new tables are computed ahead."""
MAX_SKINS = 16
Fit = Callable[[Real], Any]


class FittedSkin(NamedTuple):
    """An estimator, and the baseline curve that it was fitted to, shape (number,)."""

    curve: Real
    estimator: Any


class SkinCache:
    """The latest MAX_SKINS estimators.

    in_background: True if new ones are fitted in the background, and the nearest serves meanwhile.
    """

    def __init__(self, *, in_background: bool = False) -> None:
        self.kept: tuple[FittedSkin, ...] = ()
        self._in_background = in_background
        self._failure: BaseException | None = None
        self._making: Thread | None = None

    def of(self, curve: Real, fit: Fit) -> FittedSkin:
        """The estimator of a curve. fit: makes one."""
        if self._in_background:
            return self._near(curve, fit)
        same = (skin for skin in self.kept if np.array_equal(skin.curve, curve))
        return next(same, None) or self._fitted(curve, fit)

    def _fitted(self, curve: Real, fit: Fit) -> FittedSkin:
        """Fit an estimator to this curve now."""
        skin = FittedSkin(curve, fit(curve))
        self.kept = (*self.kept, skin)[-MAX_SKINS:]
        return skin

    def _near(self, curve: Real, fit: Fit) -> FittedSkin:
        """The nearest estimator; one for this curve is fitted in the background if needed.

        The call waits only for the first one. Raises the error of an earlier fit in the background.
        """
        if self._failure:
            failure, self._failure = self._failure, None
            raise failure
        nearest = self._nearest(curve)
        if nearest is None:
            return self._fitted(curve, fit)
        if rms_distance(nearest.curve, curve) > REFIT_SHARE * SAME_SKIN_RMS and not self.busy:
            self._making = Thread(target=self._make, args=(curve, fit), daemon=True)
            self._making.start()
        return nearest

    @property
    def busy(self) -> bool:
        """True if an estimator is being fitted in the background."""
        return self._making is not None and self._making.is_alive()

    def _nearest(self, curve: Real) -> FittedSkin | None:
        return min(self.kept, key=lambda skin: float(rms_distance(skin.curve, curve)), default=None)

    def _make(self, curve: Real, fit: Fit) -> None:
        try:
            self._fitted(curve, fit)
        except Exception as failure:  # of any table builder; `_near` raises it next
            self._failure = failure


def rms_distance(curve: Real, other: Real) -> Real:
    """Root mean square of |ln Z - ln Z'|, whose real and imaginary parts are the numbers, (...)."""
    return np.sqrt(np.square(curve - other).mean(axis=-1) * 2)

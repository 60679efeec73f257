"""Memory of creeping foam on the cells of a batch of skins.

This is `measure.foam_state` for cells in place of touches: each cell creeps under the load on it,
recovers without one, and relaxes at a fixed depth.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from typing import Self

import numpy as np

from ..arrays import Integer, Mask, Real
from ..measure.foam_state import NEGLIGIBLE
from ..press.batch import PressBatch
from ..press.foam_creep import Creep, unloading_strain
from ..scene.parts import Skin
from ..sweeps import InputError


class FoamMemory:
    """State of the foam since the latest change of the press on each skin.

    Only cells that were pressed at any time have a state; `_cells` are their numbers, ascending.
    Arrays have the shape (skin, cell), internal strains y (solid, skin, cell).
    """

    def __init__(self, skin: Skin, cells: int, skins: int) -> None:
        """cells: number of cells of the foam; parts of higher numbers do not creep."""
        self._skin, self._foam, self._creep = skin, skin.foam, Creep.of(skin.foam)
        self._count, self._cells = cells, np.zeros(0, dtype=np.int64)
        self._factor = np.ones((skins, 0))
        self._strain, self._largest, self._at_once = np.zeros((3, skins, 0))
        self._y = self._creep.nothing(skins, 0)
        self._fixed = np.zeros(skins, dtype=bool)
        self._since = np.zeros(skins)
        self._elsewhere = PressBatch.of([(self._cells, np.zeros(0))] * skins)

    def copy(self) -> Self:
        """An independent memory of the same state. Arrays are replaced, never changed."""
        return copy(self)

    def press(self, batch: PressBatch, fixed: Mask, now: float) -> None:
        """Presses all skins from now on. now: s by the sensor's clock.

        fixed: True for skins whose press fixes depths, shape (skin,); others carry loads. Raises
        InputError for loads under which the foam would creep too far.
        """
        on_foam = batch.cells < self._count
        self._extend(np.unique(batch.cells[on_foam]))
        factor = np.ones(self._factor.shape)
        at = np.searchsorted(self._cells, batch.cells[on_foam])
        np.add.at(factor, (batch.press[on_foam], at), batch.rises[on_foam])
        new = (factor != self._factor).any(axis=1) | (fixed != self._fixed)
        strain = np.where(new[:, None], self._foam.strain_at(factor), self._strain)
        y = np.where(new[:, None], self._y_at(now), self._y)
        loaded = (strain > 0) & ~fixed[:, None]
        largest = np.where(loaded, np.maximum(strain, self._largest), 0.0)
        loads = new & ~fixed
        self._check_far(strain[loads], y[:, loads])
        self._factor, self._strain, self._y, self._fixed = factor, strain, y, fixed
        self._largest, self._since = largest, np.where(new, now, self._since)
        unloading = unloading_strain(strain, largest, self._foam.hysteresis or 0.0)
        self._at_once = np.where(loaded, unloading, strain)
        self._elsewhere = batch.where(~on_foam)

    def unpress(self, skins: Sequence[int], now: float) -> None:
        """Let some skins forget all that pressed them. now: s by the sensor's clock."""
        again = np.isin(np.arange(len(self._since)), skins)
        self._factor = np.where(again[:, None], 1.0, self._factor)
        each = (self._strain, self._largest, self._at_once, self._y)
        self._strain, self._largest, self._at_once, self._y = (
            np.where(again[:, None], 0.0, own) for own in each
        )
        self._fixed, self._since = self._fixed & ~again, np.where(again, now, self._since)
        self._elsewhere = self._elsewhere.where(~again[self._elsewhere.press])

    def pressed(self, now: float) -> PressBatch:
        """Equivalent presses of all skins at a time, s."""
        strain, at_once = self._strain, self._at_once
        crept = at_once + self._y_at(now).sum(axis=0)
        crept = np.where(crept > NEGLIGIBLE, crept, 0.0)
        crept = np.where(self._fixed[:, None] & (strain > 0), strain, crept)
        beyond = self._factor / self._foam.factor_at(strain)
        by_strain = beyond * self._foam.factor_at(crept)
        rises = np.where(crept == strain, self._factor, by_strain) - 1
        skin, cell = np.nonzero(rises)
        starts = np.searchsorted(skin, np.arange(len(rises) + 1))
        on_foam = PressBatch(self._cells[cell], rises[skin, cell], starts)
        return on_foam.and_(self._elsewhere)

    def _y_at(self, now: float) -> Real:
        """Internal strains at a time, s."""
        seconds = now - self._since
        y = self._creep.loaded(self._y, self._at_once, self._creep.decay(seconds))
        for skin in np.flatnonzero(self._fixed):
            pressed = self._strain[skin] > 0
            own = self._y[:, skin, pressed], self._strain[skin, pressed], float(seconds[skin])
            y[:, skin, pressed] = self._creep.clamped(*own)
        return y

    def _extend(self, cells: Integer) -> None:
        """Adds cells to those with a state."""
        every = np.union1d(self._cells, cells)
        if len(every) == len(self._cells):
            return
        at = np.searchsorted(every, self._cells)

        def widened(values: Real, empty: float = 0.0) -> Real:
            wide = np.full((*values.shape[:-1], len(every)), empty)
            wide[..., at] = values
            return wide

        self._cells, self._factor = every, widened(self._factor, 1.0)
        self._strain, self._largest = widened(self._strain), widened(self._largest)
        self._at_once, self._y = widened(self._at_once), widened(self._y)

    def _check_far(self, strain: Real, y: Real) -> None:
        reached = float(self._creep.greatest(y, strain).max(initial=0.0))
        allowed = self._foam.greatest_strain
        if reached > allowed:
            raise InputError(
                f"{self._skin.name}: under these contacts the foam would creep to {reached:.3g} "
                f"of its thickness; it must stay within {allowed:.3g}: press less, or reduce "
                "`share` of skin.foam.relaxation"
            )

"""Memory of creeping foam on the cells of a batch of skins.

This is `measure.foam_state` for cells in place of touches: each cell creeps under the load on it,
recovers without one, and relaxes at a fixed depth.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from typing import Self

import numpy as np

from ..arrays import Integer, Mask
from ..press.batch import PressBatch
from ..press.foam_creep import CreepState, check_creep
from ..scene.parts import Skin


class FoamMemory:
    """State of the foam since the latest change of the press on each skin.

    Only cells that were pressed at any time have a state, of the shape (skin, cell); `_cells` are
    their numbers, ascending.
    """

    def __init__(self, skin: Skin, cells: int, skins: int) -> None:
        """cells: number of cells of the foam; parts of higher numbers do not creep."""
        self._skin, self._count, self._cells = skin, cells, np.zeros(0, dtype=np.int64)
        self._state, self._factor = CreepState.unpressed(skin.foam, skins, 0), np.ones((skins, 0))
        self._fixed, self._since = np.zeros(skins, dtype=bool), np.zeros(skins)
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
        strain = self._skin.foam.strain_at(factor)
        state = self._state.then(strain, fixed[:, None], now - self._since)
        reached = float(state.greatest[new].max(initial=0.0))
        check_creep(self._skin.foam, reached, f"{self._skin.name}: under these contacts")
        self._state = _chosen(new, state, self._state)
        self._factor, self._fixed, self._since = factor, fixed, np.where(new, now, self._since)
        self._elsewhere = batch.where(~on_foam)

    def unpress(self, skins: Sequence[int], now: float) -> None:
        """Let some skins forget all that pressed them. now: s by the sensor's clock."""
        again = np.isin(np.arange(len(self._since)), skins)
        unpressed = CreepState.unpressed(self._skin.foam, *self._factor.shape)
        self._state = _chosen(again, unpressed, self._state)
        self._factor = np.where(again[:, None], 1.0, self._factor)
        self._fixed, self._since = self._fixed & ~again, np.where(again, now, self._since)
        self._elsewhere = self._elsewhere.where(~again[self._elsewhere.press])

    def pressed(self, now: float) -> PressBatch:
        """Equivalent presses of all skins at a time, s."""
        decay = self._state.creep.decay(now - self._since)
        rises = self._state.factors(self._factor, decay) - 1
        skin, cell = np.nonzero(rises)
        starts = np.searchsorted(skin, np.arange(len(rises) + 1))
        on_foam = PressBatch(self._cells[cell], rises[skin, cell], starts)
        return on_foam.and_(self._elsewhere)

    def _extend(self, cells: Integer) -> None:
        """Adds cells to those with a state."""
        every = np.union1d(self._cells, cells)
        at = np.full(len(every), -1)
        at[np.searchsorted(every, self._cells)] = np.arange(len(self._cells))
        self._cells, self._state = every, self._state.some(at)
        self._factor = np.where(at < 0, 1.0, np.pad(self._factor, ((0, 0), (0, 1)))[:, at])


def _chosen(these: Mask, one: CreepState, other: CreepState) -> CreepState:
    """State of some skins from one, of the rest from the other."""
    return one.each(lambda new, old: np.where(these[:, None], new, old), other)

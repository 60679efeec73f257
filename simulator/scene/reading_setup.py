"""Readings of a skin: interfaces, frequencies and leads."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .contacts import Interface, taken
from .meter import Leads


@dataclass(frozen=True)
class ReadingSetup:
    """Interfaces, frequencies and leads of a sweep.

    frequency: Hz, ascending, shape (frequency,); an interface may be read at some of them only.
    """

    interfaces: Sequence[Interface]
    frequency: NDArray[np.float64]
    leads: Leads = Leads()

    @property
    def taken(self) -> NDArray[np.bool_] | None:
        """Mask of the readings, or None if all are taken, see `contacts.taken`."""
        return taken(self.interfaces, self.frequency)

    @property
    def read(self) -> NDArray[np.bool_]:
        """Mask of the readings, shape (interface, frequency); all True if all are taken."""
        taken = self.taken
        return np.ones(self.shape, dtype=bool) if taken is None else taken

    def frequency_at(self, interface: str) -> NDArray[np.float64]:
        """Frequencies at which the interface of that name is read, Hz, ascending."""
        number = [each.name for each in self.interfaces].index(interface)
        return self.frequency[self.read[number]]

    @property
    def own(self) -> dict[str, list[float]]:
        """Frequencies of each interface by name, Hz; empty if all readings are taken."""
        if self.taken is None:
            return {}
        return {each.name: self.frequency_at(each.name).tolist() for each in self.interfaces}

    @property
    def shape(self) -> tuple[int, int]:
        """Numbers of interfaces and of frequencies."""
        return len(self.interfaces), len(self.frequency)

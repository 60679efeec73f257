"""What is read of a skin: through which interfaces, at which frequencies, behind which leads."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .contacts import Interface, taken
from .meter import Leads


@dataclass(frozen=True)
class ReadingSetup:
    """frequency: Hz, ascending, shape (frequency,); interfaces may be read at some of them."""

    interfaces: Sequence[Interface]
    frequency: NDArray[np.float64]
    leads: Leads = Leads()

    @property
    def taken(self) -> NDArray[np.bool_] | None:
        """Which interface is read at which frequency, see `contacts.taken`."""
        return taken(self.interfaces, self.frequency)

    @property
    def read(self) -> NDArray[np.bool_]:
        """The same, all True where all are read at all; shape (interface, frequency)."""
        taken = self.taken
        return np.ones(self.shape, dtype=bool) if taken is None else taken

    def frequency_at(self, interface: str) -> NDArray[np.float64]:
        """Those that the interface of that name is read at, Hz, ascending."""
        number = [each.name for each in self.interfaces].index(interface)
        return self.frequency[self.read[number]]

    @property
    def own(self) -> dict[str, list[float]]:
        """Those of every interface by name, Hz; empty where all are read at all."""
        if self.taken is None:
            return {}
        return {each.name: self.frequency_at(each.name).tolist() for each in self.interfaces}

    @property
    def shape(self) -> tuple[int, int]:
        """(interfaces, frequencies)."""
        return len(self.interfaces), len(self.frequency)

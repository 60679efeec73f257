"""What is read of a skin: through which interfaces, at which frequencies, behind which leads."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .contacts import Interface, taken
from .meter import Leads


@dataclass(frozen=True)
class Reading:
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

    @property
    def shape(self) -> tuple[int, int]:
        """(interfaces, frequencies)."""
        return len(self.interfaces), len(self.frequency)

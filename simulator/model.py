"""The face that every fidelity shows: a press and frequencies in, complex impedance out."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from simulator.press import Press
from simulator.scene import Scene


class Model(Protocol):
    """A scene made ready for presses: `Lumped`, `Line` or `Sheet`."""

    scene: Scene

    def impedance(self, press: Press, frequency: NDArray[np.float64]) -> NDArray[np.complex128]:
        """Z in ohm, shape (interface, frequency). frequency: Hz."""
        ...

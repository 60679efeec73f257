"""The deviation form in complex64."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rivals import deviation_form
from rivals.cells import Cells
from simulator.press import Press
from simulator.scene import Scene


def impedance(scene: Scene, press: Press, frequencies: NDArray, cells: Cells) -> NDArray:
    """Z of the deviation form, rounded to seven digits throughout."""
    return deviation_form.impedance(scene, press, frequencies, cells, np.complex64)

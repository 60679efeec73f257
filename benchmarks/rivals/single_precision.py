"""The deviation form in complex64."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.rivals import deviation_form
from rcskin.benchmarks.rivals.cells import Cells
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.scene import Scene


def impedance(scene: Scene, press: Press, frequencies: NDArray, cells: Cells) -> NDArray:
    """Z of the deviation form, rounded to seven digits throughout."""
    return deviation_form.impedance(scene, press, frequencies, cells, np.complex64)

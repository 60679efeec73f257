"""All that a block needs, imported and with its kernels loaded, by making a small reduced model.

For the process that workers are copies of, which has nothing else to do.
"""

from __future__ import annotations

import numpy as np

from ..models.reduced.greedy import reduce
from ..scene.scene_files import load_scene
from .work_block import make_block

SCENE, RTOL = "sheet-3x3", 1e-2
READY = make_block
"""What workers are then asked for."""


def preload_kernels() -> None:
    """Load what the first block would load."""
    skin = reduce(load_scene(SCENE), RTOL).skin(None)
    cell, rise = np.zeros(1, dtype=np.int64), np.ones(1)
    skin.sweep(cell, rise)
    skin.certificate(cell, rise)


preload_kernels()

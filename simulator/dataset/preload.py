"""Imports everything that a block needs and loads its kernels by making a small reduced model.

The server from which workers are forked imports this module.
"""

from __future__ import annotations

import numpy as np

from ..models.reduced.greedy import reduce
from ..scene.scene_files import load_scene
from .work_block import make_block

SCENE, RTOL = "sheet-3x3", 1e-2
READY = make_block
"""The function that workers will run."""


def preload_kernels() -> None:
    """Loads what the first block would load."""
    skin = reduce(load_scene(SCENE).parts, RTOL).at(None)
    cell, rise = np.zeros(1, dtype=np.int64), np.ones(1)
    skin.sweep(cell, rise)
    skin.certificate(cell, rise)


preload_kernels()

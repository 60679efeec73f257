"""Where there is skin for a touch to be."""

import numpy as np
from rcskin.simulator.scene.skin_region import covers


def test_a_mesh_covers_what_its_triangles_do(kinds):
    x = np.stack(np.meshgrid(np.linspace(-0.01, 0.13, 15), np.linspace(-0.01, 0.07, 9)))
    within = (x[0] > 0) & (x[0] < 0.12) & (x[1] > 0) & (x[1] < 0.06)
    beyond = (x < -1e-9).any(axis=0) | (x[0] > 0.12 + 1e-9) | (x[1] > 0.06 + 1e-9)
    found = covers(kinds["mesh"].skin, x)
    assert found[within].all() and not found[beyond].any()

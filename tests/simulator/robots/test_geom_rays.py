"""Rays enter geoms where MuJoCo says."""

import mujoco
import numpy as np
import pytest
from rcskin.simulator.robots.tactile_image import entry

SIZES = {
    "sphere": [0.02, 0, 0],
    "ellipsoid": [0.02, 0.03, 0.01],
    "capsule": [0.01, 0.02, 0],
    "cylinder": [0.02, 0.01, 0],
    "box": [0.02, 0.01, 0.03],
}


@pytest.mark.parametrize("kind", SIZES)
def test_rays_enter_where_mujoco_says(kind):
    rng = np.random.default_rng(1)
    origins = rng.uniform(-0.1, 0.1, (3, 200))
    origins[:, np.linalg.norm(origins, axis=0) < 0.05] *= 10
    aim = rng.uniform(-0.02, 0.02, origins.shape) - origins
    directions = aim / np.linalg.norm(aim, axis=0)
    number = getattr(mujoco.mjtGeom, f"mjGEOM_{kind.upper()}")
    size = np.array(SIZES[kind], dtype=float)
    expected = np.array(
        [
            mujoco.mju_rayGeom(np.zeros(3), np.eye(3).ravel(), size, each, ray, number)
            for each, ray in zip(origins.T.copy(), directions.T.copy(), strict=True)
        ]
    )
    found = entry(kind, size, origins, directions)
    assert ((expected < 0) == np.isinf(found)).all() and np.isinf(found).any()
    hit = expected >= 0
    assert found[hit] == pytest.approx(expected[hit], abs=1e-9)


def test_a_ray_along_an_axis_enters_a_cylinder_by_its_end():
    origins = np.array([[0.01, 0.03], [0.0, 0.0], [-0.05, -0.05]])
    up = np.tile([[0.0], [0.0], [1.0]], 2)
    found = entry("cylinder", np.array([0.02, 0.01, 0.0]), origins, up)
    assert found[0] == pytest.approx(0.04) and np.isinf(found[1])

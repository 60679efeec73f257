"""Tables of scenes whose interfaces have their own frequencies."""

import numpy as np
import pytest
from rcskin.simulator.inversion.touch_templates import _unknown_skin, templates
from rcskin.simulator.scene.scene_files import load_scene

READOUT = {
    "magnitude_accuracy": 2e-3,
    "phase_accuracy": 2e-3,
    "magnitude_noise": 3e-3,
    "phase_noise": 3e-3,
}
TAKEN = np.array([[True, True, False], [False, True, True]])
KEPT = np.tile(TAKEN.ravel(), 2)
OWN = {"interface.1.frequencies": [1e3, 1e4], "interface.2.frequencies": [1e4, 1e5]}
CLOSE = {"rtol": 1e-6, "atol": 1e-9}


@pytest.fixture(scope="module")
def scenes():
    changes = {"pixels": 2, "sweep.frequencies": [1e3, 1e4, 1e5], "readout": READOUT}
    scene = load_scene("sheet-5x5-two-interfaces").with_(changes)
    return scene.with_(OWN), scene


@pytest.mark.parametrize(
    "target", ["pixel", "pair", pytest.param("position", marks=pytest.mark.slow)]
)
def test_tables_are_rows_of_those_of_all_readings(scenes, target):
    part, whole = (templates(scene.parts, target) for scene in scenes)
    by_last = {"deviation", "single", "slope", "shift", "pair", "values"}
    by_last_but_one = {"skin"}
    assert part.keys() == whole.keys()
    for name, table in whole.items():
        if name in by_last:
            table = table[..., KEPT]
        if name in by_last_but_one:
            table = table[..., KEPT, :]
        if name != "drift":
            np.testing.assert_allclose(part[name], table, **CLOSE)


def test_a_skin_is_estimated_from_the_readings_that_are_taken(scenes):
    """As by all readings of which those that are not taken err without bounds."""
    part, whole = (_unknown_skin(scene.parts, False) for scene in scenes)
    curve = whole.baseline() + 0.05 * np.cos(np.arange(KEPT.size))
    found = part.conditioned_on_baseline(curve[KEPT], 8)
    assert found.baseline().shape == (KEPT.sum(),)
    tables = templates(scenes[0].parts, "pixel", baseline=curve[KEPT], averaged=8)
    assert tables["single"].shape[-1] == KEPT.sum() and np.isfinite(tables["skin"]).all()
    before = np.linalg.norm(part.baseline() - curve[KEPT])
    assert np.linalg.norm(found.baseline() - curve[KEPT]) < before

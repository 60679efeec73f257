"""Data sets of gains: their quantities, and the same skins as those of impedances."""

import numpy as np
import pytest
from rcskin.simulator.dataset.dataset_plan import DatasetPlan
from rcskin.simulator.dataset.memory_dataset import in_memory
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.scene.supports import supported
from rcskin.simulator.sweeps import InputError, impedance
from rcskin.simulator.sweeps.schema import complex_readings

R = 1e6
SCENE = load_scene("strip-1x5").with_(
    {"readout": {"display_digits": 17}, "dataset.session.sweeps_per_session": 10}
)
GAIN = SCENE.with_({"interface.left.reader": "gain", "interface.left.series_resistance": R})


@pytest.mark.parametrize("magnitude_only", [False, True])
def test_a_data_set_of_gains_has_those_of_its_impedances(magnitude_only):
    gains = GAIN.with_({"interface.left.magnitude_only": magnitude_only})
    own, Z = (
        in_memory(DatasetPlan(gains.parts, 20, 1, 1e-4)),
        impedance(in_memory(DatasetPlan(SCENE.parts, 20, 1, 1e-4))),
    )
    expected = Z / (R + Z)
    assert ("gain_phase" in own) == (not magnitude_only)
    assert not {"Rs", "X", "Cp"} & set(own.variables)
    found = complex_readings(own)
    np.testing.assert_allclose(np.abs(found), np.abs(expected), rtol=1e-9)
    if not magnitude_only:
        np.testing.assert_allclose(found, expected, rtol=1e-9)


def test_foam_that_creeps_is_not_read_at_nodes_driven_together():
    other = {"high": ["bottom-left"], "series_resistance": R}
    creeping = GAIN.with_(
        {
            "contact": [
                {"name": "top-left", "electrode": "top", "edge": "left"},
                {"name": "bottom-left", "electrode": "bottom", "edge": "left"},
                {"name": "top-right", "electrode": "top", "edge": "right"},
            ],
            "interface.left.driven_with": [{**other, "high": ["top-right"]}],
            "skin.foam": {
                "thickness": 2e-3,
                "relative_permittivity": 1.4,
                "relaxation": [{"share": 0.2, "time_constant": 1.0}],
            },
        }
    )
    with pytest.raises(InputError, match=r"with `interface\.driven_with`; leave out one"):
        supported("a data set", creeping.parts)

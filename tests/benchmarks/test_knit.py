"""The ladder that stands for a knitted pad agrees with the model where it has the same physics."""

import numpy as np
import pytest
from rcskin.benchmarks.measured.knit import KEYS, Ladder, gains
from rcskin.simulator.scene.scene_files import load_scene

FEW = load_scene("knit-36").with_({"sweep.frequencies": [2e3, 1e4, 25750.0]})


@pytest.mark.parametrize(("key", "touch"), [(0, 0.0), (1, 40e-12), (20, 20e-12)])
def test_a_uniform_ladder_is_the_yarn(key, touch):
    found = np.abs(Ladder().gains(FEW.frequencies, key, touch))
    np.testing.assert_allclose(found, gains(FEW, key, touch), rtol=2e-3)


def test_a_ladder_read_from_its_other_end_has_mirrored_gains():
    here, there = (Ladder().gains(FEW.frequencies, key, 30e-12) for key in (4, KEYS - 3))
    np.testing.assert_allclose(here, there[::-1], rtol=1e-9)


def test_coupled_courses_and_touches_beside_change_the_gains_and_keep_the_charge():
    """At low frequency a touch counts wholly, on whatever course it lies."""
    slow = np.array([1.0])
    whole, beside = (Ladder(beside=share).gains(slow, 9, 30e-12) for share in (0.0, 0.5))
    np.testing.assert_allclose((1 - whole).sum(), (1 - beside).sum(), rtol=1e-3)
    apart, coupled = (Ladder(coupling=c).gains(FEW.frequencies) for c in (0.0, 2e-12))
    assert (np.abs(coupled / apart - 1) > 1e-4).any()

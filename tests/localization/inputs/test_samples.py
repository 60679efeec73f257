"""Which of the samples a localizer is shown."""

import numpy as np
import pytest
from rcskin.localization.inputs.features import default_quantities
from rcskin.localization.inputs.samples import samples_of
from rcskin.simulator.sweeps import concatenate


@pytest.fixture
def samples(make_sweeps):
    """Of two columns in five sessions of four sweeps; the second is pressed from the third on."""

    parts = [make_sweeps(1, 2, 2, unpressed=False, session=k, seed=k) for k in range(5)]
    sweeps = concatenate(parts)
    found = samples_of(sweeps, "column", ("lnZ", "phase"))
    assert set(found.y) == {1, 2}
    lacking = (found.y == 2) & (found.sessions < 2)
    return found.part(np.flatnonzero(~lacking))


def test_the_first_sessions_are_shown(samples):
    assert set(samples.first_sessions(3).sessions) == {0, 1, 2}
    assert samples.first_sessions(None) is samples and samples.first_sessions(5) is samples


def test_further_sessions_are_shown_until_each_class_is_there_twice(samples):
    shown = samples.first_sessions(1)
    assert set(shown.sessions) == {0, 1, 2}
    assert np.unique(shown.y, return_counts=True)[1].min() >= 2


def test_the_curve_at_rest_is_a_default_feature_from_enough_sessions_on(make_sweeps):
    sweeps = concatenate([make_sweeps(1, 2, 2, session=k, seed=k) for k in range(3)])
    changes, curve = ("dlnZ", "dphase"), ("lnZ0", "phase0")
    assert default_quantities(sweeps, curve=3) == (*changes, *curve)
    assert default_quantities(sweeps, curve=4) == default_quantities(sweeps) == changes
    assert default_quantities(sweeps.isel(sweep=sweeps["row"] > 0), curve=1) == ("Rs", "Cp")

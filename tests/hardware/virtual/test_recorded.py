"""A recording played back: between the frequencies that an interface was read at, never beyond."""

import numpy as np
import pytest
from rcskin.hardware.virtual.recorded_skin import RecordedSkin
from rcskin.simulator.sweeps import InputError, build

FREQUENCY = np.geomspace(1e2, 1e5, 7)
TAKEN = np.array([[1, 1, 1, 1, 0, 0, 0], [0, 1, 0, 1, 0, 1, 1]], dtype=bool)


@pytest.fixture
def sweeps():
    Z = (1 + 1 / (2j * np.pi * FREQUENCY * 1e-9)) * np.array([[[1.0], [2.0]]])
    labels = {"interface": ["left", "right"], "press": ["none"], "row": [0], "column": [0]}
    return build(
        np.where(TAKEN, Z, np.nan), FREQUENCY, **labels, session=[0], taken=TAKEN
    ).dataset()


def test_an_interface_plays_back_what_it_was_read_at(sweeps):
    right = RecordedSkin(sweeps, "right")
    press = right.check("none")
    for frequency in (FREQUENCY[2], FREQUENCY[5], 3e4):
        expected = 2 * (1 + 1 / (2j * np.pi * frequency * 1e-9))
        assert abs(right.impedance(press, float(frequency)) / expected - 1) < 1e-4


def test_beyond_its_own_frequencies_it_says_so(sweeps):
    left = RecordedSkin(sweeps)
    with pytest.raises(InputError, match=r"frequency must be in 99\.99\.\.3162\.59 Hz"):
        left.impedance(left.check("none"), 3e4)

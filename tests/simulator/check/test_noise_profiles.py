"""Noise that the scene states over frequency: what it excuses, and what it does not."""

import numpy as np
import pytest
from rcskin.simulator.check.noise_profiles import noise_profiles
from rcskin.simulator.measure.readout import read_out
from rcskin.simulator.sweeps.examination import examine
from rcskin.simulator.sweeps.schema import complex_readings

FREQUENCY = np.geomspace(1e3, 2e5, 20)
MULTISINE = {"feedback_resistance": 40e3, "peak_voltage": 1.0, "frame": 8e-3}


def line(RC=1e-5):
    q = np.sqrt(2j * np.pi * FREQUENCY * RC)
    return 1e5 / (q * np.tanh(q))


@pytest.fixture
def noisy(make_sweeps):
    """Sweeps of a line whose lowest reading has 40 times the noise of the highest."""
    profile = 1 + 40 * (FREQUENCY[0] / FREQUENCY) ** 1.5
    random = np.random.default_rng(3)
    noise = random.standard_normal((2, 60, 20)) * profile * 3e-5
    Z = line() * (1 + noise[0] + 1j * noise[1])
    return make_sweeps(60, ["meter"], FREQUENCY, Z[:, None]), {"meter": 7 * profile}


def broken(sweeps, **more):
    return {each.sweep for each in examine(sweeps, **more) if each.broken}


def test_the_noisiest_reading_is_not_taken_for_a_broken_law(noisy):
    sweeps, profiles = noisy
    assert len(broken(sweeps)) > 10
    assert broken(sweeps, profiles=profiles) == set()


def test_an_error_where_noise_is_low_is_found_as_before(noisy):
    sweeps, profiles = noisy
    sweeps["Rs"][5, 0, 12] *= 1.01
    sweeps["X"][5, 0, 12] *= 1.01
    assert broken(sweeps, profiles=profiles) == {5}


def test_a_profile_never_makes_the_limits_stricter(noisy):
    sweeps, _ = noisy
    wrong = {"meter": np.geomspace(1.0, 1e3, 20)}
    for with_it, without in zip(examine(sweeps, profiles=wrong), examine(sweeps), strict=True):
        assert (with_it.noise >= without.noise).all()
        assert {each.law for each in with_it.broken} <= {each.law for each in without.broken}


def test_profiles_are_those_of_the_scenes_readout(make_scene, make_sweeps):
    frequencies = np.round(FREQUENCY / 125) * 125
    scene = make_scene(frequencies=frequencies.tolist())
    sweeps = make_sweeps(400, ["meter"], frequencies, np.broadcast_to(line(), (400, 1, 20)).copy())
    assert noise_profiles(None, sweeps) == noise_profiles(scene.parts.meter, sweeps) == {}
    reader = scene.with_({"readout": {"multisine": MULTISINE}, "interface.1.reader": "multisine"})
    read = read_out(sweeps, reader.readout, np.random.default_rng(1))
    (profile,) = noise_profiles(reader.parts.meter, sweeps).values()
    logarithms = np.log(complex_readings(read)[:, 0])
    spread = np.sqrt((logarithms.real.var(axis=0) + logarithms.imag.var(axis=0)) / 2)
    assert profile == pytest.approx(spread, rel=0.15) and profile[0] > 10 * profile[-1]

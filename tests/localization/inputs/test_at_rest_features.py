"""The skin at rest as features: which skin it is, the same for all sweeps of a session."""

import numpy as np
from rcskin.localization.inputs.features import feature_names, features
from rcskin.simulator.sweeps import build

FREQUENCY = np.array([1e3, 1e4, 1e5])


def two_sessions():
    Z = np.array([2e3 - 1e4j, 3e3 - 2e4j])[:, None] / (1 + np.arange(3))
    swept = np.repeat(Z, 2, axis=0)[:, None, :] * np.array([1, 1.1, 1, 0.9])[:, None, None]
    return build(
        swept,
        FREQUENCY,
        interface=["left"],
        press=["none", "1,1", "none", "1,1"],
        row=[0, 1, 0, 1],
        column=[0, 1, 0, 1],
        session=[4, 4, 7, 7],
    )


def test_the_skin_at_rest_of_the_same_session():
    sweeps = two_sessions()
    found = features(sweeps, ["lnZ0", "phase0"])
    logarithm = np.log((sweeps["Rs"] + 1j * sweeps["X"]).values[[0, 0, 2, 2], 0])
    np.testing.assert_allclose(found, np.hstack([logarithm.real, logarithm.imag]))


def test_a_sweep_is_what_it_was_at_rest_and_the_change():
    sweeps = two_sessions()
    rest, change, whole = (features(sweeps, [name]) for name in ("phase0", "dphase", "phase"))
    np.testing.assert_allclose(rest + change, whole)


def test_beside_other_quantities_and_by_name():
    sweeps = two_sessions()
    both = features(sweeps, ["dlnZ", "lnZ0"])
    np.testing.assert_array_equal(both[:, :3], features(sweeps, ["dlnZ"]))
    np.testing.assert_array_equal(both[:, 3:], features(sweeps, ["lnZ0"]))
    names = [f"lnZ0 left {frequency} Hz" for frequency in (1000, 10000, 100000)]
    assert feature_names(sweeps, ["lnZ0"]) == names

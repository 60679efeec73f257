"""The skin at rest as features: which skin it is, the same for all sweeps of a session."""

import numpy as np

from localization.features import feature_names, features
from simulator.sweeps import build

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


def test_means_of_the_skin_at_rest_of_the_same_session():
    sweeps = two_sessions()
    found = features(sweeps, ["skin"])
    logarithm = np.log((sweeps["Rs"] + 1j * sweeps["X"]).values[[0, 0, 2, 2], 0]).mean(axis=-1)
    np.testing.assert_allclose(found, np.column_stack([logarithm.real, logarithm.imag]))


def test_beside_other_quantities_and_by_name():
    sweeps = two_sessions()
    both = features(sweeps, ["dlnZ", "skin"])
    np.testing.assert_array_equal(both[:, :3], features(sweeps, ["dlnZ"]))
    np.testing.assert_array_equal(both[:, 3:], features(sweeps, ["skin"]))
    assert feature_names(sweeps, ["skin"]) == ["skin left lnZ", "skin left phase"]

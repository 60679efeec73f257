"""Bounds from information: against plain inverses, and against the meter's full covariance."""

import numpy as np
import pytest
from rcskin.simulator.bounds.likelihood import (
    LinearLikelihood,
    covariances,
    error_model,
    lower_triangle,
    variances,
)
from rcskin.simulator.sweeps import InputError


def test_bounds_are_the_inverse_of_the_information_whatever_the_units():
    J = np.random.default_rng(1).standard_normal((4, 30, 5)) * [1, 1e3, 1e-3, 1e9, 1]
    information = J.swapaxes(1, 2) @ J
    bound = np.linalg.inv(information)[:, :2, :2]
    np.testing.assert_allclose(covariances(information, 2), bound, rtol=1e-6, atol=1e-20)


def test_an_unknown_without_effect_has_infinite_variance_and_no_influence():
    J = np.random.default_rng(1).standard_normal((30, 3)) * [1, 0, 1]
    alone = np.linalg.inv(J[:, [0, 2]].T @ J[:, [0, 2]])
    found = np.diagonal(covariances(J.T @ J, 3))
    np.testing.assert_allclose(found, [alone[0, 0], np.inf, alone[1, 1]], rtol=1e-9)


def test_two_unknowns_with_one_effect_are_not_resolved():
    J = np.repeat(np.random.default_rng(1).standard_normal((30, 1)), 2, axis=1)
    single = 1 / (J[:, 0] @ J[:, 0])
    assert (np.diagonal(covariances(J.T @ J, 2)) > 1e6 * single).all()


@pytest.mark.parametrize("against_rest", [0, 3])
def test_errors_of_the_session_as_unknowns_are_the_meters_covariance(noisy, against_rest):
    two = {"a": ("top-left", "bottom-left"), "b": ("bottom-left", "top-left")}
    scene = noisy(accuracy=True, interfaces=two)
    model = error_model(scene.parts.setup, scene.parts.meter, scene.frequencies[:3], against_rest)
    deviation = model.deviation.reshape(2, 2, 3)
    plain = np.random.default_rng(2).standard_normal((2, 2, 3, 2))
    J = np.moveaxis(plain / deviation[..., None], 0, 2)
    known = LinearLikelihood.of_cases(J[None], model, np.zeros(2))
    flat = plain.reshape(-1, 2)
    full = np.linalg.inv(flat.T @ np.linalg.solve(model.covariance, flat))
    np.testing.assert_allclose(known.covariances(2)[0], full, rtol=1e-6)


@pytest.mark.parametrize("wanted", [1, 2])
def test_variances_are_those_of_the_covariance_also_of_what_nothing_determines(wanted):
    J = np.random.default_rng(3).standard_normal((5, 6, 4))
    J[1, :, 1], J[2, :, 0] = 2 * J[1, :, 0], 0.0
    information = J.swapaxes(1, 2) @ J + np.diag([0.0, 0.0, 0.5, 2.0])
    found = variances(lower_triangle(information), wanted)
    full = covariances(information, wanted)
    np.testing.assert_allclose(found, np.diagonal(full, axis1=1, axis2=2), rtol=1e-3)
    assert np.isinf(found[2, 0])


def test_a_meter_without_noise_is_refused(noisy):
    with pytest.raises(InputError, match="magnitude_noise.*must be > 0"):
        error_model(noisy(readout={}).parts.setup, noisy(readout={}).parts.meter, np.array([1e3]))

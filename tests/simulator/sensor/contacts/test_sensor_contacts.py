"""Readings of a sensor under contacts, against the full solver that resolves every edge."""

import numpy as np
import pytest
import rcskin
from rcskin import PointContacts

SCENE = "strip-1x4"
COUNT = 6
FOAM = {
    "thickness": 4e-3,
    "capacitance_per_area": 4.9e-9,
    "mechanics": {"porosity": 0.67, "modulus": 30e3, "effective_medium": "constant"},
}


@pytest.fixture(scope="module")
def scene():
    return rcskin.load(SCENE).with_({"skin.foam": FOAM})


@pytest.fixture(scope="module")
def sensor(scene):
    return rcskin.Sensor(scene, noise=False)


def test_forces_anywhere_are_within_the_tolerance(scene, sensor):
    random, (length, width) = np.random.default_rng(3), scene.skin.sides
    radius = random.uniform(0.1, 0.4, COUNT) * width
    x, y = (
        radius + random.random(COUNT) * (length - 2 * radius),
        radius + random.random(COUNT) * (width - 2 * radius),
    )
    force = random.uniform(500, 2000, COUNT) * np.pi * radius**2
    each = zip(x, y, radius, force, strict=True)
    presses = [f"disc({u!r},{v!r},{r!r}):{f!r}N" for u, v, r, f in np.array([*each]).tolist()]
    exact = rcskin.sweep(scene, presses, rtol=1e-4)
    for k in range(COUNT):
        reading = sensor.step(PointContacts(x[k], y[k], force[k], radius[k]), dt=1.0)
        np.testing.assert_allclose(reading.Rs[0], exact.Rs.values[k], rtol=sensor.error)
        np.testing.assert_allclose(reading.Cp[0], exact.Cp.values[k], rtol=sensor.error)
        assert not reading.limited.any()


def test_a_force_too_large_is_limited_and_said(scene, sensor):
    length, width = scene.skin.sides
    reading = sensor.step(PointContacts(length / 2, width / 2, 1e5, width / 4), dt=1.0)
    assert reading.limited.tolist() == [True] and np.isfinite(reading.vector).all()
    assert not sensor.step(None, dt=0.01).limited.any()


@pytest.mark.slow
def test_a_text_by_force_is_the_contact(scene):
    spread = scene.with_({"skin.foam.mechanics.tension": 5.0})
    sensor = rcskin.Sensor(spread, noise=False)
    length, width = spread.skin.sides
    text = f"disc({length / 2!r},{width / 2!r},{width / 5!r}):0.1N"
    by_text = sensor.step(text, dt=1.0)
    contact = PointContacts(length / 2, width / 2, 0.1, width / 5)
    np.testing.assert_array_equal(by_text.vector, sensor.step(contact, dt=1.0).vector)
    exact = rcskin.sweep(spread, [text], rtol=1e-3)
    np.testing.assert_allclose(by_text.Cp[0], exact.Cp.values[0], rtol=3e-3)
    with pytest.raises(rcskin.InputError, match="all by depth or all by force"):
        sensor.step("1,1:1mm+1,3:0.1N", dt=0.01)

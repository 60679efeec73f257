"""Errors of the meters of a batch, and their display."""

import numpy as np
import pytest
import rcskin
from rcskin.simulator.measure.readout import shown_values, with_errors
from rcskin.simulator.measure.skins import METER, stream
from rcskin.simulator.sensor.meter_errors import MeterErrors

GAIN = {"reader": "gain", "series_resistance": 1e5}


def scene_of(reader, digits=6):
    scene = rcskin.load("strip-1x4").with_({"readout.display_digits": digits})
    return scene.with_({f"interface.left.{key}": value for key, value in reader.items()})


@pytest.mark.kernel
@pytest.mark.parametrize(
    "reader", [{}, GAIN, GAIN | {"magnitude_only": True}], ids=["impedance", "gain", "magnitude"]
)
@pytest.mark.parametrize("digits", [3, 6, 17])
def test_the_kernel_is_its_readable_twin(reader, digits):
    scene, skins = scene_of(reader, digits), 3
    random = np.random.default_rng(1)
    size = 10.0 ** random.uniform(-3, 8, (skins, 4))
    reading = size * np.exp(1j * random.uniform(-1.5, 1.5, size.shape))
    meters = MeterErrors(scene.parts.setup, scene.parts.meter, 5, range(skins), True)
    shown = meters.shown(reading[:, 1:], 1, 0, slice(1, 4))
    for skin in range(skins):
        own = stream(5, skin, METER)
        fixed = own.standard_normal((2, 1, 1))[:, 0]
        _, noise = (own.standard_normal((2, 1, 4))[:, 0] for _ in range(2))
        measured = with_errors(scene.readout, reading[skin], scene.frequencies, fixed, noise)
        twin = shown_values(measured, scene.frequencies, scene.parts.setup.kind, scene.readout)
        every = np.array([*twin.values()])
        np.testing.assert_allclose(shown[:, skin], every[:, 1:], rtol=1e-13)


def test_errors_have_the_deviations_of_the_scene():
    scene = scene_of({})
    meters = MeterErrors(scene.parts.setup, scene.parts.meter, 1, range(400), True)
    reading = np.full((400, 4), 1e5 + 0j)
    shown = [meters.shown(reading, sweep, 0, slice(0, 4))[0] for sweep in range(8)]
    departure = np.stack(shown) / 1e5 - 1
    readout = scene.readout
    assert departure.std(axis=(0, 2)).mean() == pytest.approx(readout.magnitude_noise, rel=0.05)
    of_session = np.hypot(readout.magnitude_accuracy, readout.magnitude_noise / 32**0.5)
    assert departure.mean(axis=(0, 2)).std() == pytest.approx(of_session, rel=0.1)

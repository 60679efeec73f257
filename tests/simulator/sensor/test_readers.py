"""Mounted skins of every kind of reader: several interfaces, gains, multisines, fingers."""

import numpy as np
import pytest
import rcskin

RTOL = 1e-2
TWICE = [
    {"name": "one", "high": ["top-left"], "low": ["bottom-left"]},
    {"name": "other", "high": ["top-left"], "low": ["bottom-left"], "frequencies": [1e4]},
]
GAIN = {"interface.left.reader": "gain", "interface.left.series_resistance": 1e5}
MULTISINE = {
    "interface.left.reader": "multisine",
    "readout": {"multisine": {"feedback_resistance": 1e5}},
}


def strip(changes):
    return rcskin.load("strip-1x3").with_({"sweep.frequencies": [1e3, 1e4], **changes})


@pytest.mark.parametrize("changes", [{"interface": TWICE}, GAIN, MULTISINE], ids=str)
def test_readings_are_those_of_the_solver(changes):
    scene = strip(changes)
    sensor = rcskin.Sensor(scene, noise=False, rtol=RTOL)
    reading = sensor.step("1,2:2.0", dt=1.0)
    exact = rcskin.sweep(scene, ["1,2:2.0"], rtol=1e-4)
    for name in scene.parts.setup.kind.names:
        truth = exact[name].values[0]
        np.testing.assert_allclose(getattr(reading, name)[0], truth, rtol=RTOL)
    assert reading.vector.shape == (1, len(sensor.names)) == (1, len(sensor.units))
    assert np.isfinite(reading.vector).all()
    assert set(scene.parts.setup.kind.names) <= set(sensor.last_sweep)


def test_a_meter_with_two_interfaces_reads_one_after_the_other():
    sensor = rcskin.Sensor(strip({"interface": TWICE}), noise=False, rtol=RTOL)
    first = sensor.step(None, dt=0.05).taken_at
    np.testing.assert_allclose(first, [[0.025, 0.03], [np.nan, np.nan]])
    reading = sensor.step(None, dt=0.006)
    np.testing.assert_allclose(reading.taken_at, [[0.025, 0.03], [np.nan, 0.055]])
    assert "Cp other 10000 Hz" in sensor.names and "Cp other 1000 Hz" not in sensor.names


def test_a_multisine_reads_all_frequencies_at_once():
    sensor = rcskin.Sensor(strip(MULTISINE), rtol=RTOL)
    assert np.isnan(sensor.step(None, dt=0.0079).vector).all()
    reading = sensor.step(None, dt=0.0002)
    np.testing.assert_allclose(reading.taken_at, [[0.008, 0.008]])
    assert reading.fresh.all()


def test_a_gain_has_no_capacitance():
    sensor = rcskin.Sensor(strip(GAIN), rtol=RTOL)
    with pytest.raises(AttributeError, match="have no Cp: they have gain, gain_phase"):
        _ = sensor.step(None, dt=0.1).Cp


def test_models_localize_what_a_sensor_reads():
    scene = strip({"dataset.session.sweeps_per_session": 60})
    model = rcskin.train(rcskin.dataset(scene, 180, rtol=RTOL), "column", quantities="lnZ,phase")
    sensor = rcskin.Sensor(scene, skins=3, session="drawn", rtol=RTOL)
    sensor.step(["1,1", "1,2", "1,3"], dt=0.02)
    answers = rcskin.localize(model, sensor.last_sweep)
    assert len(answers.labels) == 3

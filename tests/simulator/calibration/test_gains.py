"""Calibration to gains, read with their phase or as magnitudes alone."""

import numpy as np
import pytest
from rcskin.simulator.calibration.command import Options
from rcskin.simulator.calibration.measurements import measurements_of
from rcskin.simulator.calibration.report import explanations
from rcskin.simulator.calibration.residual_chart import residuals
from rcskin.simulator.calibration.run import calibrate
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.models.parameters import parts_with
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import InputError
from rcskin.simulator.sweeps.reading_quantities import MAGNITUDE

NOISE = 2e-3
TRUTH = {"sheet_resistance": 0.2, "capacitance": -0.3, "stray_capacitance": 4e-12}
CALIBRATING = ("none", "1,2:26pF", "1,6:33pF", "1,11:29pF")
FITTED = Options(fit=tuple(TRUTH), fix=("others",))


@pytest.fixture(scope="module")
def yarn():
    """The knitted pad with a third of its places and a sixth of its frequencies."""
    return load_scene("knit-36").with_(
        {
            "pixels.columns": 12,
            "sweep.frequencies": np.linspace(2e3, 25.75e3, 16).tolist(),
            "readout": {"magnitude_noise": NOISE, "phase_noise": NOISE, "display_digits": 9},
        }
    )


def gains(scene, presses, noise=0.0, seed=0):
    """Gains of a skin with noise."""
    found = simulate(
        Solver(scene.parts, 1e-5),
        [parse_press(each, 2.0, scene.parts.skin, scene.press) for each in presses],
    )
    shape = found["gain"].shape
    magnitude, phase = noise * np.random.default_rng(seed).standard_normal((2, *shape))
    own = {"gain": (found["gain"].dims, found["gain"].values * (1 + magnitude))}
    if "gain_phase" in found:
        own["gain_phase"] = (found["gain"].dims, found["gain_phase"].values + phase)
    return found.assign(own)


@pytest.fixture(scope="module")
def fitted(yarn):
    return calibrate(
        yarn, gains(parts_with(yarn.parts, TRUTH).scene, CALIBRATING, NOISE), FITTED, trials=False
    )


def test_magnitudes_of_an_unpressed_pad_and_three_touches_determine_the_yarn(fitted):
    for name, value in TRUTH.items():
        low, high = fitted.intervals[name]
        assert low < value < high
        assert fitted.identified[name]
    assert fitted.chi_squared == pytest.approx(1, abs=0.3)
    assert fitted.fit.spec.measurements.numbers == 4 * 2 * 16


def test_gains_of_the_other_touches_are_predicted(yarn, fitted):
    """Within 2.5 % rms; the noise of the calibrating sweeps is 0.2 %."""
    others = [f"1,{place}:30pF" for place in (1, 4, 8, 12)]
    true, predicted, stated = (
        gains(scene, others)["gain"].values
        for scene in (parts_with(yarn.parts, TRUTH).scene, fitted.scene, yarn)
    )
    rms = [np.sqrt(np.mean((found / true - 1) ** 2)) for found in (predicted, stated)]
    assert rms[0] < NOISE < 2.5e-2 < 5 * rms[1]


def test_a_touch_keeps_its_capacitance_while_that_of_the_yarn_is_fitted(yarn, fitted):
    """Strengths are fitted as shares of the stated ones: all near 1."""
    for found, reading in zip(fitted.strengths, fitted.fit.spec.measurements.sweeps, strict=True):
        for own, touch in zip(found, reading.press.touches, strict=True):
            assert own == pytest.approx(touch.factor - 1, rel=0.03)


def test_the_report_names_gains(fitted):
    text = " ".join(explanations(fitted))
    assert "rms relative error of gains" in text and "% of |V / V_s|" in text
    assert "mrad" not in text
    assert list(residuals(fitted.fit)) == ["gain"]


@pytest.fixture(scope="module")
def one_node(line):
    """A line of two sheets, read through a resistor with phase."""
    return line.with_(
        {
            "interface.1.reader": "gain",
            "interface.1.series_resistance": 1e5,
            "interface.1.load": {"capacitance": 8e-12},
        }
    )


def test_complex_gains_determine_a_line_and_the_input_of_its_reader(one_node):
    truth = {"sheet_resistance": 0.2, "capacitance": -0.3, "load_capacitance": 12e-12}
    sweeps = gains(parts_with(one_node.parts, truth).scene, ["none", "1,2:2"], NOISE, seed=1)
    options = Options(fit=tuple(truth), fix=("others",))
    found = calibrate(one_node, sweeps, options, trials=False)
    for name, value in truth.items():
        low, high = found.intervals[name]
        assert low < value < high
    assert found.scene.interfaces[0].load.capacitance == found.values["load_capacitance"]
    quantity = next(each for each in found.quantities if each.name == "load_capacitance")
    assert quantity.unit == "F" and quantity.identified


def test_a_series_resistor_is_not_identified_beside_the_impedances_of_the_skin(one_node):
    """A gain depends on ratios of impedances only."""
    free = one_node.with_({"interface.1.load": {"capacitance": 0.0}})
    names = ("sheet_resistance", "capacitance", "series_resistance")
    found = calibrate(
        free, gains(free, ["none"], NOISE), Options(fit=names, fix=("others",)), trials=False
    )
    assert not found.identified["series_resistance"]
    assert any("series_resistance" in each for each in found.unclear)


def test_readings_far_off_are_found_among_magnitudes(yarn):
    sweeps = gains(parts_with(yarn.parts, TRUTH).scene, CALIBRATING, NOISE)
    sweeps["gain"][0, 0, 3] *= 1.4
    sweeps["gain"][2, 1, 9] *= 0.7
    found = calibrate(yarn, sweeps, FITTED, trials=False)
    assert found.fit.spec.tail is not None and found.fit.spec.tail.parts == 1
    for name, value in TRUTH.items():
        low, high = found.intervals[name]
        assert low < value < high


def test_magnitudes_calibrate_a_scene_that_reads_phases_too(one_node):
    sweeps = gains(one_node, ["none"]).drop_vars("gain_phase")
    measured = measurements_of(one_node.parts, sweeps)
    assert measured.parts.setup.kind is MAGNITUDE and measured.per_reading == 1


def test_refusals(line, one_node, read):
    with pytest.raises(InputError, match="the sweeps is the impedance; scene reads the gain: set"):
        calibrate(one_node, read(line))
    with pytest.raises(InputError, match="the sweeps is the gain; scene reads the impedance: set"):
        calibrate(line, gains(one_node, ["none"]))
    with pytest.raises(InputError, match="scene cannot have load_capacitance: no .* reader"):
        calibrate(line, read(line), Options(also=("load_capacitance",)))

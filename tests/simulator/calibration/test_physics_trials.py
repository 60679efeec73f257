"""Physics that a scene lacks, named by the report where residuals have structure, and fitted."""

import numpy as np
import pytest
from rcskin.simulator.calibration.command import Options
from rcskin.simulator.calibration.run import calibrate
from rcskin.simulator.models.line import Line
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.frequency import Loss, laplace_variable, slopes_of_s
from rcskin.simulator.sweeps.schema import DIMENSIONS, impedance

FREQUENCIES = np.geomspace(100, 2e5, 24)
LEAK = 1500.0
FITTED = ("sheet_resistance", "capacitance", "phase_exponent")
FIT = Options(fit=FITTED, fix=("others",))


@pytest.fixture(scope="module")
def skin(line):
    """The line of three pixels at more frequencies, with half the noise."""
    noise = {"readout.magnitude_noise": 1e-3, "readout.phase_noise": 1e-3}
    return line.with_({"sweep.frequencies": FREQUENCIES.tolist(), **noise})


@pytest.fixture(scope="module")
def leaking(skin):
    return skin.with_({"skin.foam.leak": LEAK})


@pytest.mark.parametrize("loss", [Loss(0.02, 0.9, 300.0, 0.03), Loss(0.0, 1.0, 50.0, 0.0)])
def test_slopes_of_s_are_its_derivatives(loss):
    names = {"tangent": "loss_tangent", "exponent": "phase_exponent"}
    slopes = slopes_of_s(FREQUENCIES, loss)
    for name in loss._fields:
        step = 1e-6 * (loss.leak if name == "leak" else 1)
        ends = [
            laplace_variable(FREQUENCIES, loss._replace(**{name: getattr(loss, name) + side}))
            for side in (step, -step)
        ]
        slope = (ends[0] - ends[1]) / (2 * step)
        np.testing.assert_allclose(slopes[names.get(name, name)], slope, rtol=1e-6)


def test_a_leaking_line_conducts_at_low_frequency(leaking):
    """Z = R coth(q) / q, q² = R G at zero frequency: lengths drop out."""
    foam, sheet = leaking.skin.foam, leaking.skin
    R = sheet.both_sheets * sheet.length / sheet.width
    G = LEAK * foam.unpressed_capacitance_per_area * sheet.length * sheet.width
    q = np.sqrt(R * G)
    Z = Line(leaking.parts.skin, leaking.parts.setup).solve(Press(), np.array([1e-3])).Z[0, 0]
    assert Z == pytest.approx(R / q / np.tanh(q), rel=1e-4)


def test_a_leak_is_fitted_on_request(skin, leaking, read):
    sweeps = read(leaking, seed=1)
    found = calibrate(skin, sweeps, Options(fit=FITTED, fix=("others",), also=("leak",)))
    low, high = found.intervals["leak"]
    assert low < LEAK < high < 1.2 * low
    assert found.scene.skin.foam.leak == found.values["leak"]
    quantity = next(each for each in found.quantities if each.name == "leak")
    assert quantity.unit == "1/s" and quantity.identified


def structure(found):
    """The remark on structure, empty without one."""
    return next((each for each in found.remarks if "leaves structure" in each), "")


@pytest.mark.usefixtures("linear_intervals")
def test_a_leak_that_the_scene_lacks_is_named(skin, leaking, read):
    told = structure(calibrate(skin, read(leaking), FIT))
    first, *others = told.partition("in addition, ")[2].split("; ")
    assert first.startswith("a leak of 1.5e+03 1/s (`also` leak) leaves ") and len(others) == 3


@pytest.mark.usefixtures("linear_intervals")
def test_a_film_in_series_is_named(skin, read):
    sweeps = read(skin)
    film = 5e3 / (1 + 2j * np.pi * FREQUENCIES * 5e3 * 5e-9)
    Z = impedance(sweeps) + film
    told = structure(
        calibrate(skin, sweeps.assign(Rs=(DIMENSIONS, Z.real), X=(DIMENSIONS, Z.imag)), FIT)
    )
    assert told.partition("in addition, ")[2].startswith("a film in series of ")


@pytest.mark.usefixtures("linear_intervals")
def test_noise_alone_has_no_structure(skin, read):
    assert not structure(calibrate(skin, read(skin), FIT))

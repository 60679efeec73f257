"""A meter's fixed errors are those of its ranges, the same at every interface."""

import json
import math

import numpy as np
import pytest
from rcskin.simulator.calibration.command import Options
from rcskin.simulator.calibration.measurements import measurements_of
from rcskin.simulator.calibration.run import calibrate
from rcskin.simulator.measure.specimen import MeterSessionErrors
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import build, impedance

pytestmark = pytest.mark.usefixtures("models_made_once")

NAMES = ("sheet_resistance", "capacitance", "lead_inductance")
PRESSES = ("none", "none", "none", "1,2", "2,1")


@pytest.fixture(scope="module")
def sheet():
    """Two interfaces, and a meter whose ranges err by far more than its readings scatter."""
    return load_scene("sheet-5x5-two-interfaces").with_(
        {
            "pixels": 2,
            "sweep.frequencies": np.geomspace(1e3, 2e5, 10).round(3).tolist(),
            "readout": {
                "magnitude_accuracy": 0.02,
                "phase_accuracy": 0.02,
                "magnitude_noise": 2e-3,
                "phase_noise": 2e-3,
            },
            "press": {"factor_spread": 0.05},
        }
    )


def recorded(scene, sweeps, automatic, seed):
    """As a meter records sweeps, in the range of each reading or all in one."""
    errors = MeterSessionErrors(scene.parts.meter, seed)
    ranged = [
        errors.read(z, f, math.ceil(math.log10(abs(z))) if automatic else 7)
        for own in impedance(sweeps).reshape(-1, sweeps.sizes["frequency"]).tolist()
        for z, f in zip(own, sweeps["frequency"].values.tolist(), strict=True)
    ]
    kept = ("interface", "press", "row", "column")
    return build(
        np.reshape(ranged, impedance(sweeps).shape),
        scene.frequencies,
        **{name: list(sweeps[name].values) for name in kept},
        attributes={"settings": json.dumps({"auto_range": automatic})},
    ).dataset()


@pytest.mark.parametrize("automatic", [True, False])
def test_a_step_between_ranges_is_not_taken_for_a_property_of_the_skin(sheet, simulated, automatic):
    options = Options(fit=NAMES, fix=("others",), fixed_strength=True)
    found = calibrate(
        sheet, recorded(sheet, simulated(sheet, None, PRESSES), automatic, seed=2), options
    )
    assert 0.7 < found.chi_squared < 1.4
    assert all(low <= 0 <= high for low, high in found.intervals.values())


def test_a_reading_that_may_be_of_either_of_two_ranges_is_not_used(sheet, simulated):
    """Its |Z| is nearer to a decade than three deviations, those of the range's error included."""
    sweeps = recorded(sheet, simulated(sheet, None, PRESSES), automatic=True, seed=2)
    data = measurements_of(sheet.parts, sweeps)
    decades = np.log10(np.abs(impedance(sweeps)[3:]))
    near = np.abs(decades - decades.round()) < 3 * math.hypot(0.02, 2e-3) / math.log(10)
    assert near.any()
    np.testing.assert_array_equal([each.known for each in data.sweeps[1:]], ~near)
    assert data.numbers == 2 * sum(int(each.known.sum()) for each in data.sweeps)
    frequency = np.flatnonzero(near.all(axis=(0, 1)))[:1]
    alone = measurements_of(sheet.parts, sweeps.isel(frequency=frequency, sweep=slice(3, 4)))
    assert alone.numbers == 4, "all are kept where none is left otherwise"

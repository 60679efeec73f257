"""Fitting L + R + line to its own sweep, and to a measured one as far as it can be matched."""

from pathlib import Path

import numpy as np
import pytest

from simulator import sweeps
from simulator.calibrate import LineFit, fit_line
from simulator.sweeps import InputError

MEASURED = Path(__file__).parents[3] / "shared" / "data" / "blocking_line_eis.csv"
FREQUENCY = np.geomspace(1, 1e4, 40)


@pytest.fixture(scope="module")
def measured():
    if not MEASURED.exists():
        pytest.skip(f"the measured sweep {MEASURED.name} is not beside the project")
    data = sweeps.read(MEASURED)
    return sweeps.impedance(data)[0, 0], data["frequency"].values


@pytest.mark.parametrize("exponent", [1.0, 0.9])
def test_a_line_is_recognised_by_its_own_sweep(exponent):
    truth = LineFit(3e-7, 40.0, 5e3, 2e-7, exponent, 0.0)
    fit = fit_line(truth.impedance(FREQUENCY), FREQUENCY, constant_phase=exponent != 1)
    for name in ("inductance", "resistance", "line_resistance", "line_capacitance", "exponent"):
        assert getattr(fit, name) == pytest.approx(getattr(truth, name), rel=1e-3)
    assert fit.rms_error < 1e-8


def test_the_ideal_line_misses_the_measured_sweep_by_its_known_share(measured):
    Z, frequency = measured
    below = frequency < 1000
    assert 100 * fit_line(Z[below], frequency[below]).rms_error == pytest.approx(8.2, abs=0.05)


def test_a_constant_phase_capacitance_explains_most_of_it(measured):
    Z, frequency = measured
    below = frequency < 1000
    fit = fit_line(Z[below], frequency[below], constant_phase=True)
    assert 100 * fit.rms_error == pytest.approx(3.1, abs=0.05)
    assert fit.exponent == pytest.approx(0.92, abs=0.005)


def test_too_few_readings_are_refused():
    with pytest.raises(InputError, match="at least 8 frequencies, got 3"):
        fit_line(np.ones(3, dtype=complex), np.arange(1.0, 4.0))

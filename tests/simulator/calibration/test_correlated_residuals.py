"""Intervals where residuals are correlated: they widen by what the readings have in common."""

import numpy as np
import pytest
from rcskin.simulator.calibration.command import Options
from rcskin.simulator.calibration.identifiability import MIN_INDEPENDENT
from rcskin.simulator.calibration.report import explanations
from rcskin.simulator.calibration.residual_correlation import integrated_correlation
from rcskin.simulator.calibration.run import calibrate
from rcskin.simulator.sweeps.schema import DIMENSIONS, impedance
from scipy.special import stdtrit

FREQUENCIES = np.geomspace(100, 2e5, 24)
PARAMETERS = 4
NINETY = 0.95
"""Chance below the upper end of a 90 % interval."""


def independent(random, sweeps):
    return random.standard_normal((sweeps, 2, len(FREQUENCIES)))


def smooth(random, sweeps, length=0.2):
    """Errors correlated along the frequency, over `length` decades, equal in all sweeps."""
    x = np.log10(FREQUENCIES)
    covariance = np.exp(-(((x[:, None] - x) / length) ** 2) / 2)
    root = np.linalg.cholesky(covariance + 1e-9 * np.eye(len(x)))
    own = np.einsum("fg,pg->pf", root, random.standard_normal((2, len(x))))
    return np.broadcast_to(own, (sweeps, *own.shape))


def slopes(sweeps):
    """Slopes of four parameters: powers of the logarithm of the frequency, of both parts."""
    x = np.linspace(-1, 1, len(FREQUENCIES))
    powers = np.stack([x**k for k in range(PARAMETERS // 2)], axis=-1)
    parts = np.kron(np.eye(2), powers)
    return np.tile(parts, (sweeps, 1))


@pytest.mark.parametrize("errors", [independent, smooth])
@pytest.mark.parametrize("sweeps", [1, 5])
def test_intervals_of_a_linear_fit_hold_the_truth(errors, sweeps):
    """90 % intervals, of 1,000 twins: widened by a factor of the residuals' own correlation."""
    random, J = np.random.default_rng(0), slopes(sweeps)
    inverse = np.linalg.inv(J.T @ J)
    held, unwidened = [], []
    for _ in range(1000):
        error = errors(random, sweeps)
        off = inverse @ J.T @ error.ravel()
        left = error.ravel() - J @ off
        count = integrated_correlation([left.reshape(error.shape)], PARAMETERS)
        for factor, into in ((count, held), (1.0, unwidened)):
            freedom = max(error.size / factor - PARAMETERS, MIN_INDEPENDENT)
            deviation = np.sqrt(left @ left / freedom * inverse.diagonal())
            into.append(np.abs(off) < stdtrit(freedom, NINETY) * deviation)
    assert 0.86 <= np.mean(held) <= 0.94
    if errors is smooth:
        assert np.mean(unwidened) < 0.75


def test_equal_residuals_of_several_sweeps_count_once():
    own = independent(np.random.default_rng(0), 1)
    alone, repeated = (integrated_correlation([np.repeat(own, n, axis=0)]) for n in (1, 5))
    assert repeated == pytest.approx(5 * alone)


def test_residuals_that_alternate_count_no_more_than_independent_ones():
    sign = np.resize([1.0, -1.0], len(FREQUENCIES))
    assert integrated_correlation([np.tile(sign, (1, 2, 1))]) == 1.0
    assert integrated_correlation([]) == 1.0 == integrated_correlation([np.zeros((1, 2, 12))])


@pytest.fixture(scope="module")
def skin(line):
    """The line at more frequencies, with a meter whose noise is to be estimated."""
    return line.with_({"sweep.frequencies": FREQUENCIES.tolist(), "readout": {"display_digits": 9}})


def test_intervals_of_a_calibration_widen_by_smooth_errors_and_say_so(skin, read):
    """Smooth errors and independent ones of one size: the intervals differ by the correlation."""
    sweeps, random = read(skin), np.random.default_rng(0)
    options = Options(fit=("sheet_resistance", "capacitance"), fix=("others",), robust=False)
    found = {}
    for errors in (smooth, independent):
        both = 0.005 * errors(random, 1)[0]
        Z = impedance(sweeps) * np.exp(both[0] + 1j * both[1])
        changed = sweeps.assign(Rs=(DIMENSIONS, Z.real), X=(DIMENSIONS, Z.imag))
        found[errors] = calibrate(skin, changed, options)
    correlated, alone = found[smooth].information, found[independent].information
    assert alone.correlated < 1.6 < 3 < correlated.correlated
    assert correlated.independent < alone.independent / 3
    widths = [np.ptp(each.intervals["capacitance"]) for each in found.values()]
    assert widths[0] > 1.7 * widths[1]
    text = " ".join(explanations(found[smooth]))
    assert "of them count as one" in text and "do not include the bias by physics" in text
    assert "count as one" not in " ".join(explanations(found[independent]))

"""The least-squares problem: exact slopes, and the meter's errors as its error model has them."""

from dataclasses import replace

import numpy as np
import pytest
from rcskin.simulator.calibration.fit import solve_from
from rcskin.simulator.calibration.fit_options import FitSpec
from rcskin.simulator.calibration.measurements import measurements_of
from rcskin.simulator.calibration.prior import priors
from rcskin.simulator.calibration.problem import LeastSquaresProblem, centered_model, difference
from rcskin.simulator.measure.readout import ErrorModel
from rcskin.simulator.models.parameters import own_values
from rcskin.simulator.press.batch import TouchedCells

PRESSES = ("none", "none", "1,2:1.8+1,3:2.4", "1,1:2.0")
NAMES = ("sheet_resistance", "capacitance", "phase_exponent", "lead_inductance")


def asked_of(scene, sweeps, names=()):
    data, own = (
        measurements_of(scene.parts, sweeps),
        own_values(scene.parts.skin, scene.parts.setup),
    )
    known = priors(data, "wide")
    fixed = {name: value for name, value in own.items() if name not in names}
    return FitSpec(data, scene.readout, {name: known[name] for name in names}, fixed)


def test_slopes_are_exact(line, read):
    asked = asked_of(line, read(line, presses=PRESSES), NAMES)
    problem = LeastSquaresProblem(asked, centered_model(line.parts, {}, 1e-4))
    u = 0.3 * np.random.default_rng(1).standard_normal(
        len(NAMES) + asked.touch_count + asked.error_count
    )
    u[2] = -abs(u[2])
    u[3] = abs(u[3])
    slopes = problem.jacobian(u)
    for k in range(len(u)):
        step = 1e-5 * np.eye(len(u))[k]
        difference = (problem.residuals(u + step) - problem.residuals(u - step)) / 2e-5
        np.testing.assert_allclose(slopes[:, k], difference, atol=1e-6 * abs(slopes[:, k]).max())


def test_unknown_are_strengths_of_touches_and_the_meters_fixed_errors(line, read):
    asked = asked_of(line, read(line, presses=PRESSES), NAMES)
    assert asked.touch_count == 3
    assert asked.error_count == 2
    assert asked.measurements.sweeps[0].averaged == 2


def test_every_session_has_errors_of_its_own(line, read):
    sweeps = read(line, presses=PRESSES)
    sweeps["session"] = ("sweep", np.array([1, 1, 2, 2]))
    asked = asked_of(line, sweeps, NAMES)
    slopes = LeastSquaresProblem(asked, centered_model(line.parts, {}, 1e-4)).jacobian(
        np.zeros(len(NAMES) + 3 + 4)
    )
    seen = np.abs(slopes[:72, -4:]).reshape(3, 2, 12, 4).any(axis=2).any(axis=1)
    assert seen.tolist() == [[True, True, False, False]] + 2 * [[False, False, True, True]]


def test_chi_squared_is_that_of_the_error_models_covariance(line, read):
    sweeps = read(line, {"capacitance": 0.01}, presses=("none",), seed=3)
    asked = asked_of(line, sweeps)
    ready = centered_model(line.parts, {}, 1e-4)
    fit = solve_from(LeastSquaresProblem(asked, ready), asked.fixed)
    Z = ready.slopes(TouchedCells(np.zeros(0, dtype=np.int64), np.zeros(0)), asked.fixed).Z
    off = difference(Z, asked.measurements.sweeps[0].Z)
    whitened = ErrorModel(line.readout, np.ones((1, 12), bool)).whitened(off)
    assert fit.chi_squared == pytest.approx(whitened @ whitened, rel=1e-9)


@pytest.mark.parametrize("strengths", [True, False])
@pytest.mark.parametrize("scale", [1.0, 2.5])
def test_few_rows_have_the_products_of_all(line, read, scale, strengths):
    sweeps = read(line, presses=(*PRESSES, "1,1:1.7", "1,3:2.2"))
    sweeps["session"] = ("sweep", np.array([1, 1, 2, 2, 1, 3]))
    asked = replace(asked_of(line, sweeps, NAMES), strengths=strengths)
    problem = LeastSquaresProblem(asked, centered_model(line.parts, {}, 1e-4))
    u = 0.3 * np.random.default_rng(2).standard_normal(
        len(NAMES) + asked.touch_count + asked.error_count
    )
    whole = np.column_stack([problem.jacobian(u), problem.residuals(u)])
    divided = np.r_[: len(whole) - len(u), len(whole) - len(u) + len(NAMES) : len(whole)]
    whole[divided] /= np.sqrt(scale)
    residuals, slopes = problem.reduced_system(u, scale)
    few = np.column_stack([slopes, residuals])
    assert len(few) <= len(u) + 1
    products = whole.T @ whole
    np.testing.assert_allclose(few.T @ few, products, atol=1e-12 * products.max(), rtol=1e-9)


def test_a_model_about_other_values_answers_alike(line):
    near, far = (
        centered_model(line.parts, {}, 1e-4),
        centered_model(line.parts, {"capacitance": 0.7}, 1e-4),
    )
    values = own_values(line.parts.skin, line.parts.setup) | {
        "capacitance": 0.5,
        "sheet_resistance": -0.2,
    }
    cells, rises = np.array([1]), np.array([0.8])
    one, other = (model.slopes(TouchedCells(cells, rises), values) for model in (near, far))
    np.testing.assert_allclose(other.Z, one.Z, rtol=1e-12)
    np.testing.assert_allclose(other.by_rise, one.by_rise, rtol=1e-12)

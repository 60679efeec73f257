"""How much of creep is left of a sweep after the best single factor, on the paper's 5x5 sheet."""

import numpy as np
import pytest
from rcskin.simulator.chebyshev import Interpolant, extrema
from rcskin.simulator.measure.readout import errors_of, observed
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press, press_on
from rcskin.simulator.press.touch import Touch
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import impedance
from scipy.optimize import minimize_scalar

TIMES = {4: 0.4, 20: 2.0, 50: 5.0}
"""Readings averaged, and s that a sweep of 20 frequencies then takes."""


@pytest.fixture(scope="module")
def sheet():
    return load_scene("sheet-5x5")


def left(sheet, pixel, averaging):
    """Standard deviations of the meter's noise."""
    creep = [{"share": 0.1, "time_constant": 1.0}]
    timing = {"averaging": averaging}
    scene = sheet.with_({"skin.foam.relaxation": creep, "experiment.timing": timing})
    (drifting,) = impedance(
        simulate(
            Solver(scene.parts),
            [press_on(scene.parts.skin, scene.press, f"{pixel[0]},{pixel[1]}:2")],
        )
    )
    solver, noise = Solver(sheet.parts), errors_of(sheet.parts.setup, sheet.parts.meter).deviation
    factors = extrema(1.9, 2.3, 7)
    known = [solver.solve(Press((Touch(*pixel, factor),))).Z for factor in factors.tolist()]
    still = Interpolant(factors, observed(np.stack(known)))
    off = minimize_scalar(
        lambda factor: np.linalg.norm((still(factor) - observed(drifting)) / noise),
        bounds=(1.9, 2.3),
        method="bounded",
    )
    return float(off.fun)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("pixel", "expected"), [((3, 1), [1.4, 3.5, 3.4]), ((3, 5), [0.8, 2.4, 2.9])]
)
def test_creep_of_ten_percent_in_a_second(sheet, pixel, expected):
    """Near the foil and far from it, for sweeps of 0.4, 2 and 5 s."""
    found = [left(sheet, pixel, averaging) for averaging in TIMES]
    assert found == pytest.approx(expected, rel=0.05)

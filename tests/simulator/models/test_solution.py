"""Estimated errors of Rs and Cp, also where Cp is negligible next to the conductance."""

import numpy as np
import pytest
from rcskin.simulator.fem.error_estimate import LOST_SUSCEPTANCE, certified, relative_difference
from rcskin.simulator.models.solution import ModelResult, SolutionProgress
from rcskin.simulator.scene.contacts import Interface
from rcskin.simulator.scene.meter import Leads
from rcskin.simulator.scene.parts import Setup
from rcskin.simulator.sweeps import parallel_capacitance

FREQUENCY = np.array([1e-3, 1.0, 1e3])
ERROR = 1e-6
BETWEEN = Interface(name="a", high=("top",), low=("bottom",))


def answered(Z, error=ERROR):
    progress = SolutionProgress(1, FREQUENCY, 1e-4)
    progress.offer(ModelResult("a rung", 1, np.array([Z]), np.full((2, 1, 3), error)))
    return progress.solution()


@pytest.mark.parametrize("reactance", [0.0, -1e-12, -1e-9])
def test_what_is_written_holds_what_the_estimate_compared(reactance):
    truth = 5e4 * (1.0 + 1j * reactance * np.ones(3))
    Z = truth * (1 + 3e-16j)
    off = relative_difference(np.array([Z]), np.array([truth]))
    answer = answered(Z, off.max())
    missed = parallel_capacitance(Z, FREQUENCY) - parallel_capacitance(truth, FREQUENCY)
    assert (np.abs(missed) <= 1.001 * answer.Cp_error).all()


def test_a_resistor_has_errors_that_are_numbers():
    answer = answered(np.full(3, 5e4 + 0j))
    Rs, Cp = answer.relative_errors
    np.testing.assert_allclose(Rs, ERROR)
    np.testing.assert_allclose(Cp, ERROR)
    tiny = LOST_SUSCEPTANCE / 5e4 / (2 * np.pi * FREQUENCY)
    np.testing.assert_allclose(answer.Cp_error[0], ERROR * tiny)
    assert len(answer.lines()) == 4


def test_leads_that_cancel_the_capacitance_leave_errors_that_are_numbers():
    leads = Leads(resistance=1.0, inductance=1.0)
    Z = 5e4 - 2j * np.pi * FREQUENCY * 1.0
    measured = answered(Z).at_meter(Setup([BETWEEN], FREQUENCY, leads))
    assert (measured.Z.imag == 0).all()
    assert np.isfinite(np.stack(measured.relative_errors)).all()


def test_certificates_of_a_conductance_are_numbers():
    Y, power = np.array([2e-5 + 0j]), np.array([1e-18])
    assert np.isfinite(certified(Y, power)).all()

"""Z between a few solved strengths of a press is Z of the strength itself, to the tolerance."""

import numpy as np
import pytest
from rcskin.localization.study.curve import trace
from rcskin.simulator.fem.estimate import relative_difference
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.touch import Touch
from rcskin.simulator.scene.files import load_scene

SCENE = load_scene("sheet-4x4")
FREQUENCY = SCENE.frequencies


@pytest.fixture(scope="module")
def solver():
    return Solver(SCENE, rtol=1e-7)


@pytest.mark.parametrize("pixel", [(1, 1), (2, 4)])
@pytest.mark.parametrize("rtol", [1e-3, 1e-5])
def test_between_nodes_the_tolerance_is_kept_against_direct_solves(solver, pixel, rtol):
    def solve(factor):
        return solver.solve(Press((Touch(*pixel, factor),))).Z

    factors = np.random.default_rng(1).uniform(1.4, 2.6, 40)
    curve = trace(solve, factors, rtol)
    some = factors[::8]
    direct = np.stack([solve(factor) for factor in some])
    off = relative_difference(curve.impedance(some), direct)
    assert off.max() <= rtol


def test_few_strengths_are_solved_one_by_one(solver):
    factors = [2.5, 1.5, 2.0, 1.5]
    curve = trace(lambda factor: solver.solve(Press((Touch(1, 1, factor),))).Z, factors, 1)
    assert curve.factors.tolist() == [1.5, 2.0, 2.5]
    direct = solver.solve(Press((Touch(1, 1, 2.5),))).Z
    np.testing.assert_allclose(curve.impedance([2.5])[0], direct, rtol=1e-12)


def test_a_kink_is_not_interpolated():
    def kinked(factor):
        return np.array([[(1 + abs(factor - 2)) * (1 - 1j)]])

    factors = np.linspace(1, 3, 50)
    curve = trace(kinked, factors, 1e-6)
    np.testing.assert_array_equal(curve.factors, factors)
    direct = np.stack([kinked(factor) for factor in factors])
    np.testing.assert_allclose(curve.impedance(factors), direct, rtol=1e-12)


def test_a_curve_at_other_frequencies_and_scale():
    curve = trace(lambda factor: np.array([[1 - 1j, 2 - 3j]]), [1.0], 1e-6)
    moved = curve.at(np.array([1]), 10.0)
    np.testing.assert_allclose(moved.impedance([1.0]), [[[20 - 30j]]], rtol=1e-12)

"""Powers of the distance at corners of one and of several conductances, against closed forms."""

import numpy as np
import pytest
from rcskin.simulator.mesh.corner_exponents import MIN_EXPONENT, around, between, stretched

ANGLES = (0.7, np.pi / 2, 2.0, 3 * np.pi / 2, 6.0)
RATIOS = (0.02, 0.5, 3.0, 161.4476)
SURE = 1e-6


@pytest.mark.parametrize("angle", ANGLES)
@pytest.mark.parametrize("conductance", [1e-5, 1.0])
def test_one_wedge(angle, conductance):
    """pi / angle between equal sides, half of that between a foil and a bare edge."""
    wedges = [(0.3 * angle, conductance), (0.7 * angle, conductance)]
    for fixed in (False, True):
        assert between(wedges, fixed, fixed) == pytest.approx(np.pi / angle)
        assert between(wedges, fixed, not fixed) == pytest.approx(np.pi / 2 / angle)


@pytest.mark.parametrize("ratio", RATIOS)
def test_half_a_plane_of_two_conductances(ratio):
    """Fixed on one side: tan²(p pi / 2) is the ratio of the fixed one to the other."""
    wedges = [(np.pi / 2, 1.0), (np.pi / 2, ratio)]
    power = 2 / np.pi * np.arctan(np.sqrt(ratio))
    assert between(wedges, False, True) == pytest.approx(power, abs=SURE)
    assert between(wedges, True, False) == pytest.approx(1 - power, abs=SURE)
    assert between(wedges, False, False) == pytest.approx(1.0)


@pytest.mark.parametrize("ratio", RATIOS)
def test_a_chequerboard(ratio):
    """p = 4 / pi arctan of the square root of the lower over the higher: 0.1 at 161.4476."""
    board = [(np.pi / 2, 1.0), (np.pi / 2, ratio)] * 2
    assert around(board) == pytest.approx(4 / np.pi * np.arctan(min(ratio, 1 / ratio) ** 0.5))
    assert around(board[::-1]) == pytest.approx(around(board))


@pytest.mark.parametrize("ratio", RATIOS)
def test_one_quadrant_of_another_conductance(ratio):
    """cos(pi p / 2) = |1 - R| / (2 (1 + R))."""
    power = 2 / np.pi * np.arccos(abs(1 - ratio) / (2 * (1 + ratio)))
    assert around([(np.pi / 2, ratio), (3 * np.pi / 2, 1.0)]) == pytest.approx(power)


def test_smooth_lines_and_even_sheets_are_no_corners():
    assert around([(np.pi, 1.0), (np.pi, 7.0)]) == pytest.approx(1.0)
    assert around([(2.0, 1.0), (1.0, 1.0), (2 * np.pi - 3.0, 1.0)]) == pytest.approx(1.0)


def test_powers_beyond_the_resolution_of_elements_are_infinite():
    assert between([(0.2, 1.0)], False, False) == np.inf
    assert around([(np.pi / 2, 1.0), (np.pi / 2, 1e-9)] * 2) == MIN_EXPONENT


@pytest.mark.parametrize("turn", [0.0, 0.4, 2.0])
def test_a_sheet_that_conducts_along_a_direction_is_stretched(turn):
    """Four times as well along: there lengths are half, whichever way the axes lie."""
    cos, sin = np.cos(turn), np.sin(turn)
    S = np.array([4 * cos**2 + sin**2, 4 * sin**2 + cos**2, 3 * cos * sin])
    Q = np.array([[cos, -sin], [sin, cos]])
    angle, isotropic = stretched(Q @ [2.0, 0.0], Q @ [2.0, 1.0], S)
    assert angle == pytest.approx(np.pi / 4)
    assert isotropic == pytest.approx(2.0)
    both, _ = stretched(Q @ [1.0, 0.0], Q @ [-1.0, 0.5], S)
    assert both == pytest.approx(3 * np.pi / 4)

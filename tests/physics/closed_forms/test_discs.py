"""Discs and annuli fed at a whole rim, on curved cells: Z in Bessel functions."""

import numpy as np
import pytest
from rcskin.benchmarks.accuracy import known_problems as discs

S = 1j * np.geomspace(1e-6, 1e2, 9)
R1, R2 = 0.3, 1.0


def off(Z, truth):
    """The largest relative error of Rs and Cp."""
    Y, true_Y = 1 / Z, 1 / truth
    return max(abs(Z.real / truth.real - 1).max(), abs(Y.imag / true_Y.imag - 1).max())


def test_formulas_at_low_frequency():
    """Rs(0) = R/(8 pi) for the disc, Cp(0) the whole capacitance for both."""
    s = np.array([1e-4j])
    disc, annulus = discs.disc_formula(s), discs.annulus_formula(s, R1, R2)
    assert disc.real == pytest.approx(1 / (8 * np.pi), rel=1e-6)
    assert (1 / disc).imag / 1e-4 == pytest.approx(np.pi, rel=1e-6)
    assert (1 / annulus).imag / 1e-4 == pytest.approx(np.pi * (R2**2 - R1**2), rel=1e-6)


def test_disc():
    """Each two orders more gain a digit at the least."""
    usable = S[S.imag > 1e-4]
    errors = [
        off(discs.impedance(discs.disc(2, p), 1.0, p, usable), discs.disc_formula(usable))
        for p in (4, 6, 8)
    ]
    assert errors[0] < 1e-3
    assert errors[2] < 1e-2 * errors[0]
    assert errors[2] < 1e-7


def test_Rs_of_a_disc_at_low_frequency():
    Z = discs.impedance(discs.disc(2, 8), 1.0, 8, S[:1])
    assert Z.real == pytest.approx(1 / (8 * np.pi), rel=1e-10)


@pytest.mark.parametrize("unrolled", [False, True])
def test_annulus(unrolled):
    usable, order = S[S.imag > 1e-4], 8
    way = discs.unrolled_annulus if unrolled else discs.annulus
    Z = discs.impedance(way(2, order, R1, R2), R1, order, usable)
    assert off(Z, discs.annulus_formula(usable, R1, R2)) < (1e-9 if unrolled else 2e-5)

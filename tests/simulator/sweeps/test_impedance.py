import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.sweeps import InputError
from rcskin.simulator.sweeps.reading_quantities import (
    branch_reactance,
    parallel_capacitance,
    series_capacitance,
)

positive = st.floats(1e-3, 1e9)


@given(R=positive, X=positive, frequency=st.floats(1e-3, 1e9))
def test_capacitances_of_an_impedance(R, X, frequency):
    Z, omega = R - 1j * X, 2 * np.pi * frequency
    assert parallel_capacitance(Z, frequency) == pytest.approx((1 / Z).imag / omega, rel=1e-14)
    assert series_capacitance(Z, frequency) == pytest.approx(1 / (omega * X), rel=1e-14)


def test_capacitance_neither_overflows_nor_vanishes():
    for size in (1e-160, 1e160):
        Cp = parallel_capacitance(size * (3 - 4j), 1 / (2 * np.pi))
        assert Cp == pytest.approx(0.16 / size, rel=1e-14)


def test_two_reactances_give_the_same_pair():
    """100 - 400j and 100 - 25j ohm: X1 X2 = Rs²."""
    assert parallel_capacitance(100 - 400j, 1e3) == pytest.approx(
        parallel_capacitance(100 - 25j, 1e3), rel=1e-15
    )


@given(phase=st.floats(-89.99, -45.1), magnitude=positive, frequency=positive)
def test_reactance_from_Rs_and_Cp_between_90_and_45_degrees(phase, magnitude, frequency):
    Z = magnitude * np.exp(1j * np.radians(phase))
    Cp = parallel_capacitance(Z, frequency)
    assert branch_reactance(Z.real, Cp, frequency) == pytest.approx(Z.imag, rel=1e-10)


def test_reactance_at_45_degrees_where_rounding_may_take_the_root_of_nothing():
    Cp = parallel_capacitance(1 - 1j, 1e3) * (1 + 1e-9)
    assert branch_reactance(1.0, Cp, 1e3) == pytest.approx(-1, rel=1e-4)


@pytest.mark.parametrize(("Rs", "Cp"), [(1.0, 1.0), (1.0, -1e-9), (1.0, 0.0)])
def test_no_reactance_has_this_pair(Rs, Cp):
    with pytest.raises(InputError, match="no capacitive reactance"):
        branch_reactance(Rs, Cp, 1e3)

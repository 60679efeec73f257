"""Excitations of a network of terminals, and what they combine to, against Kirchhoff's laws."""

import numpy as np
import pytest
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.fem.terminals import (
    Excitation,
    Network,
    allowed_potentials,
    combination,
    through_virtual_earth,
)

FIELD = (0, 0, 1, 1, 2)
"""Two foils on each sheet and a conductor beside them."""
S = 1j * np.array([1e-2, 1.0, 30.0])
HIGH, LOW = (0, 4), (2,)


@pytest.fixture
def network():
    """Conductances within each sheet, capacitances between all terminals and to earth."""
    random = np.random.default_rng(5)
    G = np.zeros((5, 5))
    for one, other, g in ((0, 1, 2.0), (2, 3, 0.7)):
        G[np.ix_([one, other], [one, other])] += g * np.array([[1, -1], [-1, 1]])
    half = random.normal(size=(5, 5))
    return Network(np.array(FIELD), G, S[:, None, None] * (half @ half.T + 0.1 * np.eye(5)))


def currents(network, fixed, raised=False):
    """Terminals' currents with high and low at those potentials and no current into the others;
    where they may be raised, into earth none either."""
    Y = network.conductance + network.dynamic
    floating = [k for k in range(5) if k not in (*HIGH, *LOW)]
    U = np.zeros((5, 2 if raised else 1))
    U[list(HIGH), 0], U[list(LOW), 0] = fixed
    U[[*HIGH, *LOW], 1:] = 1.0
    found = []
    for each in Y:
        own = U.astype(complex)
        own[floating] = -np.linalg.solve(each[np.ix_(floating, floating)], (each @ own)[floating])
        J = each @ own
        if raised:
            whole = J.sum(axis=0)
            J = J[:, 0] - J[:, 1] * whole[0] / whole[1]
        found.append(J.ravel())
    return np.array(found)


def test_current_into_a_virtual_earth(network):
    excitations = through_virtual_earth(HIGH, LOW)
    Y = combination(excitations).admittance(
        np.stack([network.form(excitation) for excitation in excitations])
    )
    into_low = -currents(network, (1.0, 0.0))[:, list(LOW)].sum(axis=1)
    np.testing.assert_allclose(Y[0], into_low, rtol=1e-12)


def test_a_floating_meter_feeds_no_current_to_earth(network):
    Z = network.impedance(Excitation(HIGH, LOW, raised=True))
    into_high = currents(network, (1.0, 0.0), raised=True)[:, list(HIGH)].sum(axis=1)
    np.testing.assert_allclose(Z, 1 / into_high, rtol=1e-12)


@pytest.mark.parametrize(
    ("excitation", "currentless"),
    [
        (Excitation(HIGH, LOW), 1),
        (Excitation(HIGH, LOW, raised=True), 2),
        *((excitation, 1) for excitation in through_virtual_earth(HIGH, LOW)),
        *(
            (excitation, excitation.potentials[0] == excitation.potentials[1])
            for excitation in through_virtual_earth((0,), (1,))
        ),
    ],
)
def test_potentials_that_cost_no_current_are_so_exactly(network, excitation, currentless):
    modes, common = allowed_potentials(FIELD, excitation)
    assert common.sum() >= currentless and common[0] == bool(currentless)
    assert not (network.conductance @ modes[:, common]).any()
    assert (modes[list(excitation.high), 0] == excitation.potentials[0]).all()
    assert (modes[list(excitation.low), 0] == excitation.potentials[1]).all()
    assert np.linalg.matrix_rank(modes[:, 1:]) == modes.shape[1] - 1


def test_errors_of_excitations_add(network):
    """Both have the same error: their difference hides it, the estimate does not."""
    excitations = through_virtual_earth(HIGH, LOW)
    Q = np.stack([network.form(excitation) for excitation in excitations])
    combined, off = combination(excitations), 1e-3 * np.exp(0.3j) * np.abs(Q[0])
    true = relative_difference(combined.impedance(Q + off), combined.impedance(Q))
    assert true.max() < 1e-12
    assert (combined.relative_change(Q + off, Q) > 1e-4).all()
    lone = combination(excitations[:1])
    expected = relative_difference(lone.impedance(Q[:1] + off), lone.impedance(Q[:1]))
    np.testing.assert_array_equal(lone.relative_change(Q[:1] + off, Q[:1]), expected)


@pytest.mark.parametrize("excitation", [Excitation((0,), ()), *through_virtual_earth(HIGH, LOW)])
def test_a_file_holds_the_same_excitation(excitation):
    assert Excitation.read({**excitation.stored(), "high": list(excitation.high)}) == excitation
    assert set(Excitation((0,), (1,)).stored()) == {"high", "low"}

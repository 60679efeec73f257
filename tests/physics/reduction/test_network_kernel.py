"""The fused admittances between terminals against matrices written out, on random small skins."""

import numpy as np
import pytest
from rcskin.simulator.fem.terminals import Combination, through_virtual_earth
from rcskin.simulator.models.network_skin import wiring_of
from rcskin.simulator.models.small_system.system import UnpressedMass, mass_of
from rcskin.simulator.models.small_system.woodbury import (
    SIDE_BY_SIDE,
    admittances,
    impedances,
    unpressed_network,
)
from rcskin.simulator.press.batch import PressBatch

TERMINALS, BASIS, CELLS, RANK = 3, 11, 6, 2
pytestmark = pytest.mark.kernel


@pytest.fixture
def rest():
    """M at rest is the sum of its cells' own, and diagonal but for terminals."""
    factors = np.random.default_rng(0).standard_normal((CELLS, RANK, TERMINALS + BASIS))
    rows = factors.reshape(-1, TERMINALS + BASIS)
    _, axes = np.linalg.eigh(rows[:, TERMINALS:].T @ rows[:, TERMINALS:])
    factors[..., TERMINALS:] = factors[..., TERMINALS:] @ axes
    rows = factors.reshape(-1, TERMINALS + BASIS)
    M = rows.T @ rows
    return UnpressedMass(M[:TERMINALS], M.diagonal()[TERMINALS:].copy(), factors)


def admittances_readable(rest, batch, s):
    """Y in S beyond that at zero frequency, of many presses, shape (press, s, N, N)."""
    N, found = len(rest.rows), []
    for cells, weights in batch.each():
        M = mass_of(rest, cells, weights)
        inner, beside = np.eye(len(M) - N), M[N:, :N]
        for each in s:
            delayed = np.linalg.solve(inner + each * M[N:, N:], beside)
            found.append(each * M[:N, :N] - each**2 * beside.T @ delayed)
    return np.reshape(found, (batch.count, len(s), N, N))


def some_s(count):
    return 2j * np.pi * np.geomspace(1e-3, 1e2, count) * np.exp(-0.02j)


@pytest.mark.parametrize("count", [1, 4, SIDE_BY_SIDE + 3])
def test_the_kernel_is_its_readable_twin(rest, count):
    """The same cells more and less pressed, in the other order, nothing in between, and so many
    touches that they are solved for in the basis."""
    both, turned, none = np.array([0, 5]), np.array([5, 0]), np.array([], dtype=np.int64)
    one, every = np.array([3]), np.arange(CELLS)
    cells = [one, one, both, both, both, turned, none, none, one, both, every, every]
    random, s = np.random.default_rng(1), some_s(count)
    batch = PressBatch.of((each, random.uniform(-0.5, 2.0, len(each))) for each in cells)
    found = admittances(rest, unpressed_network(rest, s), batch, s)
    np.testing.assert_allclose(found, admittances_readable(rest, batch, s), rtol=1e-10)


def test_a_touch_of_no_weight_is_none(rest):
    s, cells = some_s(3), np.array([1, 4])
    batch = PressBatch.of([(cells, np.zeros(2)), (cells[:0], np.zeros(0))])
    unpressed, untouched = admittances(rest, unpressed_network(rest, s), batch, s)
    np.testing.assert_allclose(unpressed, untouched, rtol=1e-12)


def test_admittance_is_reciprocal_and_passive(rest):
    s, cells = some_s(5), np.array([0, 2])
    batch = PressBatch.of([(cells, np.array([-0.4, 1.5]))])
    Y = admittances(rest, unpressed_network(rest, s), batch, s)[0]
    np.testing.assert_array_equal(Y, Y.swapaxes(1, 2))
    assert (np.linalg.eigvalsh(Y.real) > 0).all()


def test_an_excitation_without_any_current_adds_nothing_to_its_reading():
    """One terminal a sheet, Y = s C (u_t - u_b)²: both at 1/2 V draw nothing, and Z is 1 / sC."""
    s, C = some_s(3), 5e-12
    Y = s[None, :, None, None] * C * np.array([[1.0, -1.0], [-1.0, 1.0]])
    excitations = through_virtual_earth((0,), (1,))
    wiring = wiring_of(excitations, np.array([0, 1]), np.zeros((2, 2)))
    Z = impedances(Y, wiring)
    assert np.isinf(Z[0, 1]).all()
    combined = Combination(wiring.weights).impedance(1 / np.moveaxis(Z, 1, 0))
    np.testing.assert_allclose(combined[0], [1 / (s * C)])

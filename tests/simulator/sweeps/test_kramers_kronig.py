"""The nearest passive network: it is the network itself where there is one, and tells where not."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.simulator.sweeps.passivity import RESOLUTION, fit_passive

FREQUENCY = np.geomspace(1e3, 2e5, 20)
S = 2j * np.pi * FREQUENCY
LINE = 1e5 / (np.sqrt(S * 1e-5) * np.tanh(np.sqrt(S * 1e-5)))

ohms = st.floats(2, 6).map(lambda exponent: 10**exponent)
poles = st.lists(st.tuples(ohms, st.floats(3, 5.3)), max_size=3)


@st.composite
def passive_spectra(draw):
    """R + 1/(s C) + s L + up to three RC elements, any of which may be absent."""
    Z = draw(ohms) + draw(st.sampled_from([0, 1e9])) / S + draw(st.sampled_from([0, 1e-3])) * S
    for resistance, exponent in draw(poles):
        Z = Z + resistance / (1 + S / (2 * np.pi * 10**exponent))
    return Z


@given(passive_spectra())
def test_a_passive_network_leaves_nothing_over(Z):
    network = fit_passive(Z, FREQUENCY)
    assert np.abs(network.residual(Z, FREQUENCY)).max() < RESOLUTION
    np.testing.assert_allclose(network.impedance(FREQUENCY), Z, rtol=RESOLUTION)


def test_an_open_line_is_a_sum_of_such_elements():
    network = fit_passive(LINE, FREQUENCY)
    assert np.abs(network.residual(LINE, FREQUENCY)).max() < RESOLUTION
    assert 3 < network.parameters < 2 * FREQUENCY.size


def test_the_terms_are_found_again():
    network = fit_passive(300 + 1 / (S * 2e-9) + S * 1e-3, FREQUENCY)
    assert network.resistance == pytest.approx(300, rel=1e-3)
    assert network.elastance == pytest.approx(1 / 2e-9, rel=1e-3)
    assert network.inductance == pytest.approx(1e-3, rel=1e-3)


@pytest.mark.parametrize(
    "Z",
    [
        -LINE,
        LINE.conj(),
        LINE * np.exp(-1j * np.radians(5)),
        LINE.real * 1.05 + 1j * LINE.imag,
        1e4 + 1 / (S * 1e-9) - 5e3 / (1 + S * 1e-5),
        LINE * np.where(FREQUENCY > 2e4, 1.02, 1),
    ],
    ids=["source", "mirrored", "phase", "share", "negative residue", "range step"],
)
def test_what_no_passive_network_does_is_left_over(Z):
    residual = fit_passive(Z, FREQUENCY).residual(Z, FREQUENCY)
    assert np.abs(residual).max() > 2e-3


@given(place=st.integers(2, 17), size=st.sampled_from([0.9, 1.1, 0.9j + 1, 1 - 0.2j]))
def test_one_bad_reading_is_left_over_at_its_place(place, size):
    Z = LINE.copy()
    Z[place] *= size
    residual = np.abs(fit_passive(Z, FREQUENCY).residual(Z, FREQUENCY))
    assert np.argmax(residual) == place

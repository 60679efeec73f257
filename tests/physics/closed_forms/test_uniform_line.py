"""The uniform open RC line of total R and C: Z = R coth(q)/q with q² = s R C."""

import numpy as np
import pytest
from rcskin.simulator.fem.circuit import one_field
from rcskin.simulator.mesh.quadrilaterals import Resolution
from rcskin.simulator.models.line import Line
from rcskin.simulator.models.sheet_model import SheetModel
from rcskin.simulator.press.press import Press
from rcskin.simulator.sweeps import parallel_capacitance
from rcskin.tests.library.models import impedance
from scipy.optimize import brentq
from scipy.special import bernoulli, factorial

R = (50e3 + 30e3) * 0.10 / 0.08
C = 5e-9 * 0.10 * 0.08
"""Ohm and F of the scene that `make_scene` builds by default."""


def coth_over_q(z):
    """coth(q)/q for q² = z: sum of B_2k 2^2k z^(k-1) / (2k)! where |z| < 1, else as it stands."""
    k = np.arange(26)
    coefficients = bernoulli(50)[::2] * 4.0**k / factorial(2 * k)
    small = np.abs(z) < 1
    series = np.polyval(coefficients[::-1], np.where(small, z, 0)) / z
    q = np.sqrt(z)
    return np.where(small, series, 1 / (q * np.tanh(q)))


@pytest.fixture(scope="module")
def line(make_scene):
    scene = make_scene()
    return Line(scene.parts.skin, scene.parts.setup)


def at(model, frequency_at, u):
    return impedance(model, Press(), frequency_at(model, u))[0]


def relative_Cp(model, frequency_at, u):
    return parallel_capacitance(at(model, frequency_at, u), frequency_at(model, u)) / C


def test_line_is_the_coth_law_in_both_parts(line, frequency_at):
    u = np.geomspace(1e-9, 1e9, 181)
    expected = R * coth_over_q(1j * u)
    np.testing.assert_allclose(
        at(line, frequency_at, u).view(float), expected.view(float), rtol=1e-13
    )


def test_sheet_is_the_coth_law_in_both_parts(make_scene, frequency_at):
    scene = make_scene()
    sheet = SheetModel(
        scene.parts.skin,
        one_field(scene.parts.skin, scene.parts.setup),
        Resolution(order=8, cells=4),
    )
    u = np.geomspace(1e-9, 1e2, 12)
    expected = R * coth_over_q(1j * u)
    np.testing.assert_allclose(
        at(sheet, frequency_at, u).view(float), expected.view(float), rtol=1e-12
    )


def test_foster_sum(line, frequency_at):
    u, terms = np.geomspace(1e-2, 1e2, 17), 10_000
    m = np.arange(1, terms + 1)[:, None]
    poles = (2 / (1j * u + (m * np.pi) ** 2)).sum(axis=0)
    remainder = 2 / np.pi**2 / (terms + 0.5)
    expected = R * (1 / (1j * u) + poles + remainder)
    np.testing.assert_allclose(at(line, frequency_at, u), expected, rtol=1e-11)


def test_low_frequency_expansion(line, frequency_at):
    u = np.array([1e-9, 1e-6, 1e-3])
    np.testing.assert_allclose(
        at(line, frequency_at, u).real, R / 3 * (1 - 2 * u**2 / 315), rtol=1e-13
    )
    np.testing.assert_allclose(relative_Cp(line, frequency_at, u), 1 - 2 * u**2 / 15, rtol=1e-12)


def test_high_frequency_limit(line, frequency_at):
    u = np.geomspace(1e4, 1e9, 6)
    Z = at(line, frequency_at, u)
    np.testing.assert_allclose(Z.real, R / np.sqrt(2 * u), rtol=1e-13)
    np.testing.assert_allclose(relative_Cp(line, frequency_at, u), 1 / np.sqrt(2 * u), rtol=1e-13)
    np.testing.assert_allclose(np.angle(Z, deg=True), -45.0, rtol=1e-13)


@pytest.mark.parametrize(("fraction", "u"), [(0.9, 0.925), (0.5, 3.116)])
def test_where_Cp_has_fallen(line, frequency_at, fraction, u):
    root = brentq(lambda u: relative_Cp(line, frequency_at, u)[0] - fraction, 1e-3, 1e3)
    assert round(root, 3) == u


@pytest.mark.parametrize(("fraction", "u", "digits"), [(0.9, 4.33, 2), (0.5, 18.2, 1)])
def test_where_Rs_has_fallen(line, frequency_at, fraction, u, digits):
    root = brentq(lambda u: at(line, frequency_at, u)[0].real - fraction * R / 3, 1e-3, 1e3)
    assert round(root, digits) == u

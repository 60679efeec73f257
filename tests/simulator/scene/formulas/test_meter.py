"""Formulas of loss, leads and what the meter shows."""

import numpy as np
from rcskin.simulator.scene.frequency import Loss, laplace_variable
from rcskin.simulator.scene.meter import Leads
from rcskin.simulator.sweeps import build

FREQUENCY = np.geomspace(40, 2e5, 30)
OMEGA = 2 * np.pi * FREQUENCY


def test_s(rng):
    """
    s = j omega (1 - j t) (j f / 1000)^(a - 1)
    """
    t, a = rng.uniform(0, 0.3), rng.uniform(0.6, 1)
    s = 1j * OMEGA * (1 - 1j * t) * (1j * FREQUENCY / 1000) ** (a - 1)
    np.testing.assert_allclose(laplace_variable(FREQUENCY, Loss(t, a)), s)


def test_phase_and_magnitude_of_the_foam(rng):
    """
    Y = s c
    phase(Y) = a pi / 2 - arctan(t)
    abs(Y) = omega c sqrt(1 + t^2)
    """
    t, a, c = rng.uniform(0, 0.3), rng.uniform(0.6, 1), 5e-9
    Y = laplace_variable(FREQUENCY, Loss(t, a)) * c
    np.testing.assert_allclose(np.angle(Y), a * np.pi / 2 - np.arctan(t))
    at_1_kHz = abs(laplace_variable(1e3, Loss(t, a)) * c)
    np.testing.assert_allclose(at_1_kHz, 2 * np.pi * 1e3 * c * np.sqrt(1 + t**2))


def test_leads_and_guard(rng):
    """
    Z_m = R_l + j omega L_l + 1 / (1 / Z + j omega (1 - g) C_l)
    """
    R_l, L_l, C_l, g = rng.uniform(0, [100, 1e-5, 1e-10, 1])
    Z = rng.uniform(1, 1e5, 30) - 1j * rng.uniform(1, 1e5, 30)
    leads = Leads(resistance=R_l, inductance=L_l, stray_capacitance=C_l, guard=g)
    Z_m = R_l + 1j * OMEGA * L_l + 1 / (1 / Z + 1j * OMEGA * (1 - g) * C_l)
    np.testing.assert_allclose(leads.at_meter(Z, FREQUENCY), Z_m)


def test_what_the_meter_shows(rng):
    """
    Rs = Re(Z_m)
    X = Im(Z_m)
    Cp = Im(1 / Z_m) / omega
    """
    Z = rng.uniform(1, 1e5, (1, 1, 30)) - 1j * rng.uniform(1, 1e5, (1, 1, 30))
    sweeps = build(Z, FREQUENCY, interface=["left"], press=["none"], row=[0], column=[0]).dataset()
    np.testing.assert_allclose(sweeps["Rs"], Z.real)
    np.testing.assert_allclose(sweeps["X"], Z.imag)
    np.testing.assert_allclose(sweeps["Cp"], (1 / Z).imag / OMEGA)

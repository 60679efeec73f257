"""Every formula of the page of formulas is quoted, word for word, by a test of this folder.

Formulas of loss, leads and what the meter shows.
"""

import ast
import re
from pathlib import Path

import numpy as np
from rcskin.simulator.scene.frequency import Loss, laplace_variable
from rcskin.simulator.scene.meter import Leads
from rcskin.simulator.sweeps import build

HERE = Path(__file__).parent
PAGE = HERE.parents[3] / "docs" / "reference" / "formulas.md"


def formulas():
    """The lines of the page's blocks, without what is said of them after three spaces."""
    blocks = re.findall(r"^```\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.DOTALL | re.M)
    return [re.split(r" {3,}", line)[0] for block in blocks for line in block.splitlines()]


def quoted():
    """The lines of all docstrings of tests."""
    lines = []
    for path in HERE.glob("test_*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef) and node.name.startswith("test_"):
                lines += (ast.get_docstring(node) or "").splitlines()
    return {line.strip() for line in lines}


def test_every_formula_of_the_page_is_tested():
    assert len(formulas()) > 50
    known = quoted()
    assert [line for line in formulas() if line not in known] == []


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

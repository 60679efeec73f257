"""A skin draped over a sphere and the same cap in closed form."""

import numpy as np
import pytest
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.scene import Scene

RADIUS, TOP, BOTTOM, C = 0.05, 50e3, 30e3, 5e-9
FREQUENCIES = (1e2, 3e3, 1e5)


def legendre(angle, eigenvalue):
    """P_v(cos angle) and its slope by the angle, for v (v + 1) = -eigenvalue: 2F1 term by term.

    2F1(-v, v + 1; 1; z), z = sin²(angle / 2): each term is (n (n + 1) + eigenvalue) z / (n + 1)²
    times the one before. Source: NIST Digital Library of Mathematical Functions, 14.3.1, 15.2.1.
    """
    z, term = np.sin(angle / 2) ** 2, np.ones_like(eigenvalue)
    value, slope = term, np.zeros_like(eigenvalue)
    for n in range(400):
        term = term * (n * (n + 1) + eigenvalue) / (n + 1) ** 2 * z
        value, slope = value + term, slope + (n + 1) * term / z
    return value, slope * np.sin(angle) / 2


def cap(distance):
    """A disc of that radius draped over the sphere from its middle, fed all around its rim."""
    return Scene.model_validate(
        {
            "name": "cap",
            "skin": {
                "length": 2 * distance,
                "width": 2 * distance,
                "outline": {"circle": [distance, distance, distance]},
                "shape": {"kind": "sphere", "radius": RADIUS},
                "stretch": {"sheet_poisson_ratio": 0.0, "foam_poisson_ratio": 0.0},
                "top": {"sheet_resistance": TOP},
                "bottom": {"sheet_resistance": BOTTOM},
                "foam": {"capacitance_per_area": C},
            },
            "contact": [
                {"name": name, "electrode": name, "edge": "outline"} for name in ("top", "bottom")
            ],
            "interface": [{"name": "meter", "high": ["top"], "low": ["bottom"]}],
            "pixels": {"rows": 1, "columns": 1},
            "sweep": {"frequencies": FREQUENCIES},
        }
    )


@pytest.mark.parametrize("angle", [0.3, 1.2])
def test_a_cap_fed_at_its_rim_is_its_legendre_function(angle):
    """Sheets and foam that do not thin: V = P_v(cos), v (v + 1) = -s R c r², fed at the angle.

    The current into the rim is 2 pi sin(angle) V' / R.
    """
    scene = cap(angle * RADIUS)
    s, R = 2j * np.pi * scene.frequencies, TOP + BOTTOM
    value, slope = legendre(angle, s * R * C * RADIUS**2)
    expected = R * value / (2 * np.pi * np.sin(angle) * slope)
    answer = Solver(scene, 1e-3).solve(Press())
    np.testing.assert_allclose(answer.Z[0], expected, rtol=2e-3)
    assert np.all(np.abs(answer.Z[0].real - expected.real) <= answer.Rs_error[0])


def test_all_of_a_cap_is_charged_at_low_frequency():
    """C = c 2 pi r² (1 - cos angle), which the closed form gives too."""
    value, slope = legendre(1.2, np.array([1e-9]))
    total = 2 * np.pi * np.sin(1.2) * slope / value / 1e-9
    np.testing.assert_allclose(total, 2 * np.pi * (1 - np.cos(1.2)), rtol=1e-8)

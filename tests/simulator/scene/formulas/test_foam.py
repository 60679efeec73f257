"""Formulas of the foam: capacitance, porosity, effective media, stress."""

import numpy as np
import pytest
from rcskin.simulator.models.mechanics.indentation import deformation
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.foam import Foam
from rcskin.simulator.scene.foam_mechanics import LAWS, Mechanics
from rcskin.simulator.sweeps import InputError

EPS0 = 8.8541878128e-12


def looyenga(phi, eps_s):
    return ((1 - phi) * eps_s ** (1 / 3) + phi) ** 3


def bruggeman(phi, eps_s):
    b = (2 - 3 * phi) * eps_s + 3 * phi - 1
    return (b + np.sqrt(b**2 + 8 * eps_s)) / 4


def lichtenecker(phi, eps_s):
    return eps_s ** (1 - phi)


def maxwell_garnett(phi, eps_s):
    above = 2 * eps_s + 1 + 2 * phi * (1 - eps_s)
    return eps_s * above / (2 * eps_s + 1 - phi * (1 - eps_s))


OWN = {
    "looyenga": looyenga,
    "bruggeman": bruggeman,
    "lichtenecker": lichtenecker,
    "maxwell-garnett": maxwell_garnett,
}


@pytest.mark.parametrize("law", LAWS)
def test_effective_media(law, rng):
    """
    eps = ((1 - phi) eps_s^(1/3) + phi)^3
    eps = (b + sqrt(b^2 + 8 eps_s)) / 4,  b = (2 - 3 phi) eps_s + 3 phi - 1
    eps = eps_s^(1 - phi)
    eps = eps_s (2 eps_s + 1 + 2 phi (1 - eps_s)) / (2 eps_s + 1 - phi (1 - eps_s))
    """
    phi, eps_s = rng.uniform(0, 1, 50), rng.uniform(1, 20)
    np.testing.assert_allclose(LAWS[law](phi, eps_s), OWN[law](phi, eps_s), rtol=1e-12)


@pytest.mark.parametrize("law", LAWS)
def test_factor_of_closing_pores(law, rng):
    """
    phi = (phi0 - e) / (1 - e)
    k = eps(e) / eps(0) / (1 - e)
    """
    phi0, eps_s = rng.uniform(0.2, 0.95), rng.uniform(1.5, 10)
    e = rng.uniform(0, phi0, 50)
    foam = Mechanics(
        porosity=phi0, solid_permittivity=eps_s, effective_medium=law, modulus=rng.uniform(1, 1e6)
    )
    k = OWN[law]((phi0 - e) / (1 - e), eps_s) / OWN[law](phi0, eps_s) / (1 - e)
    np.testing.assert_allclose(foam.factor(e), k, rtol=1e-12)


def test_constant_permittivity(rng):
    """
    eps = 1
    """
    e = rng.uniform(0, 0.6, 50)
    foam = Mechanics(porosity=0.67, effective_medium="constant", modulus=30e3)
    np.testing.assert_allclose(foam.factor(e), 1 / (1 - e), rtol=1e-15)


@pytest.mark.parametrize("law", LAWS)
def test_unpressed_capacitance(law, rng):
    """
    c0 = 8.8541878128e-12 eps_r / d
    eps_r = eps(0)
    """
    d, phi0, eps_s, given = rng.uniform(1e-3, 1e-2), *rng.uniform(0.2, 0.9, 1), 2.79, 2.2
    made_of = {"porosity": phi0, "solid_permittivity": eps_s, "effective_medium": law}
    foam = Foam(thickness=d, mechanics=Mechanics(**made_of, modulus=30e3))
    assert foam.unpressed_capacitance_per_area == pytest.approx(EPS0 * OWN[law](phi0, eps_s) / d)
    measured = foam.model_copy(update={"relative_permittivity": given})
    assert measured.unpressed_capacitance_per_area == pytest.approx(EPS0 * given / d)


def test_stress_of_an_elastomer(rng):
    """
    p = P (1 - exp(-E e / P)) + P / 2.3 r^2 / (1 - r),  r = e / e_d
    """
    E, P, e_d = rng.uniform(1e4, 1e6), rng.uniform(1e3, 1e4), rng.uniform(0.3, 0.67)
    foam = Mechanics(
        porosity=0.67,
        solid_permittivity=2.79,
        modulus=E,
        plateau_stress=P,
        densification_strain=e_d,
    )
    e = rng.uniform(0, 0.999 * e_d, 50)
    r = e / e_d
    p = P * (1 - np.exp(-E * e / P)) + P / 2.3 * r**2 / (1 - r)
    np.testing.assert_allclose(foam.elastic.stress(e), p, rtol=1e-10)


def test_stress_of_linear_foam(rng):
    """
    p = E e
    """
    E, e = rng.uniform(1e4, 1e6), rng.uniform(0, 0.67, 50)
    foam = Mechanics(porosity=0.67, solid_permittivity=2.79, modulus=E, stress_strain="linear")
    np.testing.assert_allclose(foam.elastic.stress(e), E * e, rtol=1e-15)


def test_modulus_plateau_and_densification_unless_given(rng):
    """
    E = E_s (1 - phi0)^2
    P = 0.05 E
    e_d = phi0
    """
    phi0, E_s = rng.uniform(0.2, 0.95), rng.uniform(1e5, 1e8)
    foam = Mechanics(porosity=phi0, solid_permittivity=2.79, solid_modulus=E_s)
    E = E_s * (1 - phi0) ** 2
    law = foam.elastic
    assert (foam.young, law.modulus) == pytest.approx((E, E))
    assert (law.plateau_stress, law.densification_strain) == pytest.approx((0.05 * E, phi0))


@pytest.mark.parametrize(("law", "most"), [("elastomer", 0.999), ("linear", 1.0)])
@pytest.mark.parametrize("tension", [0.0, 20.0])
def test_range_of_depth(on_foam, law, most, tension):
    """
    w <= 0.999 e_d d
    w <= e_d d
    """
    scene = on_foam(stress_strain=law, densification_strain=0.5, tension=tension)
    deepest = most * 0.5 * 4e-3
    within = deformation(scene.parts.skin, parse_press(f"1,1:{(1 - 1e-9) * deepest!r}m", 2.0), 1e-2)
    assert within.depth == pytest.approx([deepest])
    with pytest.raises(InputError, match="depth must be <= "):
        deformation(scene.parts.skin, parse_press(f"1,1:{(1 + 1e-9) * deepest!r}m", 2.0), 1e-2)
    with pytest.raises(InputError, match="force must leave the depth <= "):
        deformation(scene.parts.skin, parse_press("1,1:1e6N", 2.0), 1e-2)

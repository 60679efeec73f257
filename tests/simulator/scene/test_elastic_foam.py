import numpy as np
import pytest
from rcskin.simulator.scene.foam_mechanics import Elastomer, Hookean, Mechanics

FOAM = Elastomer(modulus=30e3, plateau_stress=1.5e3, densification_strain=0.67)
LAWS = (FOAM, Hookean(30e3, 0.67))


@pytest.mark.parametrize("law", LAWS)
def test_small_strains_meet_youngs_modulus(law):
    assert law.stress(np.array(1e-7)) / 1e-7 == pytest.approx(30e3, rel=1e-5)
    assert law.stiffness(np.array(0.0)) == 30e3
    assert law.stress(np.array(0.0)) == law.energy(np.array(0.0)) == 0


@pytest.mark.parametrize("law", LAWS)
def test_stress_rises_everywhere_and_beyond(law):
    assert (np.diff(law.stress(np.linspace(-0.1, 1, 1000))) > 0).all()


@pytest.mark.parametrize("law", LAWS)
def test_energy_stress_and_stiffness_are_derivatives_of_each_other(law):
    at, h = np.linspace(-0.05, 0.9, 60), 1e-6
    for whole, part in ((law.energy, law.stress), (law.stress, law.stiffness)):
        slope = (whole(at + h) - whole(at - h)) / (2 * h)
        np.testing.assert_allclose(slope, part(at), rtol=1e-4, atol=1e-3)


def test_three_regimes():
    """Stiff, then a plateau near the stress at which cells buckle, then stiff again."""
    rest, plateau, closing = FOAM.stiffness(np.array([0.0, 0.2, 0.65]))
    assert plateau < 0.2 * rest < 0.2 * closing
    within = FOAM.stress(np.array([0.15, 0.3]))
    assert (np.abs(within / FOAM.plateau_stress - 1) < 0.2).all()


def test_stress_diverges_as_the_cells_close():
    """Like P/D/(1 - r), the law of Maiti, Gibson and Ashby."""
    r = np.array([0.99, 0.995])
    limit = FOAM.plateau_stress / 2.3 / (1 - r)
    np.testing.assert_allclose(FOAM.stress(0.67 * r), limit, rtol=0.01)


def test_open_cells_after_gibson_and_ashby():
    made = Mechanics(porosity=0.9, solid_permittivity=3.0, solid_modulus=5e6)
    assert made.young == pytest.approx(5e6 * 0.1**2)
    assert made.elastic == Elastomer(made.young, 0.05 * made.young, 0.9)

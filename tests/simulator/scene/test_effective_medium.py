import numpy as np
import pytest
from pydantic import ValidationError
from rcskin.simulator.scene.foam import VACUUM_PERMITTIVITY, Foam
from rcskin.simulator.scene.foam_mechanics import (
    LAWS,
    Mechanics,
    bruggeman,
    looyenga,
    maxwell_garnett,
)
from rcskin.simulator.scene.scene_files import load_scene, parse_scene, scene_text
from rcskin.simulator.sweeps import InputError

POROSITY = np.linspace(0, 1, 41)
SOLIDS = (1.0, 2.79, 12.0)
MADE_OF = {"porosity": 0.67, "solid_permittivity": 2.79, "modulus": 30e3}


def foam(**changed):
    """Mechanics of the paper's foam, with changes."""
    return Mechanics(**{**MADE_OF, **changed})


@pytest.mark.parametrize("solid", SOLIDS)
@pytest.mark.parametrize("law", LAWS.values())
def test_without_pores_the_solid_and_without_solid_air(law, solid):
    assert law(np.array(0.0), solid) == pytest.approx(solid, rel=1e-12)
    assert law(np.array(1.0), solid) == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("solid", SOLIDS[1:])
@pytest.mark.parametrize("law", LAWS.values())
def test_permittivity_falls_with_porosity_within_the_bounds_of_wiener(law, solid):
    found = law(POROSITY, solid)
    assert (np.diff(found) < 0).all()
    series, parallel = 1 / ((1 - POROSITY) / solid + POROSITY), (1 - POROSITY) * solid + POROSITY
    assert ((found >= series - 1e-12) & (found <= parallel + 1e-12)).all()


@pytest.mark.parametrize("solid", SOLIDS)
@pytest.mark.parametrize("name", ["looyenga", "bruggeman", "maxwell-garnett"])
def test_isotropic_mixtures_keep_the_bounds_of_hashin_and_shtrikman(name, solid):
    found, upper = LAWS[name](POROSITY, solid), maxwell_garnett(POROSITY, solid)
    lower = 1 + 3 * (1 - POROSITY) * (solid - 1) / (3 + POROSITY * (solid - 1))
    assert ((found >= lower - 1e-12) & (found <= upper + 1e-12)).all()


def test_bruggeman_is_the_root_of_his_equation():
    e = bruggeman(POROSITY, 12.0)
    left = (1 - POROSITY) * (12 - e) / (12 + 2 * e) + POROSITY * (1 - e) / (1 + 2 * e)
    np.testing.assert_allclose(left, 0, atol=1e-14)


def test_looyenga_makes_foam_of_the_papers_porosity_1_46():
    assert looyenga(np.array(0.67), 2.79) == pytest.approx(1.46, abs=0.005)
    at_rest = Foam(thickness=4e-3, mechanics=foam()).unpressed_capacitance_per_area
    assert at_rest == pytest.approx(1.46 * VACUUM_PERMITTIVITY / 4e-3, rel=3e-3)


@pytest.mark.parametrize(
    ("law", "most"),
    [("looyenga", 2.8), ("lichtenecker", 2.81), ("bruggeman", 2.84), ("maxwell-garnett", 2.78)],
)
def test_2_mm_into_4_mm_makes_more_than_plates_do(law, most):
    """That is 2; closing pores raise it, by Looyenga's law to the 2.8 of the paper's foam."""
    assert most - 0.02 < foam(effective_medium=law).factor(np.array(0.5)) < most


def test_constant_permittivity_makes_the_factor_of_plates():
    plates = foam(effective_medium="constant", solid_permittivity=None)
    strain = np.linspace(0, 0.6, 7)
    np.testing.assert_allclose(plates.factor(strain), 1 / (1 - strain), rtol=1e-15)


@pytest.mark.parametrize("law", LAWS)
def test_the_factor_rises_from_1_faster_than_that_of_plates(law):
    strain = np.linspace(0, 0.66, 100)
    factor = foam(effective_medium=law).factor(strain)
    assert factor[0] == 1
    assert (np.diff(factor * (1 - strain)) > 0).all()
    gain = np.diff(np.log(factor)) / np.diff(strain)
    middle = (strain[1:] + strain[:-1]) / 2
    np.testing.assert_allclose(foam(effective_medium=law).gain(middle), gain, rtol=1e-3)


@pytest.mark.parametrize("law", LAWS)
def test_the_strain_of_a_factor_brings_it_about(law):
    m, strain = foam(effective_medium=law), np.linspace(0, 0.66, 12)
    np.testing.assert_allclose(m.strain_at(m.factor(strain)), strain, atol=1e-14)
    np.testing.assert_array_equal(m.strain_at(np.array([0.5, 1.0, 1e9])), [0, 0, 0.67])


def test_closed_pores_leave_the_solid():
    m = foam()
    closed = m.factor(np.array(0.67)) * (1 - 0.67) * looyenga(np.array(0.67), 2.79)
    assert closed == pytest.approx(2.79, rel=1e-12)


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"modulus": None}, "needs either modulus or solid_modulus"),
        ({"solid_modulus": 1e6}, "needs either modulus or solid_modulus"),
        ({"solid_permittivity": None}, "needs solid_permittivity"),
        ({"effective_medium": "constant"}, "takes no solid_permittivity"),
        ({"densification_strain": 0.7}, "densification_strain must be <= porosity 0.67, got 0.7"),
        ({"stress_strain": "linear", "plateau_stress": 1e3}, "plateau_stress does not apply"),
    ],
)
def test_bad_properties_are_refused(changed, told):
    with pytest.raises(ValidationError, match=told):
        foam(**changed)


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({}, "needs thickness where mechanics is given"),
        (
            {"thickness": 4e-3, "relative_permittivity": 2.0, "capacitance_per_area": 1e-9},
            "capacitance_per_area or relative_permittivity, not both",
        ),
    ],
)
def test_a_foam_with_mechanics_has_a_thickness_and_one_capacitance(given, told):
    with pytest.raises(ValidationError, match=told):
        Foam(**given, mechanics=foam())


def test_constant_permittivity_must_be_given():
    constant = foam(effective_medium="constant", solid_permittivity=None)
    with pytest.raises(ValidationError, match="needs capacitance_per_area or relative_permitt"):
        Foam(thickness=4e-3, mechanics=constant)
    given = Foam(thickness=4e-3, relative_permittivity=2.0, mechanics=constant)
    assert given.unpressed_capacitance_per_area == 2 * VACUUM_PERMITTIVITY / 4e-3


NOT_GIVEN = dict.fromkeys(
    f"skin.foam.mechanics.{key}"
    for key in ("porosity", "solid_permittivity", "densification_strain")
)


@pytest.mark.parametrize("law", ["looyenga", "bruggeman", "lichtenecker", "maxwell-garnett"])
def test_permittivity_and_modulus_of_a_foam_are_enough(law):
    known = {"skin.foam.relative_permittivity": 1.5, "skin.foam.mechanics.effective_medium": law}
    scene = load_scene("foam").with_({**NOT_GIVEN, **known})
    mechanics = scene.skin.foam.mechanics
    assert LAWS[law](mechanics.air, 3.0) == pytest.approx(1.5, rel=1e-12)
    given = {"porosity": mechanics.air, "solid_permittivity": 3.0}
    same = scene.with_({f"skin.foam.mechanics.{key}": value for key, value in given.items()})
    strain = np.linspace(0, 0.6, 7)
    np.testing.assert_array_equal(same.skin.foam.mechanics.factor(strain), mechanics.factor(strain))
    assert f"(from the permittivity, by {law}; solid 3 assumed)" in str(scene)
    assert parse_scene(scene_text(scene), "again") == scene


def test_a_derived_porosity_follows_the_permittivity_and_the_solid():
    scene = load_scene("foam").with_({**NOT_GIVEN, "skin.foam.relative_permittivity": 1.5})
    denser = scene.with_({"skin.foam.relative_permittivity": 1.8})
    c = 8.8541878128e-12 * 1.8 / scene.skin.foam.thickness
    by_capacitance = {"skin.foam.relative_permittivity": None, "skin.foam.capacitance_per_area": c}
    solid = scene.with_({"skin.foam.mechanics.solid_permittivity": 5.0})
    air, dense, same, light = (
        each.skin.foam.mechanics.air for each in (scene, denser, scene.with_(by_capacitance), solid)
    )
    assert dense < air < light and same == pytest.approx(dense, rel=1e-9)


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({}, "mechanics needs porosity, unless relative_permittivity or capacitance_per_area"),
        ({"skin.foam.relative_permittivity": 4.0}, "that of the solid, 3, gives foams of 1.001 to"),
        (
            {
                "skin.foam.relative_permittivity": 1.5,
                "skin.foam.mechanics.effective_medium": "constant",
            },
            "needs porosity or densification_strain",
        ),
        (
            {
                "skin.foam.relative_permittivity": 1.5,
                "skin.foam.mechanics.densification_strain": 0.9,
            },
            "densification_strain must be <= porosity 0.672",
        ),
    ],
)
def test_a_porosity_that_does_not_follow_is_asked_for(changes, told):
    with pytest.raises(InputError, match=told):
        load_scene("foam").with_({**NOT_GIVEN, **changes})

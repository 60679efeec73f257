"""What contacts and scenes refuse, in one line that says what to do."""

import numpy as np
import pytest
from rcskin import DepthImage, InputError, PointContacts, PressureImage, load
from rcskin.simulator.sensor.contacts.rasterizer import ContactRasterizer, to_cells

INVALID = [
    (lambda: PointContacts(0.05, 0.05, 1.0), "needs radius, curvature_radius or size"),
    (lambda: PointContacts(0.05, 0.05, radius=0.01), "takes one of force, depth, factor, got none"),
    (
        lambda: PointContacts(0.05, 0.05, 1.0, 0.01, factor=2.0),
        "takes one of force, depth, factor, got force and factor",
    ),
    (lambda: PointContacts(0.05, 0.05, 1.0, 0.01, size=(0.1, 0.1)), "not both"),
    (lambda: PointContacts([0.05, 0.06], [0.05, 0.06, 0.07], 1.0, 0.01), "arrays do not match"),
    (lambda: PointContacts([0.05], 0.05, 1.0, size=0.01), "size must have the shape (..., 2)"),
    (lambda: PointContacts([[0.05]], 0.05, 1.0, 0.01, count=[2]), "count must be in 0..1"),
    (lambda: PointContacts("left", 0.05, 1.0, 0.01), "arrays do not match"),
    (lambda: DepthImage([1e-3]), "must have the shape (row, column) or"),
    (
        lambda: PointContacts(np.zeros(10**5), 0.05, 1.0, 0.01),
        "a skin has at most 10000 contacts, got 100000",
    ),
    (
        lambda: PointContacts(np.broadcast_to(0.0, (10**9, 1)), np.zeros((1, 10**4)), 1.0, 0.01),
        "contacts would need",
    ),
    (
        lambda: DepthImage(np.broadcast_to(0.0, (10**6, 10**7))),
        "10000000000000 values of depth would need 80 TB of memory",
    ),
]
ON_THE_SKIN = [
    (PointContacts([0.05, 0.13], 0.05, 1.0, 0.01), "contact 1: (x, y) must lie within 0..0.12 and"),
    (PointContacts(0.05, 0.05, -1.0, 0.01), "contact 0: force must be >= 0 N, got -1"),
    (PointContacts(0.05, 0.05, np.nan, 0.01), "contact 0: force must be >= 0 N, got nan"),
    (PointContacts(0.05, 0.05, 1.0, 0.0), "radius and curvature_radius must be > 0 m and one"),
    (PointContacts(0.05, 0.05, 1.0, size=(0.0, 1.0)), "contact 0: size must be > 0 m, got (0, 1)"),
    *(
        (PointContacts(0.05, 0.05, radius=0.01, factor=factor), "factor must be in 1e-06..1e+06 t")
        for factor in (0.0, -1.0, 1e-7, 1e308, np.inf, np.nan)
    ),
    (
        PointContacts([[0.05], [np.inf]], 0.05, 1.0, 0.01),
        "contact 0 of skin 1: (x, y) must lie within",
    ),
    (DepthImage([[0.0, -1e-3]]), "depth must be >= 0 m, got -0.001 in row 0 and column 1"),
    (PressureImage([[np.nan]]), "pressure must be >= 0 Pa, got nan in row 0 and column 0"),
]
FORCE, DEPTH = (
    PointContacts(0.02, 0.02, 1.0, 0.005),
    PointContacts(0.02, 0.02, depth=1e-3, radius=0.005),
)
SCENES = [
    (
        "sheet-3x3",
        {},
        FORCE,
        "contacts by force need the foam's law: thickness in [skin.foam], and",
    ),
    ("sheet-3x3", {}, PressureImage([[1.0]]), "contacts by pressure image need the foam's law"),
    ("sheet-3x3", {}, DepthImage([[1e-3]]), "need `skin.foam.thickness`"),
    ("sheet-3x3", {}, DEPTH, "need `skin.foam.thickness`"),
]


@pytest.mark.parametrize(("contacts", "message"), INVALID)
def test_contacts_that_are_none(contacts, message):
    with pytest.raises(InputError) as error:
        contacts()
    assert message in str(error.value) and "\n" not in str(error.value)


@pytest.mark.parametrize(("contacts", "message"), ON_THE_SKIN)
@pytest.mark.parametrize("tension", [0.0, 20.0])
def test_contacts_off_the_skin_or_of_no_strength(contacts, message, tension):
    scene = load("foam").with_({"skin.foam.mechanics.tension": tension})
    with pytest.raises(InputError) as error:
        to_cells(scene.parts.skin, scene.press, (5, 5), contacts)
    assert message in str(error.value)


@pytest.mark.parametrize(("name", "changes", "contacts", "message"), SCENES)
def test_scenes_without_the_foam_s_law(name, changes, contacts, message):
    scene = load(name).with_(changes)
    with pytest.raises(InputError) as error:
        to_cells(scene.parts.skin, scene.press, (6, 6), contacts)
    assert message in str(error.value) and "\n" not in str(error.value)


def test_factors_need_no_law():
    scene = load("sheet-3x3")
    assert to_cells(
        scene.parts.skin, scene.press, (6, 6), PointContacts(0.02, 0.02, factor=2.0, radius=0.005)
    ).cells.size


def test_a_depth_without_mechanics_is_by_constant_permittivity():
    scene = load("sheet-3x3")
    foam = scene.skin.foam
    thick = scene.with_({"skin.foam.thickness": 4e-3})
    (rise,) = to_cells(thick.parts.skin, thick.press, (1, 1), DepthImage([[1e-3]])).rises
    assert rise == pytest.approx(4 / 3 - 1) and foam.mechanics is None


def test_too_deep_is_refused_on_request(sharp):
    refusing = ContactRasterizer.of(sharp.parts.skin, sharp.press, (5, 5), "refuse")
    with pytest.raises(InputError, match="must leave foam of 0.004 m compressed by at most 0.669"):
        refusing(PointContacts(0.05, 0.05, 1e6, 0.01))
    with pytest.raises(InputError, match="must be 'limit' or 'refuse', got 'clamp'"):
        ContactRasterizer.of(sharp.parts.skin, sharp.press, (5, 5), "clamp")

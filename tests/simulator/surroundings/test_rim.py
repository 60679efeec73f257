"""Capacitance along the outline: closed forms, limits and symmetries, and what is refused."""

import numpy as np
import pytest
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.models.validity import rim_per_length
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.foam import VACUUM_PERMITTIVITY
from rcskin.simulator.surroundings import panels, rim
from rcskin.simulator.surroundings.rim import RimDensities, rim_densities
from rcskin.simulator.sweeps import InputError

OUTLINE = {
    "skin.outline": {"points": [[0, 0], [0.1, 0], [0.1, 0.02], [0, 0.02]]},
    "contact.top-left.edge": "outline.4",
    "contact.bottom-left.edge": "outline.4",
}
IN_SPACE = {
    "skin.mesh": {
        "source": "bent.msh",
        "points": "0 0 0, 0.1 0 0, 0.1 0.02 1e-3, 0 0.02 0",
        "triangles": "0 1 2, 0 2 3",
        "lines": "0 3",
        "group": [{"name": "left", "lines": "0"}],
    }
}


def relative(scene):
    """Mutual, top and bottom over eps0, and the error likewise."""
    found = rim_densities(scene.parts.skin)
    three = np.array([found.mutual, found.top, found.bottom])
    return three / VACUUM_PERMITTIVITY, found.error / VACUUM_PERMITTIVITY


@pytest.mark.parametrize(("name", "off"), [("sheet-5x5", 0.01), ("strip-1x5", 0.055)])
def test_of_a_floating_meter_it_is_near_the_closed_form(skin, name, off):
    scene = skin(name, low="floating")
    closed = rim_per_length(*scene.skin.sides, 4e-3)
    assert rim_densities(scene.parts.skin).mutual == pytest.approx(closed, rel=off)
    assert rim_densities(scene.parts.skin).top == rim_densities(scene.parts.skin).bottom == 0


def test_sheets_to_earth_are_in_series_where_the_meter_floats(skin):
    (mutual, top, bottom), _ = relative(skin("sheet-5x5"))
    (floating, _, _), _ = relative(skin("sheet-5x5", low="floating"))
    assert top == pytest.approx(bottom, rel=1e-9)
    assert floating == pytest.approx(mutual + top / 2)


def test_a_body_takes_what_sheets_have_between_them(skin):
    """0.215, 1.247 and 0.636 eps0: from charges of an independent solve in three dimensions."""
    below, error = relative(skin("sheet-5x5", body={"distance": 5e-3}))
    assert below == pytest.approx([0.215, 1.247, 0.636], abs=error)
    above, _ = relative(skin("sheet-5x5", body={"distance": 5e-3, "side": "top"}))
    assert above.tolist() == below[[0, 2, 1]].tolist()
    far, _ = relative(skin("sheet-5x5", body={"distance": 10.0}))
    assert far == pytest.approx(relative(skin("sheet-5x5"))[0], rel=0.01)


def test_it_depends_on_proportions_alone(skin):
    scene = skin("sheet-5x5", body={"distance": 5e-3})
    twice = scene.with_(
        {
            "skin.length": 0.24,
            "skin.width": 0.24,
            "skin.foam.thickness": 8e-3,
            "skin.foam.capacitance_per_area": 4.861e-9 / 2,
            "surroundings.body.distance": 1e-2,
        }
    )
    assert relative(twice)[0] == pytest.approx(relative(scene)[0], rel=1e-9)


def test_the_foams_permittivity_hardly_matters(skin):
    """Less than 4 % from none to any at all, though its side faces carry charge."""
    air = VACUUM_PERMITTIVITY / 4e-3
    light, dense = (
        relative(skin("sheet-5x5", low="floating").with_({"skin.foam.capacitance_per_area": c}))[0]
        for c in (1.0001 * air, 1e3 * air)
    )
    assert 1.0 < dense[0] / light[0] < 1.04


def test_the_error_covers_what_finer_panels_find(skin, monkeypatch):
    scene = skin("sheet-5x5", body={"distance": 5e-3})
    found, error = relative(scene)
    rim._solved.cache_clear()
    monkeypatch.setattr(panels, "PANELS", (9, 15))
    finer, less = relative(scene)
    rim._solved.cache_clear()
    assert np.abs(found - finer).max() < error
    assert less < error / 2


def test_a_rectangle_is_the_same_drawn_by_its_outline(skin):
    scene = skin("strip-1x5")
    found, error = relative(scene)
    drawn, more = relative(scene.with_(OUTLINE))
    assert drawn == pytest.approx(found, abs=error + more)


def test_a_stretched_skin_is_taken_as_it_is_stretched(skin):
    stretch = {"x": 2.0, "y": 1.0, "foam_poisson_ratio": 0.5}
    longer = {
        "skin.length": 0.2,
        "skin.foam.thickness": 2e-3,
        "skin.foam.capacitance_per_area": 2 * 5.4e-9,
    }
    one = skin("strip-1x5").with_({"skin.stretch": stretch})
    other = skin("strip-1x5").with_(longer)
    assert relative(one)[0] == pytest.approx(relative(other)[0], rel=1e-9)


def test_given_densities_are_taken_as_they_are(skin):
    given = skin("sheet-5x5", rim={"mutual": 1e-12, "top": 2e-12, "bottom": 3e-12})
    assert rim_densities(given.parts.skin) == RimDensities(1e-12, 2e-12, 3e-12)
    assert rim_densities(skin("sheet-5x5", rim=False).parts.skin) == RimDensities(0.0)


def test_a_computed_rim_is_solved_for_like_one_that_is_given(skin):
    scene, found = skin("strip-1x5"), rim_densities(skin("strip-1x5").parts.skin)
    given = {"mutual": found.mutual, "top": found.top, "bottom": found.bottom}
    one, other = (
        Solver(each.parts, 1e-4).solve(Press()).Z
        for each in (scene, scene.with_({"surroundings.rim": given}))
    )
    assert one == pytest.approx(other, rel=1e-12)


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        (IN_SPACE, "needs a flat skin; `skin.mesh` lies in space"),
    ],
)
def test_rims_that_cannot_be_computed_are_refused(skin, changes, line):
    with pytest.raises(InputError, match="strip-1x5: `surroundings.rim = true` " + line):
        rim_densities(skin("strip-1x5").with_(changes).parts.skin)

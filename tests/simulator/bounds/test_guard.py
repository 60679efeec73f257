"""A guard on the leads of drawn skins, and in limits."""

import numpy as np
import pytest
from rcskin.simulator.bounds.full_fields import FullFields
from rcskin.simulator.measure.skins import drawn_skin
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.meter import Leads

GUARDED = Leads(stray_capacitance=8e-12, guard=0.75, resistance=20.0)
SEEN = Leads(stray_capacitance=2e-12, resistance=20.0)


def behind(scene, leads):
    return scene.model_copy(update={"leads": leads})


def test_drawn_skins_have_the_unguarded_stray_capacitance(make_scene):
    one, other = (
        drawn_skin(behind(make_scene(), leads).parts, 1, 0, (1, 1), 1).leads
        for leads in (GUARDED, SEEN)
    )
    assert one == other


def test_limits_are_those_of_the_unguarded_stray_capacitance(make_scene):
    guarded, seen = (behind(make_scene(columns=2), leads) for leads in (GUARDED, SEEN))
    frequency, at_rest = guarded.frequencies, np.ones(FullFields(guarded.parts, 1e5).grid)
    one, other = (
        FullFields(each.parts, 1e5).respond(at_rest, {}, frequency, {}) for each in (guarded, seen)
    )
    np.testing.assert_allclose(one.Z, other.Z, rtol=1e-13)
    for name, slope in other.by_parameter.items():
        np.testing.assert_allclose(one.by_parameter[name], slope, rtol=1e-12)
    assert one.Z == pytest.approx(Solver(guarded.parts).solve(Press()).Z, rel=1e-3)

"""Temperature and humidity are slow factors on the foam and the sheets."""

import numpy as np
import pytest
from rcskin.simulator.measure.skins import drawn_skin
from rcskin.simulator.models.session_spreads import session_spreads
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.scene_files import load_scene, parse_scene, scene_text
from rcskin.tests.refusals import refusal_of

BOTH = {
    "skin.foam.temperature": {"reference": 20.0, "capacitance": 2e-3, "sheet_resistance": -1e-3},
    "skin.foam.humidity": {"reference": 40.0, "capacitance": 1e-3},
}
FOAM = {
    "thickness": 4e-3,
    "mechanics": {"porosity": 0.67, "solid_permittivity": 2.79, "modulus": 30e3},
}


@pytest.fixture(scope="module")
def strip():
    return load_scene("strip-1x5")


def test_both_act_as_factors_on_capacitance_and_sheets(strip):
    warm = strip.with_({**BOTH, "experiment.temperature": 30.0, "experiment.humidity": 90.0})
    c = strip.skin.foam.unpressed_capacitance_per_area
    by_hand = strip.with_(
        {
            "skin.foam.capacitance_per_area": c * 1.02 * 1.05,
            "skin.sheet_resistance": strip.skin.top.sheet_resistance * 0.99,
        }
    )
    one, other = (Solver(scene.parts).solve(Press()).Z for scene in (warm, by_hand))
    np.testing.assert_allclose(one, other, rtol=1e-12)


def test_at_the_reference_nothing_changes(strip):
    known = strip.with_({**BOTH, "experiment.temperature": 20.0})
    assert known.skin.top == strip.skin.top
    assert (
        known.skin.foam.unpressed_capacitance_per_area
        == strip.skin.foam.unpressed_capacitance_per_area
    )


def test_a_scene_written_in_its_weather_is_the_same_scene_again(strip):
    """The line in temperature is then written about another reference, and goes on from there."""
    warm = strip.with_({**BOTH, "experiment.temperature": 30.0})
    assert parse_scene(scene_text(warm), "again") == warm
    cold, at_once = (s.with_({"experiment.temperature": 5.0}) for s in (warm, strip.with_(BOTH)))
    for sheet in ("top", "bottom"):
        one, other = (getattr(s.skin, sheet).sheet_resistance for s in (cold, at_once))
        assert one == pytest.approx(other, rel=1e-12)
    one, other = (s.skin.foam.unpressed_capacitance_per_area for s in (cold, at_once))
    assert one == pytest.approx(other, rel=1e-12)


@pytest.mark.parametrize(
    "foam",
    [
        {"capacitance_per_area": 5e-9},
        {"thickness": 4e-3, "relative_permittivity": 2.2},
        FOAM,
        {**FOAM, "relative_permittivity": 1.6},
    ],
)
def test_thickness_stays_however_the_capacitance_is_given(strip, foam):
    given = strip.with_({"skin.foam": {**foam, "temperature": {"capacitance": 0.01}}})
    warm = given.with_({"experiment.temperature": 33.0})
    c, c_warm = (s.skin.foam.unpressed_capacitance_per_area for s in (given, warm))
    assert c_warm == pytest.approx(1.1 * c, rel=1e-12)
    assert warm.skin.foam.thickness == given.skin.foam.thickness
    assert parse_scene(scene_text(warm), "again") == warm


def test_sessions_draw_their_weather_after_all_else(strip):
    """A session at one temperature is the session without, times the factors."""
    drawn = strip.with_({**BOTH, "dataset.session.temperature": 30.0})
    grid = strip.pixels.shape
    one, other = (drawn_skin(s.parts, 1, 4, grid, 4) for s in (drawn, strip))
    np.testing.assert_allclose(one.variation.capacitance, 1.02 * other.variation.capacitance)
    np.testing.assert_allclose(one.variation.top, other.variation.top / 0.99)
    assert one.leads == other.leads


def test_what_sessions_draw_counts_among_their_spread(strip):
    uniform = {"distribution": "uniform", "low": 10.0, "high": 30.0}
    drawn = strip.with_({**BOTH, "dataset.session.temperature": uniform})
    more, less = session_spreads(drawn.parts), session_spreads(strip.parts)
    own = np.hypot(less["capacitance"].deviation, 2e-3 * 20 / np.sqrt(12))
    assert more["capacitance"].deviation == pytest.approx(own, rel=1e-3)
    assert more["sheet_mismatch"] == less["sheet_mismatch"]


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"experiment.temperature": 30.0}, "`experiment.temperature` needs the table"),
        ({"dataset.session.humidity": 30.0}, "`dataset.session.humidity` needs the table"),
        (
            {"skin.foam.temperature": {"capacitance": 0.1}, "experiment.temperature": 123.0},
            "`experiment.temperature` must leave capacitance from 0.1 to 10 times",
        ),
        (
            {
                "skin.foam.humidity": {"sheet_resistance": 0.1},
                "dataset.session.humidity": {"distribution": "uniform", "low": 0.0, "high": 50.0},
            },
            "`dataset.session.humidity` must leave sheet_resistance from 0.1 to 10 times",
        ),
        (
            {
                "skin.foam": {"thickness": 1e-3, "relative_permittivity": 1.01},
                "skin.foam.temperature": {"capacitance": -0.01},
                "experiment.temperature": 33.0,
            },
            "`experiment.temperature` must leave skin.foam.relative_permittivity >= 1, got 0.909",
        ),
    ],
)
def test_invalid_scenes_are_refused_in_one_line(strip, changes, told):
    assert told in refusal_of(strip.with_, changes)

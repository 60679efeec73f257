"""What a session draws of the parameters: against skins drawn for a data set, in every use."""

import numpy as np
import pytest
from rcskin.simulator.bounds.full_fields import FullFields
from rcskin.simulator.bounds.likelihood import error_model
from rcskin.simulator.bounds.position_bound import SkinUnknowns
from rcskin.simulator.calibration.measurements import measurements_of
from rcskin.simulator.calibration.prior import priors
from rcskin.simulator.inversion.unknown_skin import UnknownSkin
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.measure.skins import drawn_skin
from rcskin.simulator.models.reduced.forward import Forward
from rcskin.simulator.models.session_spreads import session_spreads
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press

METER = {"magnitude_noise": 1e-3, "phase_noise": 1e-3}
FILMS = {"top-left": {"resistance": 200.0}, "bottom-left": {"resistance": 120.0}}
SESSION = {
    "sheet_resistance": {"distribution": "uniform", "low": 1.0, "high": 1.2},
    "sheet_mismatch": {"distribution": "lognormal", "median": 1.1, "spread": 0.03},
    "contact_resistance": {"distribution": "lognormal", "median": 0.9, "spread": 0.04},
    "stray_capacitance": {"distribution": "uniform", "low": 0.0, "high": 2e-12},
}


@pytest.fixture(scope="module")
def scene(make_scene, changed):
    made = make_scene(FILMS, columns=2, frequencies=(1e3, 1e4))
    return changed(made, {"readout": METER, "dataset.session": SESSION})


def drawn(scene, sessions=3000):
    skins = [drawn_skin(scene.parts, 1, number, (1, 2), 1) for number in range(sessions)]
    top, bottom = (np.log([getattr(s.variation, n)[0] for s in skins]) for n in ("top", "bottom"))
    return {
        "sheet_resistance": -(top + bottom) / 2,
        "sheet_mismatch": bottom - top,
        "contact_resistance": np.mean([-np.log(s.variation.films) for s in skins], axis=1),
        "stray_capacitance": np.array([s.leads.stray_capacitance for s in skins]),
    }


def test_spreads_are_those_of_drawn_skins(scene):
    spreads = session_spreads(scene.parts)
    for name, values in drawn(scene).items():
        assert spreads[name].deviation == pytest.approx(values.std(), rel=0.05)
        assert spreads[name].shift == pytest.approx(values.mean(), abs=0.1 * values.std())


def test_calibration_limits_and_inversion_take_the_same_spreads(scene):
    spreads = {
        name: each for name, each in session_spreads(scene.parts).items() if each.deviation > 0
    }
    prior = priors(
        measurements_of(scene.parts, simulate(Solver(scene.parts), [Press()])), "session"
    )
    for name, each in spreads.items():
        assert prior[name].deviation == each.deviation
        assert prior[name].center == each.shift
    frequency = np.array(scene.frequencies)
    limits = SkinUnknowns(
        FullFields(scene.parts, 1e4),
        frequency,
        error_model(scene.parts.setup, scene.parts.meter, frequency),
    ).deviations
    assert {name: limits[name] for name in spreads} == {n: s.deviation for n, s in spreads.items()}
    inversion = UnknownSkin(Forward(scene.parts, rtol=1e-3))
    assert {name: inversion.values[name] for name in spreads} == {
        n: s.shift for n, s in spreads.items()
    }


def test_only_resistive_contacts_share_the_spread_of_contacts(make_scene):
    one = make_scene({"top-left": {"resistance": 200.0}, "bottom-left": {}})
    assert session_spreads(one.parts)["contact_resistance"].deviation == pytest.approx(
        0.04, rel=0.05
    )

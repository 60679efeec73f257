"""Tables for inversion, compared with the full solver and with many drawn skins."""

import numpy as np
import pytest
from rcskin.simulator.inversion import position_tables
from rcskin.simulator.inversion.touch_templates import (
    STRENGTHS,
    normal_mixture,
    strength_prior,
    templates,
)
from rcskin.simulator.inversion.unknown_skin import UnknownSkin, expected
from rcskin.simulator.measure.readout import ErrorModel, observed
from rcskin.simulator.measure.skins import drawn_skin
from rcskin.simulator.models.parameters import HALF_WAVES, parts_with
from rcskin.simulator.models.reduced.cases import Case
from rcskin.simulator.models.reduced.forward import Forward
from rcskin.simulator.models.reduced.greedy import reduce
from rcskin.simulator.models.session_spreads import session_spreads
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.batch import NOTHING, PressBatch, TouchedCells
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.touch import Rectangle, Touch
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.sweeps import InputError
from rcskin.tests.library.scenes import ALIKE

NOISE = {"magnitude_noise": 0.003, "phase_noise": 2.6e-3}
PAIR = {"top-left": {"resistance": 200.0}, "bottom-left": {"resistance": 100.0}}


def tables_scene(make_scene, session=None, **keys):
    scene = make_scene(PAIR, rows=2, columns=2, frequencies=(1e3, 1e4, 1e5), **keys)
    table = scene.model_dump(by_alias=True, exclude_none=True)
    drawn = {"session": session or {}, "press": {"touches": [0.2, 0.8], "size": 0.05}}
    return Scene.model_validate(table | {"readout": NOISE, "dataset": drawn})


@pytest.fixture(scope="module")
def scene(make_scene):
    return tables_scene(make_scene)


def change(scene, press):
    solver = Solver(scene.parts, 1e-5)
    return observed(solver.solve(press).Z) - observed(solver.solve(Press()).Z)


@pytest.fixture(scope="module")
def tables(scene):
    return templates(scene.parts, "pixel")


def test_touches_are_those_of_the_full_solver(scene, tables):
    mean_skin = parts_with(scene.parts, expected(scene.parts)).scene
    for place, strength in ((0, 1), (3, 5)):
        row, column = tables["pixels"][place]
        press = Press((Touch(int(row), int(column), tables["strengths"][strength]),))
        off = tables["single"][place, strength] - change(mean_skin, press)
        assert np.abs(off / tables["deviation"]).max() < 0.2


def test_slopes_are_differences_between_strengths(tables):
    difference = np.gradient(tables["single"], tables["strengths"], axis=1)[:, 1:-1]
    scale = np.abs(tables["slope"]).max()
    np.testing.assert_allclose(tables["slope"][:, 1:-1], difference, atol=0.03 * scale)


def test_pairs_are_two_simultaneous_touches(scene):
    tables = templates(scene.parts, "pair")
    assert len(tables["pairs"]) == 6
    pair = int(np.flatnonzero((tables["pairs"] == [0, 3]).all(axis=1))[0])
    first, second = tables["strengths"][[2, 4]]
    press = Press((Touch(1, 1, first), Touch(2, 2, second)))
    expected_change = change(parts_with(scene.parts, expected(scene.parts)).scene, press)
    off = tables["pair"][pair, 2, 4] - expected_change
    assert np.abs(off / tables["deviation"]).max() < 0.2


def test_the_effect_of_unknown_skins_is_the_spread_over_drawn_skins(make_scene):
    """Uneven sheets, foam, contacts, leads: all of a data set's session at once."""
    drawn = tables_scene(make_scene, {"contact_resistance": 1.0})
    unknown = UnknownSkin(Forward(drawn.parts, rtol=1e-3))
    effect, _ = unknown.of_touch(np.array([1]), np.array([1.0]))
    modes = len(HALF_WAVES)

    def one(random):
        return Case(
            drawn_skin(drawn.parts, int(random.integers(2**62)), 0, (2, 2), modes).variation, *TOUCH
        )

    family = reduce(drawn.parts, 1e-3, one, modes=modes, same_sheets=False)
    changes = np.array([_change(drawn, family, seed) for seed in range(400)])
    np.testing.assert_allclose(
        np.sqrt((effect**2).sum(axis=1)), changes.std(axis=0), rtol=0.15, atol=2e-5
    )


TOUCH = np.array([1]), np.array([1.0])


def _change(scene, family, seed):
    return _observed(scene, family, seed)[1]


def _observed(scene, family, seed):
    """At rest, and what a touch changes."""
    skin = drawn_skin(scene.parts, seed, 0, (2, 2), len(HALF_WAVES))
    Z = family.at(skin.variation).sweeps(PressBatch.of([NOTHING, TOUCH]), scene.frequencies)
    seen = observed(skin.leads.at_meter(Z, scene.frequencies))
    return seen[0], seen[1] - seen[0]


def test_a_skin_is_estimated_from_its_baseline(make_scene):
    """Drawn skins, read once at rest with noise: touches are foretold within what is left open."""
    drawn = tables_scene(make_scene, {"unevenness": 0.04, "lead_resistance": 2.0})
    unknown, modes = UnknownSkin(Forward(drawn.parts, rtol=1e-3)), len(HALF_WAVES)

    def one(random):
        skin = drawn_skin(drawn.parts, int(random.integers(2**62)), 0, (2, 2), modes)
        return Case(skin.variation, *TOUCH)

    family = reduce(drawn.parts, 1e-3, one, modes=modes, same_sheets=False)
    error = ErrorModel(drawn.readout, np.ones((len(drawn.interfaces), 3), bool), averaged=20)
    random = np.random.default_rng(0)
    z, before, after = [], [], []
    for seed in range(40):
        rest, change = _observed(drawn, family, seed)
        noise = random.multivariate_normal(np.zeros(rest.size), error.covariance)
        skin = unknown.conditioned_on_baseline(rest + noise, 20)
        told, effect = _predicted(skin)
        before.append(change - _predicted(unknown)[0])
        after.append(change - told)
        left = effect @ effect.T + np.diag(error.deviation**2)
        z.append(after[-1] @ np.linalg.solve(left, after[-1]))
    assert np.std(after) < 0.6 * np.std(before)
    assert np.mean(z) < rest.size


def _predicted(skin):
    effect, moved = skin.of_touch(*TOUCH)
    presses = TouchedCells(*TOUCH), NOTHING
    touched, rest = (observed(skin.forward.slopes(each, skin.values).Z) for each in presses)
    return touched - rest + moved, effect


@pytest.fixture(scope="module")
def forward(scene):
    return Forward(scene.parts, rtol=1e-3)


@pytest.fixture(scope="module")
def baseline(forward):
    return UnknownSkin(forward).baseline() + 0.01


def test_an_impossible_baseline_leaves_unknowns_within_bounds(forward):
    unknown = UnknownSkin(forward)
    far = unknown.conditioned_on_baseline(unknown.baseline() + 5.0, 10**6)
    assert np.isfinite(far.baseline()).all()


def test_drift_is_a_small_change_of_all_foam_and_of_both_sheets(scene, forward, baseline):
    tables = templates(scene.parts, "pixel", "dataset", baseline, 20, 1e-3)
    values = UnknownSkin(forward).conditioned_on_baseline(baseline, 20).values
    for column, name in zip(tables["drift"].T, ("capacitance", "sheet_resistance"), strict=True):
        moved = values | {name: values[name] + 1e-3}
        ahead, now = (observed(forward.slopes(NOTHING, v).Z) for v in (moved, values))
        np.testing.assert_allclose(column, ahead - now, rtol=0.01, atol=1e-7)
    np.testing.assert_array_equal(tables["skin"][0, 0, :, -2:], tables["drift"])


def test_a_skin_without_variation_is_known(make_scene):
    scene = tables_scene(make_scene, ALIKE["dataset.session"])
    assert not any(spread.deviation for spread in session_spreads(scene.parts).values())
    assert templates(scene.parts, "column")["skin"].shape[-1] == 0


def test_strengths_cover_their_distribution(scene):
    strengths, weights, spread = strength_prior(scene.parts.skin, scene.parts.plan, "dataset")
    fine = np.linspace(1.6, 2.7, 50)[:, None]
    density = np.exp(-(((fine - strengths) / spread) ** 2) / 2) @ weights
    np.testing.assert_allclose(density / density.mean(), 1.0, rtol=0.03)
    assert weights.sum() == pytest.approx(1.0, abs=0.01)
    assert len(normal_mixture(lambda chance: np.full(np.shape(chance), 2.0), STRENGTHS)[0]) == 1
    assert len(strengths) == STRENGTHS


def test_strengths_of_the_experiment_follow_the_press(make_scene):
    scene = tables_scene(make_scene)
    pressed = scene.model_copy(
        update={"press": scene.press.model_copy(update={"factor_spread": 0.1})}
    )
    strengths, weights, spread = strength_prior(pressed.parts.skin, pressed.parts.plan, "press")
    mean = strengths @ weights
    deviation = np.sqrt((strengths - mean) ** 2 @ weights + spread**2)
    assert mean == pytest.approx(2.0, abs=0.01)
    assert deviation == pytest.approx(0.1, rel=0.15)


def test_positions_are_tabulated_by_the_full_solver(scene, monkeypatch):
    monkeypatch.setattr(position_tables, "NODES", 3)
    scene = scene.with_({"dataset.press.factor": {"low": 1.3, "high": 3.0}})
    tables = templates(scene.parts, "position")
    x, y, f = (tables[name][1] for name in ("x", "y", "strength_nodes"))
    side, _ = position_tables.touch_size(scene.parts.plan)
    press = Press((Rectangle(x, y, side, side, f),))
    off = tables["values"][1, 1, 1] - change(
        parts_with(scene.parts, expected(scene.parts)).scene, press
    )
    assert np.abs(off / tables["deviation"]).max() < 0.3
    ends = tables["x"][[0, -1]]
    np.testing.assert_allclose(ends, [side / 2, scene.skin.length - side / 2], rtol=1e-12)
    assert tables["skin"].shape[:3] == (3, 3, 6)


def test_a_meter_without_noise_is_refused(make_scene):
    with pytest.raises(InputError, match="must be > 0"):
        templates(make_scene(rows=1, columns=2).parts, "column")

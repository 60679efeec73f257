"""Interfaces that are read at frequencies of their own, from the scene to bounds and data sets."""

import numpy as np
import pytest
from rcskin.simulator.bounds.common import CommonDraws
from rcskin.simulator.bounds.readings import RTOL
from rcskin.simulator.limits import bayes_accuracy, position_bound
from rcskin.simulator.measure.readout import ErrorModel, read_out
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.models.network.terminals import reduced_for
from rcskin.simulator.models.reduced.cases import pixel_touches
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import every_press
from rcskin.simulator.scene.files import load_scene, parse_scene, scene_text
from rcskin.simulator.scene.meter import Readout
from rcskin.simulator.sweeps import InputError, check, concatenate, impedance, read, write

FREQUENCIES = [1e3, 1e4, 1e5]
READOUT = {"magnitude_accuracy": 0.02, "magnitude_noise": 0.02, "phase_noise": 0.02}
TAKEN = np.array([[True, True, False], [False, True, True]])


@pytest.fixture(scope="module")
def shared():
    changes = {
        "pixels": {"rows": 2, "columns": 2},
        "sweep.frequencies": FREQUENCIES,
        "readout": READOUT,
        "dataset.session": {"unevenness": 0.0},
    }
    return load_scene("sheet-5x5-two-interfaces").with_(changes)


@pytest.fixture(scope="module")
def own(shared):
    each = {"interface.1.frequencies": [1e4, 1e3], "interface.2.frequencies": [1e4, 1e5]}
    return shared.with_(each)


def test_a_scene_keeps_them_and_one_without_says_nothing(shared, own):
    assert own.taken.tolist() == TAKEN.tolist()
    assert parse_scene(scene_text(own), "own") == own
    assert shared.taken is None
    assert scene_text(shared).count("frequencies") == 1


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"interface.1.frequencies": [5e3]}, "'left': `frequencies` must be among .* 5000 Hz"),
        ({"interface.1.frequencies": [1e3, 1e3]}, "distinct"),
        ({f"interface.{k}.frequencies": [1e3] for k in (1, 2)}, "no interface is read at 10000"),
    ],
)
def test_what_is_wrong_with_them_is_told(shared, given, told):
    with pytest.raises(InputError, match=told):
        shared.with_(given)


def test_a_meter_shows_what_is_read_and_nothing_else(own):
    found = simulate(Solver(own, 1e-3), every_press(own)[:2])
    shown = read_out(found, own.readout, np.random.default_rng(0))
    np.testing.assert_array_equal(shown["taken"].values, TAKEN)
    assert np.isnan(shown["Rs"].values[:, ~TAKEN]).all()
    off = impedance(shown)[:, TAKEN] / impedance(found)[:, TAKEN] - 1
    assert 0 < np.abs(off).max() < 0.2


def test_sweeps_hold_what_is_read_and_nothing_else(shared, own, tmp_path):
    found, whole = (
        simulate(Solver(scene, 1e-3), every_press(scene)[:2]) for scene in (own, shared)
    )
    for name in ("Rs", "X", "Cp"):
        np.testing.assert_array_equal(found[name].values[:, TAKEN], whole[name].values[:, TAKEN])
        assert np.isnan(found[name].values[:, ~TAKEN]).all()
    assert "taken" not in whole.variables
    write(found, tmp_path / "own.nc")
    assert check(read(tmp_path / "own.nc")).identical(found)
    with pytest.raises(InputError, match="cannot be joined"):
        concatenate([found, whole])


def test_readings_that_were_not_taken_must_not_be_there(own):
    found = simulate(Solver(own, 1e-3), every_press(own)[:1])
    with pytest.raises(InputError, match="`Rs` must be NaN where `taken`"):
        check(found.assign(Rs=found["Rs"].fillna(1.0)))
    with pytest.raises(InputError, match="`X` must be finite"):
        check(found.assign(X=found["X"] * np.nan))


@pytest.mark.parametrize("against_rest", [0, 3])
def test_errors_are_those_of_what_is_taken(against_rest):
    readout = Readout(**READOUT)
    whole = ErrorModel(readout, 2, 3, against_rest=against_rest)
    part = ErrorModel(readout, 2, 3, against_rest=against_rest, taken=TAKEN)
    kept = np.tile(TAKEN.ravel(), 2)
    np.testing.assert_allclose(part.covariance, whole.covariance[np.ix_(kept, kept)])
    np.testing.assert_allclose(part.deviation, whole.deviation[kept])
    x = np.random.default_rng(1).standard_normal(12)
    distance = x[kept] @ np.linalg.solve(part.covariance, x[kept])
    assert part.whitened(x) @ part.whitened(x) == pytest.approx(distance)


@pytest.fixture(scope="module")
def own_skin(own):
    return reduced_for(own, RTOL, pixel_touches(own, (0.5, 3.0))).skin(None)


@pytest.mark.parametrize("against_rest", [0, 3])
def test_two_bounds_agree_and_less_is_told_by_less(shared, own, own_skin, against_rest):
    known = {"draws": 500, "against_rest": against_rest}
    part, whole = (bayes_accuracy(scene, "pixel", **known) for scene in (own, shared))
    assert part[0] < whole[0]
    other = CommonDraws(own, "pixel", **known).judged(own_skin).accuracy
    assert abs(other.share - part[0]) < 4 * np.hypot(other.error, part[1])


def test_places_are_told_as_by_a_scene_of_what_is_read(shared):
    alone = {"interface": [shared.interfaces[0].model_dump(mode="json")]}
    lowest = shared.with_(alone | {"sweep.frequencies": [1e3]})
    frequencies = {"interface.1.frequencies": [1e3], "interface.2.frequencies": [1e4, 1e5]}
    both = shared.with_(frequencies)
    first, second = (position_bound(scene, against_rest=3, most=2) for scene in (lowest, both))
    assert (second.x <= first.x * (1 + 1e-9)).all()
    whole = position_bound(shared, against_rest=3, most=2)
    assert (whole.x < second.x).all()

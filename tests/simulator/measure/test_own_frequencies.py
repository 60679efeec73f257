"""Interfaces that are read at frequencies of their own, from the scene to bounds and data sets."""

import numpy as np
import pandas as pd
import pytest
from rcskin.simulator.bounds.bayes import Draws
from rcskin.simulator.bounds.likelihood import Likelihood
from rcskin.simulator.bounds.touch_readings import RTOL, hypotheses
from rcskin.simulator.limits import bayes_accuracy, position_bound
from rcskin.simulator.measure.experiment import own_presses
from rcskin.simulator.measure.readout import ErrorModel, read_out
from rcskin.simulator.measure.simulate import resimulated, simulate
from rcskin.simulator.measure.symmetry import repeated
from rcskin.simulator.models.reduced.cases import pixel_touches
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.models.terminals import reduced_for
from rcskin.simulator.press.press import every_press
from rcskin.simulator.scene.meter import Readout
from rcskin.simulator.scene.scene_files import load_scene, parse_scene, scene_text
from rcskin.simulator.sweeps import InputError, check, concatenate, impedance, read, write
from rcskin.simulator.sweeps.imports import import_file
from rcskin.simulator.sweeps.joining import join
from rcskin.simulator.sweeps.reading_subset import restricted

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
    assert own.parts.setup.taken.tolist() == TAKEN.tolist()
    assert parse_scene(scene_text(own), "own") == own
    assert shared.parts.setup.taken is None
    assert scene_text(shared).count("frequencies") == 1


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"interface.1.frequencies": [5e3]}, "'left': `frequencies` must be among .* 5000 Hz"),
        ({"interface.1.frequencies": [1e3, 1e3]}, "distinct"),
        ({f"interface.{k}.frequencies": [1e3] for k in (1, 2)}, "no interface is read at 10000"),
    ],
)
def test_wrong_frequencies_are_refused_by_key(shared, given, message):
    with pytest.raises(InputError, match=message):
        shared.with_(given)


def test_a_meter_shows_what_is_read_and_nothing_else(own):
    found = simulate(Solver(own.parts, 1e-3), every_press(own.parts.skin, own.press)[:2])
    shown = read_out(found, own.readout, np.random.default_rng(0))
    np.testing.assert_array_equal(shown["taken"].values, TAKEN)
    assert np.isnan(shown["Rs"].values[:, ~TAKEN]).all()
    off = impedance(shown)[:, TAKEN] / impedance(found)[:, TAKEN] - 1
    assert 0 < np.abs(off).max() < 0.2


def test_sweeps_hold_what_is_read_and_nothing_else(shared, own, tmp_path):
    found, whole = (
        simulate(Solver(scene.parts, 1e-3), every_press(scene.parts.skin, scene.press)[:2])
        for scene in (own, shared)
    )
    for name in ("Rs", "X", "Cp"):
        np.testing.assert_array_equal(found[name].values[:, TAKEN], whole[name].values[:, TAKEN])
        assert np.isnan(found[name].values[:, ~TAKEN]).all()
    assert "taken" not in whole.variables
    write(found, tmp_path / "own.nc")
    assert check(read(tmp_path / "own.nc")).identical(found)
    write(found, tmp_path / "own.csv")
    again = read(tmp_path / "own.csv")
    assert again.equals(found.drop_vars(["Rs_error", "Cp_error"])) and again.attrs == found.attrs
    lines = [line for line in (tmp_path / "own.csv").read_text().splitlines() if line[0] != "#"]
    assert len(lines) == 1 + 2 * TAKEN.sum() and not any("nan" in line for line in lines)
    bare = tmp_path / "bare.csv"
    bare.write_text("\n".join(lines))
    assert import_file(bare)["Rs"].equals(again["Rs"])
    with pytest.raises(InputError, match="cannot be joined"):
        concatenate([found, whole])


def test_cp_alone_is_followed_at_what_each_interface_was_read_at(own, tmp_path):
    found = simulate(Solver(own.parts, 1e-3), every_press(own.parts.skin, own.press)[:2])
    write(found, tmp_path / "own.csv")
    table = pd.read_csv(tmp_path / "own.csv", comment="#").drop(columns="X_ohm")
    table.to_csv(tmp_path / "Cp.csv", index=False)
    for again in (read(tmp_path / "Cp.csv"), import_file(tmp_path / "Cp.csv")):
        np.testing.assert_array_equal(again["taken"].values, TAKEN)
        np.testing.assert_allclose(again["X"].values, found["X"].values, rtol=1e-9)


def test_recordings_are_joined_if_their_readings_are_equal(own, shared):
    part, whole = (
        simulate(Solver(scene.parts, 1e-3), every_press(scene.parts.skin, scene.press)[:2])
        for scene in (own, shared)
    )
    both = join([part, part.isel(interface=[1, 0])], ["one.nc", "other.nc"])
    np.testing.assert_array_equal(both["taken"].values, TAKEN)
    assert np.isfinite(both["Rs"].values[:, TAKEN]).all() and both.sizes["sweep"] == 4
    with pytest.raises(
        InputError, match=r"two.nc: its interfaces were read at other `frequencies`"
    ):
        join([whole, part], ["one.nc", "two.nc"])


def test_fewer_readings_are_those_of_a_scene_of_fewer(own, shared):
    part, whole = (
        simulate(Solver(scene.parts, 1e-3), every_press(scene.parts.skin, scene.press)[:2])
        for scene in (own, shared)
    )
    for name in ("Rs", "X", "Cp", "Rs_error", "taken"):
        assert restricted(whole, TAKEN)[name].equals(part[name])
    only = restricted(part, np.array([[True, True, False], [False, False, False]]))
    assert only["interface"].values.tolist() == ["left"] and "taken" not in only.variables
    assert only["frequency"].values.tolist() == FREQUENCIES[:2]


def test_a_scene_is_read_otherwise_by_its_interfaces(own, shared):
    assert own.parts.setup.frequency_at("bottom").tolist() == [1e4, 1e5]
    assert shared.parts.setup.own == {}
    of_own, of_shared = own.parts.setup, shared.parts.setup
    left = of_own.of(["left"])
    assert left.taken is None and left.frequency.tolist() == [1e3, 1e4]
    assert of_own.taking(of_shared.frequency) == of_shared
    assert own.parts.read(of_own.taking(of_shared.frequency)).scene == shared
    assert of_shared.taking(of_shared.frequency, TAKEN).taken.tolist() == TAKEN.tolist()
    assert of_own.of(["left", "bottom"]).taken.tolist() == TAKEN.tolist()


def test_presses_are_simulated_anew_at_what_was_read(own, shared):
    part, whole = (
        simulate(Solver(scene.parts, 1e-3), every_press(scene.parts.skin, scene.press)[:2])
        for scene in (own, shared)
    )
    again = resimulated(part, own.parts, own.frequencies)
    np.testing.assert_allclose(again["Rs"].values, part["Rs"].values, rtol=1e-3)
    elsewhere = resimulated(part, own.parts, own.frequencies[:2])
    np.testing.assert_allclose(elsewhere["Rs"], whole["Rs"][:, :, :2], rtol=1e-3)


def test_an_interface_that_shows_the_same_is_no_repeat_at_other_frequencies(shared):
    both = shared.with_({"interface.2.high": ["top-left"], "interface.2.low": ["bottom-left"]})
    assert repeated(both.parts.skin, both.parts.setup, both.press) == [("bottom", "left")]
    less = both.with_({"interface.2.frequencies": [1e4]})
    assert repeated(less.parts.skin, less.parts.setup, less.press) == [("bottom", "left")]
    other = both.with_({"interface.1.frequencies": [1e3, 1e4], "interface.2.frequencies": [1e5]})
    assert repeated(other.parts.skin, other.parts.setup, other.press) == []


def test_readings_that_were_not_taken_must_not_be_there(own):
    found = simulate(Solver(own.parts, 1e-3), every_press(own.parts.skin, own.press)[:1])
    with pytest.raises(InputError, match="`Rs` must be NaN where `taken`"):
        check(found.assign(Rs=found["Rs"].fillna(1.0)))
    with pytest.raises(InputError, match="`X` must be finite"):
        check(found.assign(X=found["X"] * np.nan))


@pytest.mark.parametrize("against_rest", [0, 3])
def test_errors_are_those_of_what_is_taken(against_rest):
    readout = Readout(**READOUT)
    whole, part = (
        ErrorModel(readout, read, against_rest=against_rest)
        for read in (np.ones_like(TAKEN), TAKEN)
    )
    kept = np.tile(TAKEN.ravel(), 2)
    np.testing.assert_allclose(part.covariance, whole.covariance[np.ix_(kept, kept)])
    np.testing.assert_allclose(part.deviation, whole.deviation[kept])
    x = np.random.default_rng(1).standard_normal(12)
    distance = x[kept] @ np.linalg.solve(part.covariance, x[kept])
    assert part.whitened(x) @ part.whitened(x) == pytest.approx(distance)


@pytest.fixture(scope="module")
def own_skin(own):
    return reduced_for(
        own.parts, RTOL, pixel_touches(own.parts.skin, own.parts.plan, (0.5, 3.0))
    ).at(None)


@pytest.mark.parametrize("against_rest", [0, 3])
def test_two_bounds_agree_and_fewer_readings_give_less(shared, own, own_skin, against_rest):
    known = {"draws": 300}
    part, whole = (
        bayes_accuracy(scene.parts, "pixel", against_rest=against_rest, **known)
        for scene in (own, shared)
    )
    assert part[0] < whole[0]
    by_own = Likelihood(
        own.parts.skin, own_skin.sweeps, own.parts.setup, own.parts.meter, against_rest
    )
    among = hypotheses(own.parts.skin, own.parts.plan, "pixel")
    drawn = Draws(among, own_presses(own.parts.skin, own.press), **known)
    other = drawn.score(by_own).accuracy
    assert abs(other.share - part[0]) < 4 * np.hypot(other.error, part[1])


def test_positions_are_those_of_a_scene_with_the_readings_alone(shared):
    alone = {"interface": [shared.interfaces[0].model_dump(mode="json")]}
    lowest = shared.with_(alone | {"sweep.frequencies": [1e3]})
    frequencies = {"interface.1.frequencies": [1e3], "interface.2.frequencies": [1e4, 1e5]}
    both = shared.with_(frequencies)
    first, second = (
        position_bound(scene.parts, against_rest=3, max_places=2) for scene in (lowest, both)
    )
    assert (second.x <= first.x * (1 + 1e-9)).all()
    whole = position_bound(shared.parts, against_rest=3, max_places=2)
    assert (whole.x < second.x).all()

"""A study's table: what it holds is what solving and judging every point by itself gives."""

import numpy as np
import pytest
from rcskin.__main__ import _accuracy
from rcskin.simulator.measure.experiment import METER, PRESSES, planned_presses
from rcskin.simulator.measure.readout import read_out
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press
from rcskin.simulator.progress import silent
from rcskin.simulator.study.axis import parse_axes
from rcskin.simulator.study.keys import scene_table
from rcskin.simulator.study.point import Trial
from rcskin.simulator.study.report import answers
from rcskin.simulator.study.run import scenes_of, study


@pytest.fixture(scope="module")
def run_study():
    """Runs a study of a built-in scene over axes in their syntax; gives findings, scenes, axes."""

    def run_study(name, *vary, draws=2, target="column", cross_validate=_accuracy, **more):
        trial = Trial(target, draws)
        table = scene_table(name)
        axes = parse_axes(vary, table)
        scenes = scenes_of(table, axes, trial)
        found = study(scenes, axes, trial, cross_validate, silent, **more)
        return found, scenes, axes

    return run_study


def never_asked(sweeps, *, target, folds, seed):
    """Stands for a localizer where separation alone is looked at."""
    return 0.5


def test_a_point_is_as_if_simulated_and_cross_validated_by_itself(run_study):
    """Two sheet resistances from one solve: five strengths on 6 of 9 pixels, and rest."""
    found, scenes, _ = run_study("sheet-3x3", "skin.sheet_resistance=2e3,50e3", draws=1)
    assert found.attrs["solves"] == 5 * 6 + 1
    for scene, accuracy in zip(scenes, found["accuracy"].values, strict=True):
        seed = scene.experiment.seed
        presses = planned_presses(scene, np.random.default_rng([seed, PRESSES, 0]))
        meter = np.random.default_rng([seed, METER, 0])
        measured = read_out(simulate(Solver(scene), presses), scene.readout, meter)
        expected = _accuracy(measured, target="column", folds=5, seed=0)
        assert accuracy == pytest.approx(expected, abs=0.02)


def test_the_exact_sweeps_given_to_the_localizer_are_those_of_a_direct_solve(run_study):
    """With next to no noise and six digits displayed, Rs and Cp are the solver's own."""
    seen = []

    def look(sweeps, **_):
        seen.append(sweeps)
        return 1.0

    noise = ("readout.magnitude_noise=1e-9", "readout.phase_noise=1e-9")
    _, (scene,), _ = run_study("strip-1x3", *noise, draws=1, cross_validate=look, rtol=1e-6)
    presses = planned_presses(scene, np.random.default_rng([scene.experiment.seed, PRESSES, 0]))
    assert list(seen[0]["press"].values) == [str(press) for press in presses]
    exact = simulate(Solver(scene), presses)
    measured, true = (sweeps["Rs"] + 1j * sweeps["X"] for sweeps in (seen[0], exact))
    session = (measured / true).values
    np.testing.assert_allclose(session, np.broadcast_to(session[0, 0, 0], session.shape), rtol=3e-5)


def test_half_the_noise_doubles_the_separation_and_asks_for_no_further_solve(run_study):
    found, *_ = run_study(
        "sheet-4x4",
        "readout.magnitude_noise=2e-3,1e-3",
        "readout.phase_noise=2e-3,1e-3",
        cross_validate=never_asked,
    )
    small, large = (found.isel(dict.fromkeys(found.sizes, index)) for index in (0, 1))
    for name in ("least_separation", "median_separation", "band_separation"):
        assert float(small[name]) == pytest.approx(2 * float(large[name]), rel=1e-9)
    alone, *_ = run_study("sheet-4x4", "readout.magnitude_noise=1e-3", cross_validate=never_asked)
    assert found.attrs["solves"] == alone.attrs["solves"] > 0


def test_more_pixels_are_harder_to_tell_apart(run_study):
    found, *_ = run_study("sheet-5x5", "pixels=2:5")
    assert (np.diff(found["accuracy"]) <= 0.01).all()
    assert found["accuracy"][0] == 1 and found["accuracy"][-1] < 0.97
    for name in ("least_separation", "median_separation"):
        assert (np.diff(found[name]) < 0).all()


def test_resistance_moves_the_best_band_down_and_far_above_cut_off_not_the_separation(run_study):
    """At tenfold resistance all happens at a tenth of the frequency, at tenfold impedance."""
    found, *_ = run_study("strip-1x4", "skin.sheet_resistance=1e5,1e6", cross_validate=never_asked)
    assert found["band_stop"][0] >= found["band_stop"][1]


@pytest.mark.parametrize("target", ["row", "pixel"])
def test_rows_and_pixels_can_be_told_too(run_study, target):
    """Floating foils at the bottom break the mirror symmetry of rows."""
    for name, apart in (("sheet-5x5", False), ("sheet-5x5-two-interfaces", True)):
        found, *_ = run_study(name, "pixels=2", target=target, draws=1)
        assert (found["least_separation"] > 1) == apart
        assert (found["accuracy"] > 0.9) == apart


def test_any_number_of_workers_finds_the_same(run_study):
    axes = ("press.factor_spread=0,0.2", "pixels.columns=2:3")
    one, *_ = run_study("strip-1x3", *axes, workers=1)
    two, *_ = run_study("strip-1x3", *axes, workers=2)
    assert one.identical(two)


def test_answers_name_the_best_and_what_is_as_good(run_study):
    found, _, axes = run_study(
        "strip-1x3", "skin.sheet_resistance=1e3,1e4,1e5", "pixels.columns=2:3"
    )
    found["accuracy"][:] = [[0.4, 0.5], [0.9, 0.86], [0.2, 0.9]]
    assert answers(found, axes) == [
        "pixels.columns = 2: best accuracy 90 % at 10 kohm/sq",
        "pixels.columns = 3: best accuracy 90 % at 100 kohm/sq, where the range ends "
        "(85 % or more from 10 kohm/sq to 100 kohm/sq)",
    ]


def test_rest_is_a_class_where_the_experiment_has_it():
    scene, *_ = scenes_of(
        table := scene_table("strip-1x3"), parse_axes(["pixels.rows=1"], table), Trial()
    )
    assert Trial().nominal(scene)[0] == Press()
    assert (0, 0) in Trial().factors(scene)

"""A study's table: what it holds is what solving and scoring_splits every point by itself gives."""

import numpy as np
import pytest
import rcskin
from rcskin.localization.model.training import train
from rcskin.localization.study.axis import parse_axes, scene_table
from rcskin.localization.study.execution import points_of, study
from rcskin.localization.study.point import EvaluationSettings
from rcskin.localization.study.report import answers
from rcskin.simulator.press.press import Press
from rcskin.simulator.progress import silent


@pytest.fixture(scope="module")
def run_study():
    """Runs a study of a built-in scene over axes in their syntax; gives findings, scenes, axes."""

    def run_study(name, *vary, draws=1, target="column", repeated=True, **more):
        trial = EvaluationSettings(target, draws, repeated)
        table = scene_table(name)
        axes = parse_axes(vary, table)
        points = points_of(table, axes, trial)
        found = study(points, axes, trial, silent, **more)
        return found, [point.scene for point in points], axes

    return run_study


def test_a_point_is_a_data_set_of_its_scene_as_train_is_judged_by_it(run_study):
    """Of presses as strong as the scene says, on the skins that a data set draws."""
    found, (scene,), _ = run_study("sheet-4x4", "skin.foam.loss_tangent=0.01", repeated=False)
    own = {"distribution": "normal", "mean": 2.0, "deviation": 0.1}
    judged = train(rcskin.dataset(scene.with_({"dataset.press.factor": own}), 2000, seed=1))
    assert judged.learned.held_out > 1400 and "4 folds, whole sessions" in judged.validation
    accuracy = judged.learned.right / judged.learned.held_out
    assert float(found["accuracy"][0]) == pytest.approx(accuracy, abs=0.005)
    assert accuracy <= sum(rcskin.limits(scene, draws=500, against_rest=3))


def test_the_sweeps_given_to_the_localizer_are_of_several_skins_and_of_its_own_presses(
    run_study, monkeypatch
):
    seen = []

    def look(sweeps, *_):
        seen.append(sweeps)
        return [1.0]

    monkeypatch.setattr("rcskin.localization.study.point.held_out_accuracies", look)
    run_study("strip-1x3", "press.capacitance_factor=1.5,3", draws=2, repeated=False)
    for factor, draw in zip((1.5, 1.5, 3, 3), seen, strict=True):
        assert draw.sizes["sweep"] == 2000 and np.unique(draw["session"]).size == 4
        single = draw["touches"].values == 1
        assert np.median(draw["touch_factor"].values[single, 0]) == pytest.approx(factor, rel=0.01)
    assert not np.array_equal(seen[0]["Cp"], seen[1]["Cp"])


def test_presses_of_a_data_set_that_are_stated_are_taken():
    table = scene_table("strip-1x3")
    table["dataset"]["press"]["factor"] = {"distribution": "fixed", "value": 2.5}
    (point,) = points_of(table, parse_axes(["pixels.rows=1"], table), EvaluationSettings())
    assert EvaluationSettings().plan(point, 0, 1e-4).parts.plan.draws.press.factor.low == 2.5


@pytest.mark.usefixtures("unlearned")
def test_half_the_noise_doubles_the_separation(run_study):
    found, *_ = run_study(
        "sheet-4x4",
        "readout.magnitude_noise=2e-3,1e-3",
        "readout.phase_noise=2e-3,1e-3",
    )
    small, large = (found.isel(dict.fromkeys(found.sizes, index)) for index in (0, 1))
    for name in ("least_separation", "median_separation", "band_separation"):
        assert float(small[name]) == pytest.approx(2 * float(large[name]), rel=1e-9)


def test_more_pixels_are_harder_to_distinguish(run_study):
    found, *_ = run_study("sheet-5x5", "pixels=2,6", repeated=False)
    assert (np.diff(found["accuracy"]) <= 0.01).all()
    assert found["accuracy"][0] == 1 and found["accuracy"][-1] < 0.97
    for name in ("least_separation", "median_separation"):
        assert (np.diff(found[name]) < 0).all()


@pytest.mark.usefixtures("unlearned")
def test_resistance_moves_the_best_band_down_and_far_above_cut_off_not_the_separation(run_study):
    """At tenfold resistance all happens at a tenth of the frequency, at tenfold impedance."""
    found, *_ = run_study("strip-1x4", "skin.sheet_resistance=1e5,1e6")
    assert found["band_stop"][0] >= found["band_stop"][1]


@pytest.mark.usefixtures("short_studies")
@pytest.mark.parametrize("target", ["row", "pixel"])
def test_rows_and_pixels_can_be_found_too(run_study, target):
    """Floating foils at the bottom break the mirror symmetry of rows."""
    for name, apart in (("sheet-5x5", False), ("sheet-5x5-two-interfaces", True)):
        found, *_ = run_study(name, "pixels=2", target=target, draws=1, rtol=1e-2)
        assert (found["least_separation"] > 1) == apart
        assert (found["accuracy"] > 0.9) == apart


@pytest.mark.usefixtures("unlearned")
def test_answers_name_the_best_and_what_is_as_good(run_study):
    found, _, axes = run_study(
        "strip-1x3", "skin.sheet_resistance=1e3,1e4,1e5", "pixels.columns=2:3", rtol=1e-2
    )
    found["accuracy"][:] = [[0.4, 0.5], [0.9, 0.86], [0.2, 0.9]]
    assert answers(found, axes) == [
        "pixels.columns = 2: best accuracy 90 % at 10 kohm/sq",
        "pixels.columns = 3: best accuracy 90 % at 100 kohm/sq, where the range ends "
        "(85 % or more from 10 kohm/sq to 100 kohm/sq)",
    ]


def test_rest_is_a_class_where_the_experiment_has_it():
    point, *_ = points_of(
        table := scene_table("strip-1x3"),
        parse_axes(["pixels.rows=1"], table),
        EvaluationSettings(),
    )
    assert EvaluationSettings().nominal(point.skin, point.plan)[0] == Press()


def test_few_presses_do_not_make_the_unpressed_skin_count_more(run_study):
    """Sheets without resistance: the unpressed skin is found, pressed columns are guessed."""
    vary = ("skin.sheet_resistance=1", "experiment.repetitions=40")
    found, _, _ = run_study("strip-1x3", *vary)
    guessed = 0.1 / 0.8 + 0.7 / 0.8 / 3
    assert float(found["accuracy"].item()) == pytest.approx(guessed, abs=0.07)


def test_the_amount_of_data_is_stated_as_it_is_drawn():
    scene = rcskin.load("strip-1x3")
    whole, repeated = EvaluationSettings(draws=3), EvaluationSettings(repeated=True)
    assert whole.presses(scene.parts.plan) == "3 draws of 2000 sweeps"
    assert whole.plan(scene.parts, 0, 1e-4).sweeps == 2000
    assert (
        repeated.presses(scene.parts.plan)
        == f"{scene.experiment.repetitions} presses of each pixel"
    )

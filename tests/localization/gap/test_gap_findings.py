"""What is found of a known shift, and how missing pieces degrade."""

from dataclasses import replace

import numpy as np
import pytest
from rcskin.localization.gap.options import GapOptions
from rcskin.localization.gap.report.sentences import accuracy_rows
from rcskin.localization.learners.registry import learners
from rcskin.simulator.sweeps import InputError


def reached(findings, stage, features="relative", k=0):
    return findings.stages[stage].transfer[features][k].mean


def test_a_known_shift_is_named_and_calibration_undoes_it(findings):
    """The twin's resistance is 20 % above the simulation's."""
    assert findings.causes[0].name == "sheet_resistance"
    assert findings.causes[0].removed > 0.9
    sheet = next(each for each in findings.trial.estimates if each.name == "top sheet")
    assert sheet.value == pytest.approx(1.2 * sheet.start, rel=0.01)
    assert reached(findings, "after", "absolute") > reached(findings, "before", "absolute") + 0.2
    before, after = (findings.stages[name] for name in ("before", "after"))
    assert np.abs(after.pressed["Rs"].percent).max() < 0.2 * before.pressed["Rs"].percent.max()
    first, second = (stage.discrepancies["absolute"]["all"] for stage in (before, after))
    assert first.mmd2 > 3 * abs(second.mmd2)
    assert first.p < 0.05 < second.p
    assert first.coefficient > 3 * second.coefficient


def test_touches_of_the_other_side_help_before_calibration(findings):
    accuracies = [reached(findings, "before", "absolute", k) for k in (0, 1, 5)]
    assert accuracies[0] < accuracies[1] <= accuracies[2]


@pytest.mark.usefixtures("uncalibrated")
def test_without_a_gap_nothing_stands_out(make_skin_sweeps, make_findings):
    findings = make_findings(make_skin_sweeps(6), make_skin_sweeps(6, seed=1))
    stage = findings.stages["before"]
    assert min(each.p for each in stage.discrepancies["absolute"].values()) > 0.01
    assert np.abs(stage.rest["Rs"].meter_errors).max() < 3
    assert reached(findings, "before", "absolute") > 0.9


def test_no_tested_sweep_calibrates_or_trains(findings):
    trial = findings.trial
    assert set(trial.splits) == {0, 1, 2, 5}
    for splits in trial.splits.values():
        for added, tested in splits:
            assert not trial.reserved[tested].any()
            assert not set(added) & set(tested)


def test_the_same_seed_finds_the_same(pair_of_sweeps, make_findings, findings):
    again = make_findings(*pair_of_sweeps)
    for stage, found in findings.stages.items():
        assert again.stages[stage].discrepancies == found.discrepancies
        assert reached(again, stage, k=2) == reached(findings, stage, k=2)


def told(findings, part):
    return any(part in note for note in findings.notes)


@pytest.mark.usefixtures("uncalibrated")
def test_without_the_skin_at_rest_relative_features_are_left_out(make_skin_sweeps, make_findings):
    findings = make_findings(make_skin_sweeps(rest=False), make_skin_sweeps(rest=False, seed=1))
    assert list(findings.own) == ["absolute"]
    assert findings.stages["before"].rest is None
    assert told(findings, "from the unpressed skin: session 0 has no sweep of the unpressed skin")


def test_rest_on_one_side_only_is_no_class(make_skin_sweeps, make_findings):
    findings = make_findings(make_skin_sweeps(rest=False), make_skin_sweeps(seed=1))
    confusion = findings.stages["before"].transfer["absolute"][0].confusion
    assert confusion.labels == (1, 2, 3)
    assert told(findings, "Calibrated on 2 unpressed")


@pytest.mark.usefixtures("uncalibrated")
def test_too_few_sweeps_leave_a_number_of_touches_out(make_skin_sweeps, make_findings):
    findings = make_findings(make_skin_sweeps(), make_skin_sweeps(2, seed=1))
    assert set(findings.trial.splits) == {0, 1}
    assert told(findings, "too few sweeps for k > 1 and a test: k = 2, 5 is left out")


def test_without_a_scene_nothing_is_calibrated_or_explained(make_skin_sweeps, make_findings):
    findings = make_findings(make_skin_sweeps().drop_attrs(), make_skin_sweeps(6).drop_attrs())
    assert list(findings.stages) == ["before"]
    assert findings.causes == ()
    assert (
        findings.trial.reading_deviation is not None
        and "repeatability" in findings.trial.reading_deviation.source
    )
    assert told(findings, "the scene is unknown; give it with --scene")


@pytest.mark.usefixtures("uncalibrated")
def test_sweeps_free_of_noise_are_read_before_they_train(make_skin_sweeps, make_findings):
    findings = make_findings(make_skin_sweeps(noisy=False), make_skin_sweeps(seed=1))
    version = findings.trial.versions["before"]
    assert "readout" not in version.exact.attrs and "readout" in version.read.attrs
    assert told(findings, "have no noise: for training")


@pytest.mark.usefixtures("uncalibrated")
def test_features_that_an_estimator_does_not_take_are_left_out(
    make_skin_sweeps, make_findings, monkeypatch
):
    def check(problem):
        if "Rs" in problem.quantities:
            raise InputError("takes no Rs")

    picky = replace(learners()["ksvm-components"], name="picky", check=check)
    monkeypatch.setattr("rcskin.localization.gap.comparison.chosen", lambda *_: picky)
    findings = make_findings(make_skin_sweeps(), make_skin_sweeps(seed=1), estimator="picky")
    assert list(findings.own) == ["relative"]
    assert told(findings, "There are no results for Rs and Cp: takes no Rs.")
    assert [len(row.cells) for row in accuracy_rows(findings)] == [1] * len(accuracy_rows(findings))


@pytest.mark.usefixtures("uncalibrated")
def test_where_all_would_calibrate_nothing_is_left_to_test(make_skin_sweeps, make_findings):
    with pytest.raises(InputError, match="no sweep is left to test"):
        make_findings(make_skin_sweeps(), make_skin_sweeps(1), touches=6)


@pytest.mark.usefixtures("uncalibrated")
def test_one_class_alone_cannot_be_asked_for(make_skin_sweeps, make_findings):
    strip = make_skin_sweeps(rest=False)
    with pytest.raises(
        InputError, match="`target` row: the simulated sweeps must have 2 classes, got 1"
    ):
        make_findings(strip, strip, target="row")


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"target": "position"}, "`target` must be one of column, row, pixel, got 'position'"),
        ({"draws": 0}, "`draws` must be >= 1, got 0"),
        ({"seed": -1}, "`seed` must be >= 0, got -1"),
        ({"calibration_touches": -1}, "`calibration_touches` must be >= 0, got -1"),
    ],
)
def test_values_out_of_range_are_refused(asked, message):
    with pytest.raises(InputError, match=message):
        GapOptions(**{"target": "column", "estimator": "ksvm-ovo", **asked})


def test_sessions_are_left_out_as_a_whole_and_each_compared_with_its_own_baseline(
    make_skin_sweeps, make_findings
):
    findings = make_findings(make_skin_sweeps(sessions=2), make_skin_sweeps(sessions=2, seed=1))
    assert {found["grouped"].grouping for found in findings.own.values()} == {"session"}
    assert reached(findings, "after") > 0.8
    assert told(findings, "the presses of 2 sessions are then of one skin")
    rest = findings.trial.reserved & (findings.trial.pair.other["row"].values == 0)
    assert set(findings.trial.pair.other["session"].values[rest]) == {0, 1}

"""What is found of a known shift, and how missing pieces degrade.

Distances of distributions against plain loops and closed cases.
"""

from dataclasses import replace

import numpy as np
import pytest
from rcskin.localization.gap.gap_findings import (
    MAX_SAMPLE,
    discrepancy,
    energy_distance,
    kernel,
    permutation_p,
    unbiased_mmd2,
)
from rcskin.localization.gap.gap_report import accuracy_table
from rcskin.localization.gap.options import GapOptions
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
    assert told(findings, "the scene is unknown; give it with `scene`")


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
    assert {len(row) for row in accuracy_table(findings).rows} == {2}


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


def test_a_target_that_is_no_class_is_refused():
    with pytest.raises(InputError, match="`target` must be one of column, row, pixel, got 'posi"):
        GapOptions("position", "ksvm-ovo")


def test_sessions_are_left_out_as_a_whole_and_each_compared_with_its_own_baseline(
    make_skin_sweeps, make_findings
):
    findings = make_findings(make_skin_sweeps(sessions=2), make_skin_sweeps(sessions=2, seed=1))
    assert {found["grouped"].grouping for found in findings.own.values()} == {"session"}
    assert reached(findings, "after") > 0.8
    assert told(findings, "the presses of 2 sessions are then of one skin")
    rest = findings.trial.reserved & (findings.trial.pair.other["row"].values == 0)
    assert set(findings.trial.pair.other["session"].values[rest]) == {0, 1}


def normal(n, features=3, shift=0.0, seed=0):
    return shift + np.random.default_rng(seed).standard_normal((n, features))


def all_distances(X, Y):
    both = np.concatenate([X, Y])
    return np.linalg.norm(both[:, None] - both, axis=-1)


def mmd2_in_loops(X, Y):
    """Gretton et al. (2012), Eq. 3, with the median of all distances as the kernel's width."""
    both = [*X, *Y]
    apart = [np.linalg.norm(a - b) for i, a in enumerate(both) for b in both[:i]]
    width = np.median(apart)

    def k(a, b):
        return np.exp(-np.sum((a - b) ** 2) / (2 * width**2))

    n, m = len(X), len(Y)
    first = sum(k(X[i], X[j]) for i in range(n) for j in range(n) if i != j) / (n * (n - 1))
    second = sum(k(Y[i], Y[j]) for i in range(m) for j in range(m) if i != j) / (m * (m - 1))
    return first + second - 2 * sum(k(x, y) for x in X for y in Y) / (n * m)


def energy_in_loops(X, Y):
    def mean(A, B):
        return sum(np.linalg.norm(a - b) for a in A for b in B) / (len(A) * len(B))

    return 2 * mean(X, Y) - mean(X, X) - mean(Y, Y)


@pytest.mark.parametrize("shift", [0.0, 0.7])
def test_both_distances_are_those_of_plain_loops(shift):
    X, Y = normal(9), normal(7, shift=shift, seed=1)
    distances = all_distances(X, Y)
    assert unbiased_mmd2(kernel(distances), 9) == pytest.approx(mmd2_in_loops(X, Y), abs=1e-12)
    assert energy_distance(distances, 9)[0] == pytest.approx(energy_in_loops(X, Y), abs=1e-12)


def test_the_energy_distance_of_a_sample_to_itself_is_none():
    X = normal(12)
    assert energy_distance(all_distances(X, X), 12) == (0.0, 0.0)


def test_two_points_are_apart_by_twice_their_distance_and_never_touch():
    X, Y = np.zeros((4, 2)), np.full((6, 2), [3.0, 4.0])
    assert energy_distance(all_distances(X, Y), 4) == (pytest.approx(10.0), pytest.approx(1.0))


def test_samples_that_are_all_the_same_are_not_apart():
    found = discrepancy(np.ones((4, 2)), np.ones((5, 2)), np.random.default_rng(0))
    assert (found.mmd2, found.energy, found.coefficient, found.p) == (0.0, 0.0, 0.0, 1.0)


def test_the_unbiased_discrepancy_of_one_distribution_is_none_on_average():
    found = [
        unbiased_mmd2(kernel(all_distances(normal(10, seed=s), normal(10, seed=500 + s))), 10)
        for s in range(200)
    ]
    deviation = np.std(found) / np.sqrt(len(found))
    assert abs(np.mean(found)) < 3 * deviation
    assert min(found) < 0 < max(found)


def test_chances_of_one_distribution_are_even_and_of_a_shifted_one_small():
    random = np.random.default_rng(3)
    same = [
        permutation_p(kernel(all_distances(normal(12, seed=s), normal(9, seed=90 + s))), 12, random)
        for s in range(60)
    ]
    assert 0.35 < np.mean(same) < 0.65
    assert np.mean(np.array(same) < 0.05) < 0.15
    shifted = all_distances(normal(12), normal(9, shift=1.5, seed=1))
    assert permutation_p(kernel(shifted), 12, random) < 0.01


def test_the_energy_coefficient_does_not_depend_on_the_unit():
    X, Y = normal(8), normal(8, shift=1.0, seed=1)
    small, large = (energy_distance(all_distances(u * X, u * Y), 8) for u in (1e-12, 1e6))
    assert small[1] == pytest.approx(large[1])
    assert large[0] == pytest.approx(1e18 * small[0])


def test_of_many_sweeps_some_are_drawn_and_one_alone_shows_nothing():
    random = np.random.default_rng(0)
    found = discrepancy(normal(MAX_SAMPLE + 20, 1), normal(5, 1, seed=1), random)
    assert (found.first, found.second) == (MAX_SAMPLE, 5)
    assert discrepancy(normal(1), normal(5), random) is None

from dataclasses import replace

import numpy as np
import pytest
from rcskin.localization.evaluation.evaluation import ClassScore, PositionScore, cross_validate
from rcskin.localization.inputs.targets import labels
from rcskin.localization.trust.answers import CANNOT_TELL, Answers
from rcskin.localization.trust.folds import folds_of
from rcskin.simulator.sweeps import InputError


def pixels(sweeps, index):
    return set(zip(sweeps["row"].values[index], sweeps["column"].values[index], strict=True))


def folds(sweeps, **kwargs):
    return folds_of(sweeps, labels(sweeps), **{"folds": 3, "grouping": None, "seed": 0, **kwargs})


@pytest.mark.parametrize("grouping", [None, "press"])
@pytest.mark.parametrize("target", ["column", "row"])
def test_every_sweep_is_counted_once_under_its_own_class(sheet, grouping, target):
    confusion = cross_validate(sheet, target, folds=3, grouping=grouping, quantities="Rs,Cp")
    classes, sizes = np.unique(labels(sheet, target), return_counts=True)
    assert confusion.labels == tuple(classes)
    np.testing.assert_array_equal(confusion.counts.sum(axis=1), sizes)


def test_a_strip_of_three_pixels_and_no_press_are_distinguished(strip):
    assert cross_validate(strip).accuracy == 1.0


def test_sweeps_before_the_first_of_the_unpressed_skin_are_left_out_where_it_is_needed(sheet):
    by_default, as_read = cross_validate(sheet), cross_validate(sheet, quantities="Rs,Cp")
    assert by_default.total == as_read.total - 2
    by_changes = cross_validate(sheet, quantities=("dlnZ", "dphase"))
    np.testing.assert_array_equal(by_default.counts, by_changes.counts)


def test_columns_near_the_contact_are_distinguished_best(make_sweeps):
    counts = cross_validate(make_sweeps(4, 6, noise=0.01)).counts
    recall = counts.diagonal() / counts.sum(axis=1)
    assert recall[0] == 1.0
    assert min(recall[1], recall[2]) > max(recall[5], recall[6])


def test_noise_costs_accuracy(make_sweeps):
    quiet, noisy = (cross_validate(make_sweeps(1, 5, noise=noise)) for noise in (0.003, 0.1))
    assert quiet.accuracy > noisy.accuracy


@pytest.mark.parametrize("grouping", [None, "press", "session"])
def test_the_same_seed_gives_the_same_folds_and_another_seed_others(make_sweeps, grouping):
    sweeps = make_sweeps(4, 4).assign_coords(session=("sweep", np.arange(102) % 6))
    first, again, other = (folds(sweeps, grouping=grouping, seed=seed) for seed in (5, 5, 6))
    tests = [[test.tolist() for _, test in splits] for splits in (first, again, other)]
    assert tests[0] == tests[1] != tests[2]


def test_the_same_seed_gives_the_same_confusion(make_sweeps):
    sweeps = make_sweeps(3, 5, noise=0.01)
    first, again = (cross_validate(sweeps, grouping="press", folds=3, seed=7) for _ in range(2))
    np.testing.assert_array_equal(first.counts, again.counts)


def test_no_pressed_pixel_is_on_both_sides_when_grouped_by_press(sheet):
    for train, test in folds(sheet, grouping="press"):
        assert pixels(sheet, train) & pixels(sheet, test) == {(0, 0)}
        assert (labels(sheet)[test] == 0).sum() == 12 / 3


def test_no_session_is_on_both_sides_when_grouped_by_session(sheet):
    session = sheet["session"].values
    for train, test in folds(sheet, grouping="session", folds=2):
        assert not set(session[train]) & set(session[test])


def test_a_classifier_that_remembers_pixels_passes_only_where_pixels_are_repeated(make_sweeps):
    """Six places along a line, named columns 1, 2, 3, 1, 2, 3: a place tells not of the other."""
    places = make_sweeps(
        1, 6, unpressed=False, noise=1e-4, spread=0.02, interfaces=("left", "right")
    )
    row, column = np.divmod(places["column"].values - 1, 3)
    dealt = places.assign_coords(row=("sweep", row + 1), column=("sweep", column + 1))
    assert cross_validate(dealt).accuracy > 0.9
    assert cross_validate(dealt, grouping="press", folds=2).accuracy < 0.5


@pytest.mark.parametrize(("grouping", "target"), [("press", "pixel"), ("press", "row")])
def test_a_class_of_one_pixel_cannot_be_grouped_by_press(make_sweeps, grouping, target):
    sweeps = make_sweeps(2, 1)
    with pytest.raises(InputError, match="grouping by press leaves a training without class"):
        cross_validate(sweeps, target, folds=2, grouping=grouping)


def test_a_strip_cannot_be_grouped_by_press(strip):
    with pytest.raises(InputError, match="without class [123]: it needs more than one press"):
        cross_validate(strip, grouping="press")


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"folds": 7}, "`folds` must be from 2 to the 5 sweeps of class 0, got 7"),
        ({"folds": 1}, "`folds` must be from 2 to the 5 sweeps of class 0, got 1"),
        ({"grouping": "session"}, "`folds` must be at most the number of groups, 1, got 5"),
        ({"grouping": "day"}, "must be none, press or session, got 'day'"),
    ],
)
def test_what_cannot_be_done_is_refused(strip, asked, message):
    with pytest.raises(InputError, match=message):
        cross_validate(strip, **asked)


def test_one_class_alone_is_refused(strip):
    with pytest.raises(InputError, match="at least 2 classes, got 1"):
        cross_validate(strip.isel(sweep=strip["column"] == 2))


def test_a_refusal_is_no_right_answer():
    labels = np.array(["1", CANNOT_TELL, "2", CANNOT_TELL])
    answers = Answers(labels, np.full(4, 0.9), labels == CANNOT_TELL, np.zeros((4, 0)))
    truth, sessions = np.array([1, 2, 1, 2]), np.zeros(4, dtype=np.int64)
    found = ClassScore(truth, np.array([1, 2, 2, 1]), answers, sessions, unread=1)
    shares = {"right of all": 1 / 5, "answered": 2 / 5, "right of those answered": 1 / 2}
    assert found.figures() | shares == found.figures()
    assert {name: rate.share for name, rate in found.rates().items()} == shares
    assert {rate.independent for rate in found.rates().values()} == {None}
    assert found.confusion.outputs == (1, 2, CANNOT_TELL)
    assert found.confusion.counts.tolist() == [[1, 1, 0], [0, 0, 2]]


def test_a_position_that_is_refused_has_no_error():
    truth, away = np.tile([10.0, 10.0, 2.0], (4, 1)), np.array([3.0, 1.0, 2.0, 90.0])
    predicted, deviation = truth + away[:, None] * [1.0, 0.0, 0.0], np.ones((4, 3))
    content, sessions = np.array([0.99, 0.2, 0.3, 1.0]), np.zeros(4, dtype=np.int64)
    answered = np.array([True, True, True, False])
    given = truth, predicted, deviation, content, sessions
    score = PositionScore(*given, answered[::-1], {2: "second", 0: "none"}, unread=1)
    assert score.of_answered.examples == {1: "second"}
    found = replace(score, answered=answered).figures()
    assert found["answered"] == 3 / 5 and found["median error, mm"] == 2.0
    assert found["touches within 95 % regions"] == 2 / 3
    assert PositionScore(*given, answered & False, {}).figures() == {"answered": 0.0}

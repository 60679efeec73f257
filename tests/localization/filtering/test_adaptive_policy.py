"""Readings chosen over two interfaces and for places, on skins of closed form."""

import runpy
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from rcskin.localization.filtering.adaptive import AdaptivePolicy
from rcskin.localization.filtering.cell_grid import cell_grid_of
from rcskin.localization.filtering.follower import Follower
from rcskin.localization.inversion.classifier import InversionPlan, ModelBased
from rcskin.localization.inversion.position import ModelBasedPosition
from rcskin.localization.trust.answers import CANNOT_TELL
from rcskin.localization.trust.fitted import Classifier, Regressor
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import InputError, build

_places = runpy.run_path(str(Path(__file__).parents[1] / "inversion" / "test_position.py"))
ROWS, COLUMNS, READINGS = 2, 3, 6
INTERFACES, FREQUENCIES = ("left", "bottom"), (1e3, 4e3, 16e3)
NOISE, STRENGTHS = 0.003, np.linspace(1.8, 2.2, 3)
ABOUT_REST = 1e4 - 1e4j
TURN = np.array([[0.0], [1.0]])
"""s of a turn from left to bottom, where a reading takes 0.02 s."""
SCENE = load_scene("sheet-5x5").with_({"pixels.rows": ROWS, "pixels.columns": COLUMNS})


def change(row, column, strength):
    """The left shows the column, the bottom the row: ln |Z| of all readings, then phases."""
    size = (strength - 1) * np.repeat([0.1 * column, 0.15 * row], 3)
    return np.concatenate([size, size / 2])


def builder(scene, target, presses):
    pixels = np.stack(np.divmod(np.arange(ROWS * COLUMNS), COLUMNS), axis=1) + 1
    single = np.array([[change(*pixel, f) for f in STRENGTHS] for pixel in pixels])
    return {
        "deviation": np.full(2 * READINGS, NOISE),
        "chances": np.array([0.2, 0.8, 0.0]),
        "strengths": STRENGTHS,
        "weights": np.full(3, 1 / 3),
        "spread": np.array(0.1),
        "pixels": pixels,
        "single": single,
        "shift": np.zeros_like(single),
        "slope": np.gradient(single, STRENGTHS, axis=1),
        "skin": np.zeros((*single.shape, 1)),
    }


def model_of(step, learned, target, knows_unpressed=True):
    """What of a trained model is asked for."""
    return SimpleNamespace(
        predictor=step,
        learned=learned,
        target=target,
        estimator="model-based",
        interfaces=INTERFACES,
        frequencies=FREQUENCIES,
        classes=tuple(step.classes.tolist()) if target != "position" else (),
        knows_unpressed=knows_unpressed,
        problem=SimpleNamespace(taken=()),
        known_scene=SCENE,
        gate=None,
    )


def of_classes(target):
    step = ModelBased.fitted(InversionPlan("", target, builder=builder))
    return model_of(step, Classifier(step, None, 1.0, 0.0, 1, 1, 1, None), target)


@pytest.fixture(scope="module")
def placing():
    step = ModelBasedPosition.fitted(InversionPlan("", "position", builder=_places["builder"]))
    return model_of(step, Regressor(step, None, np.ones(3), None, 1.0), "position")


@pytest.fixture(scope="module")
def rest():
    Z = np.full((3, 2, 3), ABOUT_REST)
    none = {"press": ["none"] * 3, "row": [0] * 3, "column": [0] * 3}
    return build(Z, FREQUENCIES, interface=list(INTERFACES), **none).dataset()


def asked(model, rest, x, turn=0.0 * TURN, follower=None, **how):
    """Where it was read, and the answer. x: changes from rest."""
    questions = AdaptivePolicy(model, follower=follower, **how).begin(rest, 0.0)
    here, read = "left", []
    while True:
        away = np.array([[name != here] for name in INTERFACES])
        wanted = questions.next(0.02 + np.where(away, turn.max(), 0.0) + np.zeros((2, 3)))
        if wanted is None:
            return read, questions.answer(0.1)
        here, frequency = wanted
        k = 3 * INTERFACES.index(here) + FREQUENCIES.index(frequency)
        read.append(here)
        questions.add_reading(here, frequency, ABOUT_REST * np.exp(x[k] + 1j * x[k + READINGS]))


def turns(read):
    return sum(one != other for one, other in zip(["left", *read], read, strict=False))


def noisy(x, seed=0):
    return x + NOISE * np.random.default_rng(seed).standard_normal(x.size)


@pytest.mark.parametrize("pixel", [(1, 1), (2, 3), (1, 2)])
def test_a_pixel_is_found_from_some_readings_at_both_interfaces(rest, pixel):
    read, told = asked(of_classes("pixel"), rest, noisy(change(*pixel, 2.0)))
    assert told.label == "{},{}".format(*pixel) and told.probability >= 0.95
    assert set(read) == set(INTERFACES) and len(read) < 2 * len(FREQUENCIES)


def test_a_switch_that_takes_long_turns_once_and_only_where_it_must(rest):
    x = noisy(change(2, 3, 2.0))
    read, told = asked(of_classes("pixel"), rest, x, TURN)
    assert (told.label, turns(read)) == ("2,3", 1)
    read, told = asked(of_classes("column"), rest, x, TURN)
    assert (told.label, set(read)) == ("3", {"left"})


def test_places_are_read_for_until_their_region_is_small(placing, rest):
    X, theta = _places["touches"](6, 1)
    counts = {}
    for within in (30.0, 8.0, 1.0):
        found = [asked(placing, rest, x, within=within) for x in X]
        counts[within] = sum(len(read) for read, _ in found)
        off = [
            np.hypot(t.coordinates[0] - x, t.coordinates[1] - y)
            for (_, t), (x, y, _) in zip(found, theta, strict=True)
        ]
        assert all(t.label == "1" and t.region.covers(*t.coordinates[:2]) for _, t in found)
        assert np.median(off) < max(within, 10.0)
    assert counts[30.0] < counts[8.0] <= counts[1.0] == 6 * len(X)


def test_nothing_and_what_is_no_touch_are_answered_where_positions_are_requested(placing, rest):
    read, told = asked(placing, rest, noisy(np.zeros(2 * READINGS)))
    assert told.label == "0" and told.coordinates == ()
    X, _ = _places["touches"](1, 4)
    unlike = X[0] + 0.05 * (-1.0) ** np.arange(2 * READINGS)
    read, told = asked(placing, rest, unlike, within=1.0)
    assert (len(read), told.label) == (2 * len(FREQUENCIES), CANNOT_TELL)


def test_a_belief_in_a_place_saves_readings_there(placing, rest):
    X, theta = _places["touches"](1, 7)
    follower = Follower(placing)
    counts = []
    for _ in range(4):
        read, told = asked(placing, rest, X[0], follower=follower, within=12.0)
        counts.append(len(read))
    assert told.label == "1" and told.probability > 0.95
    assert np.hypot(*(np.array(told.coordinates[:2]) - theta[0, :2])) < 12
    assert counts[-1] <= counts[0]
    assert cell_grid_of(placing).cell == pytest.approx((7.5 * 0.105 / 0.12, 7.5 * 0.105 / 0.12))


def test_what_cannot_be_asked_is_bad_input(placing):
    with pytest.raises(InputError, match="`within` must be above 0 mm, got -1"):
        AdaptivePolicy(placing, within=-1.0)
    with pytest.raises(InputError, match="`certain` must be between 0 and 1, got 1"):
        AdaptivePolicy(placing, 1.0)

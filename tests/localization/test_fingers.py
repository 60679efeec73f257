"""Localizers of skins that fingers and rods press: the finger must not be needed."""

import numpy as np
import pytest
from rcskin.localization.model.training import train
from rcskin.simulator.dataset.dataset_plan import DatasetPlan
from rcskin.simulator.dataset.drawn_presses import drawn_presses
from rcskin.simulator.dataset.memory_dataset import in_memory
from rcskin.simulator.dataset.skin_model import nominal_skin, reduced
from rcskin.simulator.inversion.touch_templates import templates
from rcskin.simulator.measure.skins import PRESSES, stream
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import InputError

RIM = {"mutual": 5.4e-12, "top": 5.5e-12, "bottom": 5.5e-12}
FINGERS = load_scene("sheet-3x3").with_(
    {
        "surroundings": {"rim": RIM, "body": {"distance": 1e-2}},
        "sweep.frequencies": [1e3, 4e3, 2e4, 1e5],
        "dataset.press.touches": [0.1, 0.9],
        "dataset.press.factor": {"low": 1.7, "high": 2.6},
        "dataset.press.finger": {"low": 0.0, "high": 1e-11},
        "dataset.press.without_press": 0.1,
        "dataset.session.body": {"low": 0.8, "high": 1.25},
        "dataset.session.rest_every": 5,
        "dataset.session.sweeps_per_session": 30,
    }
)
RTOL, SWEEPS = 1e-3, 600
ROD, FINGER = {"dataset.press.finger": 0.0}, {"dataset.press.finger": 5.3e-12}
PRESSED = {"dataset.press.without_press": None}


@pytest.fixture(scope="module")
def family():
    return reduced(FINGERS.parts, RTOL)


def sweeps(family, changes, count, seed):
    return in_memory(DatasetPlan(FINGERS.with_(changes).parts, count, seed, RTOL), family)


@pytest.mark.parametrize(
    "estimator", ["ksvm-ovo", pytest.param("model-based", marks=pytest.mark.slow)]
)
def test_columns_are_found_of_presses_by_a_finger_and_by_a_rod(family, estimator):
    features = ["dlnZ", "dphase"]
    model = train(sweeps(family, {}, SWEEPS, 1), "column", estimator, quantities=features)
    for changes in (ROD | PRESSED, FINGER | PRESSED):
        asked = sweeps(family, changes, 240, 2)
        pressed = np.flatnonzero(asked["row"].values > 0)
        told = model.answers(asked).labels[pressed]
        right = told == asked["column"].values[pressed].astype(str)
        assert right.mean() > 0.95, changes


def test_the_pixel_is_named_alike_with_and_without_a_finger(family):
    rod, finger = (sweeps(family, changes | PRESSED, 60, 3) for changes in (ROD, FINGER))
    for name in ("row", "column", "touches", "touch_x"):
        np.testing.assert_array_equal(rod[name], finger[name])
    assert rod["touch_finger"].max() == 0
    assert finger["touch_finger"].max() == pytest.approx(5.3e-12)
    assert not any("F" in text for text in rod["press"].values)
    assert sum(text.endswith("5.3e-12F") for text in finger["press"].values) > 30


def test_sweeps_are_those_of_what_their_texts_say(family):
    presses = drawn_presses(FINGERS.parts, stream(1, 0, PRESSES), 6, family.grid)
    Z = nominal_skin(FINGERS.parts.skin, family).sweeps(presses.batch)
    solver = Solver(FINGERS.parts, RTOL / 3)
    exact = np.stack([solver.solve(parse_press(text, np.nan)).Z for text in presses.text])
    np.testing.assert_allclose(FINGERS.leads.at_meter(Z, FINGERS.frequencies), exact, rtol=RTOL)


@pytest.mark.slow
def test_tables_hold_every_finger_that_may_touch():
    tables = templates(FINGERS.parts, "pixel")
    places, ways, numbers = tables["single"].shape
    assert (places, ways) == (9, 6 * 6 + 6) and tables["weights"].sum() == pytest.approx(1)
    assert tables["weights"][36:].sum() == pytest.approx(0.1)
    assert not tables["slope"][:, 36:].any() and tables["slope"][:, :36].any()
    finger = tables["skin"][..., -1].reshape(9, -1, numbers)[:, :6]
    step = tables["single"][:, 1:6] - tables["single"][:, :5]
    between = (finger[:, 1:] + finger[:, :-1]) / 2 / 0.5
    np.testing.assert_allclose(step, between, atol=2e-3 * np.abs(step).max())


@pytest.mark.parametrize("target", ["position", "pair", "touches"])
def test_fingers_that_tables_do_not_cover_are_refused(target):
    with pytest.raises(InputError, match="cannot take `(dataset.)?press.finger`: it is for a rod"):
        templates(FINGERS.parts, target)

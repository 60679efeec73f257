"""Inversion of the simulator where the reader reads magnitudes of gains at both ends of a yarn."""

import numpy as np
import pytest
from rcskin.localization.inversion.adapted import AdaptedClassifier
from rcskin.localization.inversion.classifier import InversionPlan, ModelBased
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import press_on
from rcskin.simulator.scene.scene_files import load_scene, scene_text


@pytest.fixture(scope="module")
def yarn():
    """The knitted pad with 9 keys, read at six frequencies."""
    some = {"pixels.columns": 9, "sweep.frequencies": np.geomspace(2e3, 25e3, 6).tolist()}
    return load_scene("knit-36").with_(some)


def test_the_key_of_a_touch_follows_from_magnitudes_at_both_ends(yarn):
    def logarithms(text):
        return np.log(
            np.abs(Solver(yarn.parts).solve(press_on(yarn.parts.skin, yarn.press, text)).Z)
        ).ravel()

    untouched = logarithms("none")
    changes = [logarithms(f"1,{key}:{20 + 2 * key}pF") - untouched for key in range(1, 10)]
    plan = InversionPlan(scene_text(yarn), "column")
    model = ModelBased.fitted(plan)
    assert model.features == untouched.size
    np.testing.assert_array_equal(model.predict(np.array(changes)), range(1, 10))
    curve = np.tile(untouched, (9, 1))
    X = np.column_stack([changes, curve])
    adapted = AdaptedClassifier.fitted(plan)
    np.testing.assert_array_equal(adapted.predict(X), range(1, 10))

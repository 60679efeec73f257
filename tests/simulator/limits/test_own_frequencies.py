"""Limits of scenes whose interfaces have their own frequencies."""

import json

import numpy as np
import pytest
from rcskin.simulator.bounds.field_choice import fields_of
from rcskin.simulator.bounds.position_bound import chosen_touch, place_likelihood, places_on
from rcskin.simulator.limits.survey import SurveyOptions, survey, with_interfaces
from rcskin.simulator.scene.scene_files import load_scene, scene_text

FREQUENCIES = [1e3, 1e4, 1e5]
OWN = {"interface.1.frequencies": [1e3, 1e4], "interface.2.frequencies": [1e4, 1e5]}


@pytest.fixture(scope="module")
def shared():
    readout = {"magnitude_accuracy": 0.01, "magnitude_noise": 0.01, "phase_noise": 0.01}
    changes = {"pixels": 2, "sweep.frequencies": FREQUENCIES, "readout": readout}
    return load_scene("sheet-5x5-two-interfaces").with_(changes)


@pytest.fixture
def written(tmp_path):
    def write(scene):
        path = tmp_path / "own.toml"
        path.write_text(scene_text(scene), encoding="utf-8")
        return path

    return write


def slopes_of(scene, against_rest):
    touch = chosen_touch(scene.parts.skin, scene.press)
    fields = fields_of(scene.parts, scene.frequencies[-1], touch)
    places = places_on(scene.parts.skin, touch, fields.cells, 3)
    return place_likelihood(fields, places, touch, scene.frequencies, against_rest=against_rest)


@pytest.mark.parametrize("against_rest", [0, 4])
def test_bounds_of_one_interface_equal_those_of_a_scene_with_it_alone(shared, against_rest):
    own = shared.with_(OWN)
    alone = with_interfaces(own.parts, ["bottom"])
    assert alone.setup.frequency.tolist() == [1e4, 1e5] and alone.setup.taken is None
    one = slopes_of(own, against_rest).bounds(np.array([1e4, 1e5]), [1])
    taken = np.array([[False, False, False], [False, True, True]])
    other = slopes_of(own, against_rest).bounds(taken=taken)
    by_itself = slopes_of(alone.scene, against_rest).bounds()
    for name in ("x", "y", "strength"):
        np.testing.assert_allclose(getattr(one, name), getattr(by_itself, name), rtol=1e-3)
        np.testing.assert_allclose(getattr(one, name), getattr(other, name), rtol=1e-9)


def test_information_of_readings_adds_up(shared):
    """Against rest no error is shared: left and right of a mask are what the whole is made of."""
    slopes = slopes_of(shared, 4)
    taken = np.array(shared.with_(OWN).parts.setup.taken)
    by = slopes.readings.by
    information = np.einsum("cifqa,cifqb->cifab", by, by)[:, taken].sum(axis=1)
    expected = np.sqrt(np.linalg.inv(information)[:, 2, 2])
    np.testing.assert_allclose(slopes.bounds(taken=taken).strength, expected, rtol=1e-6)
    assert (slopes.bounds().strength < expected).all()


def test_a_survey_has_the_scenes_own_frequencies_and_common_sets(shared):
    own = shared.with_(OWN)
    question = SurveyOptions(chosen_touch(own.parts.skin, own.press), against_rest=4)
    part, whole = (survey(scene.parts, question, [3e4]) for scene in (own, shared))
    named = [{each.name: each.bounds for each in variants} for variants in (part, whole)]
    for name in set(named[0]) & set(named[1]) - {"left", "bottom", "all together", "30 kohm/sq"}:
        np.testing.assert_array_equal(named[0][name].strength, named[1][name].strength)
    assert (named[0]["the scene's own"].strength).min() > 0
    assert (named[0]["the scene's own"].strength > named[1]["the scene's 3"].strength).all()
    assert (named[0]["30 kohm/sq"].strength > named[1]["30 kohm/sq"].strength).all()
    assert next(each for each in part if each.name == "left").frequency.tolist() == [1e3, 1e4]


@pytest.mark.usefixtures("undrawn", "coarse")
def test_all_frequencies_at_an_interface_equal_no_own_frequencies(run, written, shared, tmp_path):
    every = {f"interface.{k}.frequencies": FREQUENCIES for k in (1, 2)}
    outs = []
    for name, scene in (("every", shared.with_(every)), ("none", shared)):
        asked = ("-o", tmp_path / name, "--draws", "50", "-n", "2")
        assert run("limits", written(scene), *asked)[0] == 0
        outs.append([(tmp_path / name / f).read_text() for f in ("limits.json", "limits.csv")])
    assert outs[0] == outs[1]


@pytest.mark.usefixtures("undrawn", "coarse")
def test_limits_of_own_frequencies_are_written(run, written, shared, tmp_path):
    path = written(shared.with_(OWN))
    asked = ("--draws", "50", "-n", "2", "--unknown-skin", "--accuracy", "0.9")
    code, out, err = run("limits", path, "-o", tmp_path / "out", *asked)
    assert (code, err) == (0, "") and "the scene's own" in out and "repeat" not in out
    told = json.loads((tmp_path / "out" / "limits.json").read_text())
    assert told["frequencies_of_each_Hz"] == {"left": [1e3, 1e4], "bottom": [1e4, 1e5]}
    by_name = {(each["comparison"], each["variant"]): each for each in told["position"]}
    assert by_name["interfaces", "bottom"]["frequencies_Hz"] == [1e4, 1e5]


def test_frequencies_are_chosen_for_all_interfaces_or_for_one(run, written, shared):
    path = written(shared.with_(OWN))
    code, out, err = run("frequencies", path, "-n", "2", "--grid", "8")
    assert code == 0 and len(out.split()) == 2 and "times the best" in err
    code, out, _ = run("frequencies", path, "-n", "2", "--grid", "8", "--interface", "bottom")
    assert code == 0 and min(map(float, out.split())) >= 1e4

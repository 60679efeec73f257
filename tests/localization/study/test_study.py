"""A study's table: what it holds is what solving and scoring_splits every point by itself gives.

Distances between classes in units of the meter's error, from first principles. A study that folds
in keys of materials. Studies of what is around a skin: how far a body is, how much a cover or a
finger holds.
"""

import numpy as np
import pytest
import rcskin
from rcskin.localization.model.training import train
from rcskin.localization.study.axis import Axis, find_key, parse_axes, scene_table
from rcskin.localization.study.execution import points_of, study
from rcskin.localization.study.point import EvaluationSettings, families, impedances
from rcskin.localization.study.report import answers
from rcskin.localization.study.separation import (
    class_distances,
    in_units_of_error,
    label_of,
    separation,
)
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press
from rcskin.simulator.progress import silent
from rcskin.simulator.scene.meter import Readout
from rcskin.simulator.scene.scene_files import BUILTIN
from rcskin.simulator.sweeps import InputError


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


FREQUENCY = np.geomspace(1e3, 1e5, 8)
METER = Readout(magnitude_noise=0.01, phase_noise=0.002)


def random_impedance(presses):
    random = np.random.default_rng(1)
    phase = random.uniform(-1.5, -0.1, (presses, 1, len(FREQUENCY)))
    return random.uniform(1e3, 1e4, phase.shape) * np.exp(1j * phase)


def columns(*numbers):
    return [(number,) for number in numbers]


def test_a_known_pair_by_hand():
    """10 % of |Z| at one frequency is ln(1.1) / 0.01 = 9.53 errors, 10 mrad at the other 5."""
    Z = np.array([[[100, 50j]], [[110, 50j * np.exp(-0.01j)]]])
    readings = in_units_of_error(Z, METER, FREQUENCY)
    told = separation(readings, columns(1, 2), FREQUENCY[:2])
    assert told.least == pytest.approx(np.hypot(np.log(1.1) / 0.01, 5.0), rel=1e-9)
    assert told.median == told.least
    assert told.band_separation == pytest.approx(np.log(1.1) / 0.01)
    assert told.band_start == told.band_stop == FREQUENCY[0]


def test_half_the_noise_doubles_every_distance():
    Z, labels = random_impedance(6), columns(1, 1, 2, 2, 3, 3)
    halved = Readout(magnitude_noise=0.005, phase_noise=0.001)
    before, after = (
        separation(in_units_of_error(Z, r, FREQUENCY), labels, FREQUENCY) for r in (METER, halved)
    )
    for name in ("least", "median", "band_separation"):
        assert getattr(after, name) == pytest.approx(2 * getattr(before, name), rel=1e-12)
    assert (after.band_start, after.band_stop) == (before.band_start, before.band_stop)


def test_what_is_fixed_for_a_session_does_not_matter():
    Z, labels = random_impedance(4), columns(1, 2, 3, 4)
    session = 1.02 * np.exp(0.01j)
    plain, measured = (
        class_distances(in_units_of_error(which, METER, FREQUENCY), labels)
        for which in (Z, session * Z)
    )
    np.testing.assert_allclose(plain, measured, rtol=1e-9)


def test_classes_are_as_far_apart_as_their_nearest_presses():
    readings = np.array([0.0, 1.0, 5.0, 7.0, -4.0]).reshape(5, 1, 1)
    told = class_distances(readings, columns(1, 1, 2, 2, 0))
    np.testing.assert_allclose(told, [[0, 4, 9], [4, 0, 4], [9, 4, 0]])


def test_the_best_band_is_where_neighbours_part():
    readings = np.zeros((3, 8, 2))
    readings[0, 5:7], readings[2, 5:7] = -1, 1
    readings[1, 0], readings[2, 0] = 3, 3
    told = separation(readings, columns(1, 2, 3), FREQUENCY)
    assert (told.band_start, told.band_stop) == (FREQUENCY[5], FREQUENCY[6])
    assert told.band_separation == pytest.approx(2)


def test_the_skin_at_rest_is_no_neighbour_but_a_class():
    readings = np.array([0.0, 0.5, 4.0]).reshape(3, 1, 1)
    told = separation(readings, columns(0, 1, 2), FREQUENCY[:1])
    assert (told.least, told.band_separation) == (0.5, 3.5)


def test_a_class_is_a_column_a_row_or_a_pixel():
    assert [label_of((2, 3), target) for target in ("column", "row", "pixel")] == [
        (3,),
        (2,),
        (2, 3),
    ]


@pytest.mark.parametrize("name", ["magnitude_noise", "phase_noise"])
def test_a_meter_without_noise_is_refused(name):
    with pytest.raises(InputError, match=f"`readout.{name}` must be > 0"):
        in_units_of_error(random_impedance(1), METER.model_copy(update={name: 0.0}), FREQUENCY)


def test_a_study_may_stretch_a_skin(tmp_path):
    """Its points are the plain scenes that the stretched ones are."""
    path = tmp_path / "mine.toml"
    sheet = (BUILTIN / "sheet-3x3.toml").read_text()
    path.write_text(f"{sheet}\n[skin.stretch]\nx = 1.0\ny = 1.0\n")
    table = scene_table(str(path))
    axis = Axis(find_key("skin.stretch.x", table), (1.0, 1.25))
    rest, pulled = points_of(table, [axis], EvaluationSettings())
    assert (rest.skin.uniform, pulled.skin.uniform) == (True, True)
    assert rest.skin.sides == (0.12, 0.12)
    assert pulled.skin.sides == (0.15, 0.12)
    assert pulled.skin.top.sheet_resistance == pytest.approx(1.25 * 50e3)


AROUND = {
    "surroundings.body": {"distance": 5e-3},
    "surroundings.cover": {"thickness": 1e-3, "relative_permittivity": 3.0},
    "surroundings.rim": {"mutual": 5e-12, "top": 1e-11, "bottom": 1e-11},
    "press.finger": 5e-12,
    "readout": "IM3523",
}


@pytest.fixture(scope="module")
def touched(make_scene):
    return make_scene(columns=2, frequencies=[1e3, 1e5]).with_(AROUND)


@pytest.mark.parametrize(
    ("key", "unit"),
    [
        ("surroundings.body.distance", "m"),
        ("surroundings.cover.thickness", "m"),
        ("surroundings.rim.top", "F/m"),
        ("press.finger", "F"),
    ],
)
def test_numbers_of_surroundings_are_keys_to_vary(touched, key, unit):
    table = scene_table(touched)
    found = find_key(key, table)
    *_, varied = points_of(
        table, [Axis(found, (1e-3 if unit == "m" else 7e-12,))], EvaluationSettings()
    )
    assert found.unit == unit
    assert varied.scene == touched.with_({key: 1e-3 if unit == "m" else 7e-12})


def test_pixels_are_pressed_by_the_finger_of_the_scene(touched):
    """As the full solver has it, to the tolerance of the reduced model that studies share."""
    nominal, rtol = EvaluationSettings().nominal(touched.parts.skin, touched.parts.plan), 1e-3
    (skins,) = families([touched.parts], EvaluationSettings(), rtol)
    family = skins.at(touched.parts.skin.top.sheet_resistance)
    Z = impedances(touched.parts, nominal, family, rtol)
    solver = Solver(touched.parts, 1e-5)
    exact = np.stack([solver.solve(press).Z for press in nominal])
    assert relative_difference(Z, exact).max() <= rtol


def test_sheets_that_differ_by_one_factor_are_of_one_trained_family(touched):
    """Foils of fixed resistance, which do not scale with the sheets, are as the full solver has
    them."""
    rtol, top, bottom = 1e-3, "skin.top.sheet_resistance", "skin.bottom.sheet_resistance"
    foils = [each.model_copy(update={"resistance": 40.0}) for each in touched.contacts]
    scene = touched.model_copy(update={"contacts": tuple(foils)})
    own, other = touched.skin.top.sheet_resistance, touched.skin.bottom.sheet_resistance
    scaled = [scene.with_({top: f * own, bottom: f * other}) for f in (0.07, 1.0, 13.0)]
    points = [each.parts for each in [*scaled, scene.with_({bottom: 2 * other})]]
    *same, differs = families(points, EvaluationSettings(), rtol)
    assert same == [same[0]] * 3 != [differs] * 3
    for parts, skins in zip(points[:3], same, strict=True):
        nominal = EvaluationSettings().nominal(parts.skin, parts.plan)
        Z = impedances(parts, nominal, skins.at(parts.skin.top.sheet_resistance), rtol)
        solver = Solver(parts, 1e-5)
        exact = np.stack([solver.solve(press).Z for press in nominal])
        assert relative_difference(Z, exact).max() <= rtol

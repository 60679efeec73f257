"""Skins whose pixels are pressed by depth or force: reduced, and all that uses reduced models."""

import numpy as np
import pytest
from rcskin.localization.study.point import EvaluationSettings, impedances
from rcskin.simulator.bounds.position_bound import chosen_touch
from rcskin.simulator.calibration.command import Options
from rcskin.simulator.calibration.run import calibrate
from rcskin.simulator.dataset.dataset_plan import DatasetPlan
from rcskin.simulator.dataset.skin_model import reduced as family_of
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.limits import bayes_accuracy
from rcskin.simulator.measure.experiment import planned_presses
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.measure.specimen import Specimen
from rcskin.simulator.models.mechanics.force_depths import pressed_by_factors
from rcskin.simulator.models.model import GivenPress
from rcskin.simulator.models.parameters import Variation
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import every_press, parse_press, press_on
from rcskin.simulator.press.touch import Depth
from rcskin.simulator.scene.frequency import Loss
from rcskin.simulator.sweeps import InputError

RTOL, CLOSELY = 1e-3, 1e-4
DEEP = Depth(2e-3)


@pytest.fixture(scope="module")
def scene(library):
    return library.scene("by depth")


@pytest.fixture(scope="module")
def reduced(library):
    return library.model("by depth")


def test_the_certificate_holds_on_skins_that_it_was_not_trained_on(reduced):
    """Against the same mesh in full, with pixels of other foam under and beside the applicator."""
    skin = Variation(
        np.array([1.2]), np.array([1.2]), np.ones(2), np.array([[0.7, 1.3, 1.0]]), Loss(0.02)
    )
    own = reduced.at(skin)
    for cells, rises in (([1], [2.8]), ([0, 2], [0.4, 2.2]), ([1, 2], [1.0, 2.0])):
        press = np.array(cells), np.array(rises)
        Z = own.sweep(*press)
        off = relative_difference(Z, own.exact(*press))
        bound = own.certificate(*press)
        assert (off <= bound + 0.03 * RTOL).all()
        assert bound.max() > 1e-6


@pytest.mark.parametrize("cells", [[0], [1], [0, 2], [0, 1]])
def test_applicators_on_pixels_that_meet_are_coupled(reduced, cells):
    assert reduced.family.rises.coupled(np.array(cells)) == (np.diff(cells) == 1).any()


def test_what_is_left_out_between_depths_covers_the_membrane_itself(scene, reduced):
    """c at the mesh's points between Chebyshev's depths, against mechanics far more closely."""
    from rcskin.simulator.models.mechanics.indentation import deformation

    rises = reduced.family.rises
    for depth in (0.21e-3, 1.13e-3, 2.3e-3):
        rise = float(scene.parts.skin.pressed_factors(np.array(depth))) - 1
        (found,) = rises.press(np.array([1]), np.array([rise]))
        truth = deformation(scene.parts.skin, parse_press(f"1,2:{depth!r}m", DEEP), 1e-4)
        x = rises.elements.surface.x[:, found.cells]
        off, weights = np.abs(truth.factor(x) - 1 - found.rise), rises.elements.rule.weights
        area = rises.elements.surface.some(found.cells).area * weights
        assert (off * area).sum() <= (found.uncertainty * area).sum()
        assert (found.uncertainty * area).sum() <= 0.01 * (found.rise * area).sum()


def test_sweeps_by_depth_and_force_are_reduced_where_that_serves(scene):
    solver, full = Solver(scene.parts, RTOL, "reduced"), Solver(scene.parts, CLOSELY)
    for text in ("1,2:1mm", "1,1:2N"):
        press = parse_press(text, DEEP)
        answer, truth = solver.solve(press), full.solve(press)
        assert answer.model.startswith("reduced to")
        off = relative_difference(answer.Z, truth.Z)
        assert (off <= np.stack(answer.relative_errors) + CLOSELY).all()
    for text, reason in (
        ("1,2:2.6mm", "trained on depths up to"),
        ("1,2:9N", "trained on depths up to"),
        ("1,1:1N+1,2:1N", "a touch of given force is too near to another"),
        ("disc(0.045,0.015,0.01):1mm", "the model takes pixels by depth or force only"),
    ):
        _, model = solver._candidates[0]
        given = GivenPress(scene.parts.skin, parse_press(text, DEEP), RTOL)
        with pytest.raises(InputError, match=reason):
            model().solve(given, scene.frequencies, RTOL)
    answer = solver.solve(parse_press("disc(0.045,0.015,0.01):1mm", DEEP))
    assert answer.rejected[0].startswith("reduced: the model takes pixels")


def test_a_calibration_finds_the_sheets_of_a_twin_pressed_by_depth(scene):
    twin = scene.with_({"skin.top.sheet_resistance": 60e3})
    sweeps = simulate(Solver(twin.parts, CLOSELY), every_press(twin.parts.skin, twin.press))
    found = calibrate(scene, sweeps, Options(fit=("sheet_resistance", "capacitance")))
    sheets = (found.scene.skin.top, found.scene.skin.bottom)
    assert sum(each.sheet_resistance for each in sheets) == pytest.approx(100e3, rel=2e-3)
    assert found.scene.press.depth == scene.press.depth
    factor = scene.press.factor(scene.parts.skin)
    assert abs(factor - scene.press.capacitance_factor) > 0.1
    rises = np.concatenate(found.strengths)
    np.testing.assert_allclose(rises, factor - 1, rtol=0.02)


def test_limits_and_studies_press_by_depth(scene, coarse):
    planned = scene.with_({"experiment": {"repetitions": 5}})
    assert 0.6 < bayes_accuracy(planned.parts, "pixel", draws=100, seed=1).share <= 1.0
    assert (
        chosen_touch(planned.parts.skin, planned.press).rise
        == scene.press.factor(scene.parts.skin) - 1
    )
    presses = planned_presses(planned.parts.skin, planned.parts.plan, np.random.default_rng(1))
    assert all(touch.by.unit == "m" for press in presses for touch in press.touches)
    plan = EvaluationSettings(draws=1).plan(planned.parts, 0, RTOL)
    (Z,) = impedances(
        plan.parts,
        [press_on(plan.parts.skin, plan.parts.plan.press, "1,2")],
        family_of(plan.parts, RTOL),
        RTOL,
    )
    off = relative_difference(Z, Solver(scene.parts, CLOSELY).solve(parse_press("1,2", DEEP)).Z)
    assert off.max() <= RTOL


@pytest.mark.parametrize(
    ("changed", "reason"),
    [
        ({"dataset.press.depth": 2.6e-3}, r"`dataset.press.depth` must be <= 0.00241 m"),
        ({"dataset.press.factor": 9.0}, "`dataset.press.factor` must be from 1 to 4"),
        ({"press.depth": None, "dataset.press.depth": 1e-3}, "`dataset.press.depth` needs"),
    ],
)
def test_data_sets_refuse_in_one_line_what_they_cannot_press(scene, changed, reason):
    with pytest.raises(InputError, match=reason):
        DatasetPlan(pressed_by_factors(scene.with_(changed).parts), 10, 1, RTOL)


def test_the_virtual_meter_reads_one_press_at_all_frequencies(scene):
    specimen, press = Specimen(scene.parts, "meter"), "1,2:1mm"
    truth = Solver(scene.parts).solve(parse_press(press, DEEP)).Z[0]
    found = [specimen.impedance(press, float(f)) for f in scene.frequencies]
    np.testing.assert_allclose(found, truth, rtol=1e-9)
    between = specimen.impedance(press, 3e3)
    assert abs(found[1]) < abs(between) < abs(found[0])

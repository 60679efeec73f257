"""Skins whose pixels are pressed by depth or force: reduced, and all that uses reduced models."""

import numpy as np
import pytest
from rcskin.localization.study.point import EvaluationSettings, impedances
from rcskin.simulator.bounds.position_bound import chosen_touch
from rcskin.simulator.calibration.fitting.fit_options import Options
from rcskin.simulator.calibration.run import calibrate
from rcskin.simulator.dataset.dataset_plan import Plan
from rcskin.simulator.dataset.generation import generate
from rcskin.simulator.dataset.skin_model import reduced as family_of
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.limits import bayes_accuracy
from rcskin.simulator.measure.experiment import planned_presses
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.measure.specimen import Specimen
from rcskin.simulator.models.parameters import Variation
from rcskin.simulator.models.reduced.cases import pixel_touches
from rcskin.simulator.models.reduced.forward import Forward
from rcskin.simulator.models.reduced.greedy import reduce
from rcskin.simulator.models.reduced.model_file import load, save
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.models.uniform import folded
from rcskin.simulator.press.batch import PressBatch
from rcskin.simulator.press.press import every_press, parse_press, press_on
from rcskin.simulator.press.touch import Depth
from rcskin.simulator.scene.frequency import Loss
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.sweeps import InputError, impedance, open_zarr

RTOL, CLOSELY = 1e-3, 1e-4
COLUMNS = 3
FACTORS = 1.1, 4.0
DEEP = Depth(2e-3)
FACTORS_OF_SESSIONS = "sheet_resistance", "sheet_mismatch", "capacitance", "contact_resistance"
SPREADS_OF_SESSIONS = (
    "unevenness",
    "foam_spread",
    "loss_tangent",
    "stray_capacitance",
    "lead_resistance",
)
UNIFORM = {"distribution": "uniform", "low": 0.3e-3, "high": 2.2e-3}


def foam_strip(tension=20.0, **tables):
    mechanics = {"porosity": 0.67, "solid_permittivity": 2.79, "modulus": 30e3, "tension": tension}
    return Scene.model_validate(
        {
            "name": "foam strip",
            "skin": {
                "length": 0.09,
                "width": 0.03,
                "top": {"sheet_resistance": 50e3},
                "bottom": {"sheet_resistance": 40e3},
                "foam": {"thickness": 4e-3, "mechanics": mechanics},
            },
            "contact": [
                {"name": sheet, "electrode": sheet, "edge": "left"} for sheet in ("top", "bottom")
            ],
            "interface": [{"name": "meter", "high": ["top"], "low": ["bottom"]}],
            "pixels": {"rows": 1, "columns": COLUMNS},
            "press": {"depth": 2e-3, "factor_spread": 0.1},
            "sweep": {"frequencies": [1e3, 1e4, 1e5]},
            "readout": dict.fromkeys(("magnitude_noise", "phase_noise"), 1e-3),
            **tables,
        }
    )


SAME = {
    **dict.fromkeys((f"dataset.session.{name}" for name in FACTORS_OF_SESSIONS), 1.0),
    **dict.fromkeys((f"dataset.session.{name}" for name in SPREADS_OF_SESSIONS), 0.0),
    **dict.fromkeys(("readout.magnitude_noise", "readout.phase_noise"), 0.0),
    "readout.display_digits": 12,
}


def made_of(scene, path, sweeps):
    generate(Plan(scene, sweeps, 1, RTOL), path)
    return open_zarr(path).load()


@pytest.fixture(scope="module")
def scene():
    return foam_strip()


@pytest.fixture(scope="module")
def reduced(scene):
    return reduce(scene, RTOL, pixel_touches(scene, FACTORS))


def as_text(scene, cells, rises):
    depths = scene.pressed_depths(1 + np.asarray(rises)).tolist()
    touched = sorted(zip(np.asarray(cells).tolist(), depths, strict=True))
    return "+".join(f"1,{cell + 1}:{depth!r}m" for cell, depth in touched)


@pytest.mark.parametrize("cells", [[0], [1], [0, 2], [0, 1]])
def test_the_full_solver_agrees_within_the_estimate(scene, reduced, cells):
    """Single touches, two that do not feel each other, and two that meet."""
    random, own = np.random.default_rng(len(cells)), reduced.skin(None)
    cells, rises = np.array(cells), random.uniform(0.1, 2.9, len(cells))
    Z = own.sweep(cells, rises)
    truth = Solver(scene, CLOSELY).solve(parse_press(as_text(scene, cells, rises), DEEP)).Z
    off = relative_difference(Z, truth)
    estimated = own.certificate(cells, rises) + reduced.mesh_error + 0.03 * RTOL
    assert (off <= estimated + CLOSELY).all()
    assert estimated.max() <= RTOL
    assert reduced.family.coupled(cells) == (np.diff(cells) == 1).any()


def test_presses_have_equal_results_one_by_one_and_together(reduced):
    own = reduced.skin(None)
    cells, rises = np.array([0, 1, 0, 1, 2]), np.array([0.5, 2.0, 1.0, 0.7, 1.5])
    batch = PressBatch(cells, rises, np.array([0, 1, 1, 3, 4, 5]))
    for touched, Z in zip(batch.each(), own.sweeps(batch), strict=True):
        np.testing.assert_allclose(own.sweep(*touched), Z, rtol=1e-9)


def test_the_certificate_holds_on_skins_that_it_was_not_trained_on(reduced):
    """Against the same mesh in full, with pixels of other foam under and beside the applicator."""
    skin = Variation(
        np.array([1.2]), np.array([1.2]), np.ones(2), np.array([[0.7, 1.3, 1.0]]), Loss(0.02)
    )
    own = reduced.skin(skin)
    for cells, rises in (([1], [2.8]), ([0, 2], [0.4, 2.2]), ([1, 2], [1.0, 2.0])):
        press = np.array(cells), np.array(rises)
        Z = own.sweep(*press)
        off = relative_difference(Z, own.exact(*press))
        bound = own.certificate(*press)
        assert (off <= bound + 0.03 * RTOL).all()
        assert bound.max() > 1e-6


def test_what_is_left_out_between_depths_covers_the_membrane_itself(scene, reduced):
    """c at the mesh's points between Chebyshev's depths, against mechanics far more closely."""
    from rcskin.simulator.models.mechanics.indentation import deformation

    family = reduced.family
    for depth in (0.21e-3, 1.13e-3, 2.3e-3):
        rise = float(scene.pressed_factors(np.array(depth))) - 1
        (found,) = family.press(np.array([1]), np.array([rise]))
        truth = deformation(scene, parse_press(f"1,2:{depth!r}m", DEEP), 1e-4)
        x = family.elements.surface.x[:, found.cells]
        off, weights = np.abs(truth.factor(x) - 1 - found.rise), family.elements.rule.weights
        area = family.elements.surface.some(found.cells).area * weights
        assert (off * area).sum() <= (found.uncertainty * area).sum()
        assert (found.uncertainty * area).sum() <= 0.01 * (found.rise * area).sum()


def test_a_model_is_the_same_from_its_file(reduced, tmp_path):
    save(reduced, tmp_path / "model.npz")
    again = load(tmp_path / "model.npz")
    press = np.array([1]), np.array([1.5])
    found = [each.skin(None) for each in (reduced, again)]
    np.testing.assert_array_equal(*(each.certificate(*press) for each in found))
    np.testing.assert_array_equal(*(each.sweep(*press) for each in found))


def test_sweeps_by_depth_and_force_are_reduced_where_that_serves(scene):
    solver, full = Solver(scene, RTOL, "reduced"), Solver(scene, CLOSELY)
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
        with pytest.raises(InputError, match=reason):
            solver._indentation_model.result(parse_press(text, DEEP), scene.frequencies)
    answer = solver.solve(parse_press("disc(0.045,0.015,0.01):1mm", DEEP))
    assert answer.rejected[0].startswith("reduced: the model takes pixels")


def test_slopes_of_a_reduced_model_are_those_of_its_answers(scene, check_slopes):
    check_slopes(Forward(scene, rtol=RTOL), "sheet_resistance", "capacitance", rtol=1e-3)


def test_a_calibration_finds_the_sheets_of_a_twin_pressed_by_depth(scene):
    twin = scene.with_({"skin.top.sheet_resistance": 60e3})
    sweeps = simulate(Solver(twin, CLOSELY), every_press(twin))
    found = calibrate(scene, sweeps, Options(fit=("sheet_resistance", "capacitance")))
    sheets = (found.scene.skin.top, found.scene.skin.bottom)
    assert sum(each.sheet_resistance for each in sheets) == pytest.approx(100e3, rel=2e-3)
    assert found.scene.press.depth == scene.press.depth
    factor = scene.pressed_factor
    assert abs(factor - scene.press.capacitance_factor) > 0.1
    rises = np.concatenate(found.strengths)
    np.testing.assert_allclose(rises, factor - 1, rtol=0.02)


def test_limits_and_studies_press_by_depth(scene, coarse):
    planned = scene.with_({"experiment": {"repetitions": 5}})
    assert 0.6 < bayes_accuracy(planned, "pixel", draws=100, seed=1).share <= 1.0
    assert chosen_touch(planned).rise == scene.pressed_factor - 1
    presses = planned_presses(planned, np.random.default_rng(1))
    assert all(touch.by.unit == "m" for press in presses for touch in press.touches)
    plan = EvaluationSettings(draws=1).plan(planned, 0, RTOL)
    (Z,) = impedances(plan.scene, [press_on(plan.scene, "1,2")], family_of(plan.scene, RTOL), RTOL)
    off = relative_difference(Z, Solver(scene, CLOSELY).solve(parse_press("1,2", DEEP)).Z)
    assert off.max() <= RTOL


def test_a_data_set_draws_depths_and_is_what_the_full_solver_says(scene, tmp_path):
    drawn = {"dataset.press.touches": [0.2, 0.4, 0.4], "dataset.press.depth": UNIFORM}
    own = scene.with_(SAME | drawn | {"dataset.session.sweeps_per_session": 20})
    made, solver = made_of(own, tmp_path / "set.zarr", 20), Solver(own, CLOSELY)
    for sweep in np.flatnonzero(made["touches"].values)[:3]:
        press = parse_press(str(made["press"].values[sweep]), DEEP)
        off = relative_difference(impedance(made)[sweep], solver.solve(press).Z)
        assert off.max() <= RTOL + 2 * CLOSELY
        depths = np.array([each.by.value for each in press.touches])
        factors = made["touch_factor"].values[sweep, : len(depths)]
        np.testing.assert_allclose(factors, own.pressed_factors(depths), rtol=1e-6)


@pytest.mark.parametrize(
    ("changed", "reason"),
    [
        ({"dataset.press.depth": 2.6e-3}, r"`dataset.press.depth` must be <= 0.00241 m"),
        ({"dataset.press.factor": 9.0}, "`dataset.press.factor` must be from 1 to 4"),
        ({"press.depth": None, "press.force": 1.0}, "cannot take `press.force`"),
        ({"press.depth": None, "dataset.press.depth": 1e-3}, "`dataset.press.depth` needs"),
    ],
)
def test_data_sets_refuse_in_one_line_what_they_cannot_press(scene, changed, reason):
    with pytest.raises(InputError, match=reason):
        Plan(folded(scene.with_(changed), "a data set"), 10, 1, RTOL)


def test_the_virtual_meter_reads_one_press_at_all_frequencies(scene):
    specimen, press = Specimen(scene, "meter"), "1,2:1mm"
    truth = Solver(scene).solve(parse_press(press, DEEP)).Z[0]
    found = [specimen.impedance(press, float(f)) for f in scene.frequencies]
    np.testing.assert_allclose(found, truth, rtol=1e-9)
    between = specimen.impedance(press, 3e3)
    assert abs(found[1]) < abs(between) < abs(found[0])

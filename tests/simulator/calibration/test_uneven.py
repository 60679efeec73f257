"""Slow unevenness of the foam among what a calibration fits: on twins whose waves are known."""

from dataclasses import replace

import numpy as np
import pytest
from rcskin.simulator.calibration.command import Options
from rcskin.simulator.calibration.fit import fitted_parts
from rcskin.simulator.calibration.run import calibrate
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.measure.readout import read_out
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.models.cosine_modes import map_of, with_foam_modes
from rcskin.simulator.models.parameters import FOAM_MODES
from rcskin.simulator.models.reduced.forward import Forward
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.batch import TouchedCells
from rcskin.simulator.press.press import every_press, press_on
from rcskin.simulator.scene.scene_files import load_scene, scene_text
from rcskin.simulator.sweeps import InputError

FIT = ("sheet_resistance", "capacitance", *FOAM_MODES)
UNEVEN = Options(fit=FIT, fix=("others",), fixed_strength=True, uneven=True)
NO_MODES = Options(fit=FIT[:2], fix=("others",), fixed_strength=True)
TRUE = {"foam_x": 0.08, "foam_y": -0.06, "foam_xy": 0.04}


def scene_fed_at_a_corner():
    """Unlike along x and y, so that no wave looks like another."""
    frequencies = {"sweep.frequencies": [1e3, 5e3, 2.5e4, 1e5]}
    noise = {f"readout.{part}_noise": 2e-3 for part in ("magnitude", "phase")}
    exact = {f"readout.{part}_accuracy": 0.0 for part in ("magnitude", "phase")}
    spans = {"contact.top-left.span": [0.0, 0.4], "contact.bottom-left.span": [0.0, 0.4]}
    return load_scene("sheet-4x4").with_(frequencies | noise | exact | spans)


def twin_of(scene, waves, rtol=1e-4):
    made = scene.with_({"skin.foam.map": map_of(scene.parts.skin, waves).model_dump()})
    return simulate(
        Solver(made.parts, rtol), every_press(scene.parts.skin, scene.press)
    ).assign_attrs(scene=scene_text(scene))


@pytest.fixture(scope="module")
def scene():
    return scene_fed_at_a_corner()


@pytest.fixture(scope="module")
def twin(scene):
    return twin_of(scene, TRUE)


@pytest.fixture(scope="module")
def model(scene):
    return Forward(scene.parts, rtol=2e-4)


def test_slopes_by_waves_are_those_of_the_answers(model):
    step = 1e-5
    cells, rises = np.array([6]), np.array([1.0])
    own = dict(TRUE, capacitance=0.2)
    found = model.slopes(TouchedCells(cells, rises), own)
    for name in FOAM_MODES:
        ends = [
            model.slopes(TouchedCells(cells, rises), own | {name: own[name] + turn}).Z
            for turn in (-step, step)
        ]
        slope = (ends[1] - ends[0]) / (2 * step)
        scale = 1e-4 * np.abs(found.Z).max()
        np.testing.assert_allclose(found.by_parameter[name], slope, rtol=1e-3, atol=scale)


@pytest.mark.slow
def test_waves_of_twins_are_found_and_their_intervals_hold_them(scene, twin, model):
    """Five readings of one twin: the exact waves lie in nearly all of 15 intervals."""
    held, random = [], np.random.default_rng(1)
    for session in range(5):
        read = read_out(twin, scene.readout, random, session)
        found = calibrate(scene, read, UNEVEN, model=model)
        held += [low <= TRUE[name] <= high for name, (low, high) in _waves(found).items()]
        assert all(found.identified[name] for name in FOAM_MODES)
    assert sum(held) >= 12


@pytest.fixture(scope="module")
def wide_pixels(scene):
    """Of which each has much of a wave, read by a better meter."""
    return scene.with_({"pixels": 3, "readout.magnitude_noise": 1e-3, "readout.phase_noise": 1e-3})


CUT = [(0, 0), (0.12, 0), (0.12, 0.06), (0.06, 0.12), (0, 0.12)]
DEAR = "two fields", "gauges"
SKINS = {
    "squares": {},
    "triangles": {
        "skin.outline.points": CUT,
        **{f"contact.{name}-left.edge": "outline.5" for name in ("top", "bottom")},
    },
    "two fields": {"skin.bottom.sheet_resistance": 20e3, "contact.bottom-left.edge": "bottom"},
    "gauges": {"skin.top.piezoresistance": 2.0},
}


@pytest.mark.parametrize(
    "changed",
    [
        pytest.param(changed, id=name, marks=[pytest.mark.slow] if name in DEAR else [])
        for name, changed in SKINS.items()
    ],
)
def test_foam_that_varies_within_pixels_is_answered_as_a_map_of_it(wide_pixels, changed):
    """The bilinear map is off by a hundredth of a wave at most."""
    scene, rtol = wide_pixels.with_({"pixels": 2, **changed}), 1e-3
    model, solver = (
        Forward(scene.parts, rtol=rtol),
        Solver(replace(scene.parts, skin=with_foam_modes(scene.parts.skin, TRUE)), rtol),
    )
    for press in every_press(scene.parts.skin, scene.press)[::3]:
        cells, rises = model.cells(press)
        Z, true = model.slopes(TouchedCells(cells, rises), TRUE).Z, solver.solve(press).Z
        assert relative_difference(Z, true).max() <= rtol
        assert model.slopes(TouchedCells(cells, rises), TRUE, certify=True).error <= rtol
        assert (
            relative_difference(model.slopes(TouchedCells(cells, rises)).Z, true).max() > 10 * rtol
        )


@pytest.mark.slow
def test_intervals_hold_waves_that_vary_within_pixels(wide_pixels):
    """Of eight twins, at 0.1 % noise: with waves constant over pixels 17 of 24 did."""
    model, held = Forward(wide_pixels.parts, rtol=1e-4), []
    for number in range(8):
        random = np.random.default_rng(number)
        waves = dict(zip(FOAM_MODES, random.normal(0, (0.08, 0.06, 0.04)).tolist(), strict=True))
        read = read_out(twin_of(wide_pixels, waves), wide_pixels.readout, random, 0)
        found = calibrate(wide_pixels, read, UNEVEN, model=model)
        held += [low <= waves[name] <= high for name, (low, high) in _waves(found).items()]
    assert sum(held) >= 21


def _waves(found):
    return {name: found.intervals[name] for name in FOAM_MODES}


@pytest.mark.usefixtures("linear_intervals")
def test_the_fit_gains_and_the_fitted_scene_says_the_waves(scene, twin, model):
    even, uneven = (calibrate(scene, twin, each, model=model) for each in (NO_MODES, UNEVEN))
    assert uneven.rms_error < 0.1 * even.rms_error
    again = simulate(Solver(uneven.scene.parts, 1e-4), every_press(scene.parts.skin, scene.press))
    off = np.abs(again["Cp"] / twin["Cp"] - 1).max()
    assert (
        off
        < 0.1
        * np.abs(
            simulate(Solver(even.scene.parts), every_press(scene.parts.skin, scene.press))["Cp"]
            / twin["Cp"]
            - 1
        ).max()
    )


@pytest.mark.usefixtures("linear_intervals")
def test_what_a_line_does_not_determine_is_reported(scene, twin):
    """Fed along a whole edge, rows look alike, and a wave across them is known by its prior."""
    lined = scene.with_(
        {"contact.top-left.span": [0.0, 1.0], "contact.bottom-left.span": [0.0, 1.0]}
    )
    rest = simulate(Solver(lined.parts), every_press(lined.parts.skin, lined.press)[:1])
    found = calibrate(lined, rest, UNEVEN)
    assert not found.identified["foam_y"] and not found.identified["foam_xy"]
    assert any("foam_y: not identified by the data" in line for line in found.unclear)


def test_waves_are_refused_where_they_cannot_be_distinguished_from_a_map(scene, twin):
    mapped = scene.with_({"skin.foam.map": map_of(scene.parts.skin, TRUE).model_dump()})
    with pytest.raises(InputError, match="cosine modes of the foam cannot take `skin.foam.map`"):
        calibrate(mapped, twin, UNEVEN)
    with pytest.raises(InputError, match="foam_x has no effect in this scene"):
        calibrate(scene, twin, Options(fit=("foam_x",)))


def test_modes_of_the_foam_leave_a_body_behind_the_skin_as_it_is():
    """Parts that no press changes, a body, have no modes: answers are those of the full solver."""
    scene = load_scene("sheet-4x4").with_(
        {"sweep.frequencies": [1e3, 1e5], "surroundings.body": {"distance": 5e-3}}
    )
    own = {"foam_x": 0.08, "foam_y": -0.06, "body": 1.2}
    found = (
        Forward(scene.parts, rtol=1e-3).slopes(TouchedCells(np.array([6]), np.array([1.0])), own).Z
    )
    changed = fitted_parts(scene.parts, own)
    press = press_on(changed.skin, changed.plan.press, "2,3:2.0")
    exact = Solver(changed, 1e-4).solve(press).Z
    assert relative_difference(found[0], exact).max() < 2e-3

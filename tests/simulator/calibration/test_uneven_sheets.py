"""Slow unevenness of both sheets among what a calibration fits: on twins whose waves are known."""

from dataclasses import replace

import numpy as np
import pytest
from rcskin.benchmarks.accuracy.uneven_calibration import crossed
from rcskin.simulator.calibration.command import Options
from rcskin.simulator.calibration.run import calibrate
from rcskin.simulator.measure.readout import read_out
from rcskin.simulator.measure.simulate import simulate
from rcskin.simulator.models.cosine_modes import with_foam_modes, with_sheet_modes
from rcskin.simulator.models.parameters import FOAM_MODES, SHEET_MODES
from rcskin.simulator.models.reduced.forward import Forward
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.models.terminals import reduced_for
from rcskin.simulator.press.batch import TouchedCells
from rcskin.simulator.press.press import every_press
from rcskin.simulator.scene.scene_files import read_scene, scene_text
from rcskin.simulator.sweeps import InputError, write

pytestmark = pytest.mark.usefixtures("models_made_once")

MEAN = ("sheet_resistance", "sheet_mismatch", "capacitance")
SIZES = (0.08, -0.06, 0.04)
FOAM = dict(zip(FOAM_MODES, SIZES, strict=True))
SHEETS = dict(zip(SHEET_MODES, (*SIZES, *SIZES[::-1]), strict=True))
FLAT = dict.fromkeys(SHEET_MODES, 0.0)


def asked(*waves):
    fixed = {"fix": ("others",), "fixed_strength": True}
    both = {"uneven": "foam_x" in waves, "uneven_sheets": "top_x" in waves}
    return Options(fit=(*MEAN, *waves), **fixed, **both)


def twin_of(scene, waves):
    made = with_sheet_modes(with_foam_modes(scene.parts.skin, waves), waves)
    return simulate(
        Solver(replace(scene.parts, skin=made), 2e-4), every_press(scene.parts.skin, scene.press)
    ).assign_attrs(scene=scene_text(scene))


@pytest.fixture(scope="module")
def strip(line):
    """The line at few frequencies, read by a better meter."""
    noise = {f"readout.{part}_noise": 1e-3 for part in ("magnitude", "phase")}
    exact = {f"readout.{part}_accuracy": 0.0 for part in ("magnitude", "phase")}
    return line.with_({"sweep.frequencies": [1e3, 5e3, 2.5e4, 1e5]} | noise | exact)


@pytest.fixture(scope="module")
def scene():
    return crossed().with_({"pixels": 2, "sweep.frequencies": [1e3, 1e4, 1e5]})


@pytest.fixture(scope="module")
def model(scene):
    return Forward(scene.parts, rtol=5e-4, train=reduced_for, modes=4)


@pytest.fixture(scope="module")
def twin(scene):
    return twin_of(scene, SHEETS)


def held(found, truth):
    return [low <= truth[name] <= high for name in truth for low, high in [found.intervals[name]]]


def test_slopes_by_waves_are_those_of_the_answers(model):
    step, cells, rises = 1e-5, np.array([3]), np.array([1.0])
    own = SHEETS | {"sheet_mismatch": 0.3, "sheet_resistance": -0.2, "foam_x": 0.1}
    found = model.slopes(TouchedCells(cells, rises), own)
    for name in (*SHEET_MODES, "sheet_mismatch", "sheet_resistance", "foam_x"):
        below, above = (
            model.slopes(TouchedCells(cells, rises), own | {name: own[name] + turn}).Z
            for turn in (-step, step)
        )
        scale = 1e-5 * np.abs(found.Z).max()
        slope = (above - below) / (2 * step)
        np.testing.assert_allclose(found.by_parameter[name], slope, rtol=1e-3, atol=scale)


def test_waves_of_both_sheets_are_determined_within_their_intervals_down_to_the_noise(
    scene, twin, model
):
    """Three readings of one twin; intervals of one reading hang together."""
    inside = []
    for seed in range(3):
        read = read_out(twin, scene.readout, np.random.default_rng(seed))
        found = calibrate(scene, read, asked(*SHEET_MODES), model=model)
        assert all(found.identified[name] for name in SHEET_MODES)
        assert 0.7 < found.chi_squared < 1.3
        inside += held(found, SHEETS)
    assert sum(inside) >= 14


@pytest.mark.slow
def test_a_fit_without_waves_leaves_far_more(scene, twin, model):
    even = calibrate(scene, twin, asked(), model=model)
    uneven = calibrate(scene, twin, asked(*SHEET_MODES), model=model)
    assert uneven.rms_error < 0.03 * even.rms_error
    again = simulate(
        Solver(uneven.scene.parts, 2e-4), every_press(scene.parts.skin, scene.press)[:3]
    )
    for name in ("Rs", "Cp"):
        off = again[name].to_numpy() / twin[name].to_numpy()[:3] - 1
        assert np.abs(off).max() < 3e-3


def test_waves_of_an_even_skin_are_zero_within_their_intervals(scene, model):
    read = read_out(twin_of(scene, {}), scene.readout, np.random.default_rng(1))
    found = calibrate(scene, read, asked(*SHEET_MODES), model=model)
    assert sum(held(found, FLAT)) >= 5
    assert all(abs(found.values[name]) < 0.05 for name in FLAT)


@pytest.mark.slow
def test_waves_of_sheets_and_of_foam_are_distinguished(scene, twin, model):
    """The foam's are constant over each pixel, as the fit has them."""
    read, presses = twin.copy(deep=True), every_press(scene.parts.skin, scene.press)
    Z = np.stack([model.slopes(model.cells(each), SHEETS | FOAM).Z for each in presses])
    read["Rs"].values, read["X"].values = Z.real, Z.imag
    read["Cp"].values = (1 / Z).imag / (2 * np.pi * scene.frequencies)
    read = read_out(read, scene.readout, np.random.default_rng(2))
    found = calibrate(scene, read, asked(*FOAM_MODES, *SHEET_MODES), model=model)
    assert all(found.identified[name] for name in (*FOAM_MODES, *SHEET_MODES))
    assert 0.7 < found.chi_squared < 1.3
    assert sum(held(found, SHEETS | FOAM)) >= 7


def test_one_field_determines_the_sum_of_waves_and_nothing_across_a_line(strip):
    truth = {"top_x": 0.1, "bottom_x": -0.02}
    read = read_out(twin_of(strip, truth), strip.readout, np.random.default_rng(0))
    names = ("sheet_resistance", "capacitance", *SHEET_MODES)
    options = Options(fit=names, fix=("others",), fixed_strength=True, uneven_sheets=True)
    found = calibrate(strip, read, options)
    of = {each.name: each for each in found.quantities}
    R = strip.skin.sheet_resistances
    both = (R[0] * truth["top_x"] + R[1] * truth["bottom_x"]) / sum(R)
    assert of["both sheets, x"].source == "data"
    assert of["both sheets, x"].low < both < of["both sheets, x"].high
    assert not (found.identified["top_x"] or found.identified["bottom_x"])
    assert "top_x and bottom_x: the data identify only their sum, both sheets, x" in " ".join(
        found.unclear
    )
    for name in ("top_y", "bottom_y", "top_xy", "bottom_xy"):
        assert f"{name}: not identified by the data; prior kept" in found.unclear


def test_waves_are_refused_where_they_cannot_be_determined(scene, twin):
    mapped = replace(scene.parts, skin=with_sheet_modes(scene.parts.skin, SHEETS)).scene
    with pytest.raises(InputError, match="cosine modes of the sheets cannot take `skin.top.map`"):
        calibrate(mapped, twin, asked(*SHEET_MODES))
    with pytest.raises(InputError, match="top_x has no effect in this scene"):
        calibrate(scene, twin, Options(fit=("top_x",)))
    with pytest.raises(InputError, match="`modes` of the model must be 4"):
        calibrate(scene, twin, asked(*SHEET_MODES), model=Forward(scene.parts, rtol=1e-2))


@pytest.mark.usefixtures("linear_intervals", "unpainted")
def test_the_calibrated_file_has_the_waves_as_maps(run, tmp_path, strip):
    waves = {"top_x": 0.2}
    made = with_sheet_modes(strip.parts.skin, waves)
    write(twin_of(strip, waves), tmp_path / "run.nc")
    (tmp_path / "line.toml").write_text(scene_text(strip))
    options = [part for name in ("top_x", "sheet_resistance") for part in ("--fit", name)]
    fixed = ("--fix", "others", "--fixed-strength", "--uneven-sheets")
    asked = ("calibrate", tmp_path / "line.toml", tmp_path / "run.nc", *options, *fixed)
    code, out, err = run(*asked, "-o", tmp_path / "found")
    assert code == 0 and "the scene has no [surroundings]" in err
    assert "top_x" in out
    calibrated = read_scene(tmp_path / "found" / "calibrated.toml")
    top, bottom = (sheet.map for sheet in (calibrated.skin.top, calibrated.skin.bottom))
    assert np.array(top.values)[0] == pytest.approx(np.array(made.top.map.values)[0], abs=0.02)
    assert np.array(bottom.values) == pytest.approx(1.0, abs=1e-9)
    again = ("sweep", tmp_path / "found" / "calibrated.toml", "--press", "none")
    assert run(*again, "-o", tmp_path / "again.nc")[0] == 0

"""Limits of touches that press by depth: the foam beside them gives way, too."""

import json
from dataclasses import replace

import numpy as np
import pytest
from rcskin import __main__ as rcskin
from rcskin.simulator.bounds import rasterization_errors
from rcskin.simulator.bounds.field_choice import fields_of
from rcskin.simulator.bounds.full_fields import FullFields
from rcskin.simulator.bounds.likelihood import error_model, in_noise
from rcskin.simulator.bounds.pixel_touches import DepthPixelTouches
from rcskin.simulator.bounds.position_bound import chosen_touch, errors_of_places, place_likelihood
from rcskin.simulator.bounds.touch_rasterizers import (
    AreaRasterizer,
    DepthRasterizer,
    TouchSize,
    distributed_to_cells,
)
from rcskin.simulator.bounds.touch_readings import TouchReadings
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.limits import bayes_accuracy
from rcskin.simulator.measure.experiment import own_presses
from rcskin.simulator.models.mechanics.lattice_presses import raised
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.batch import PressBatch
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.scene_files import load_scene, scene_text
from rcskin.simulator.sweeps import InputError
from typer.testing import CliRunner

SIDE = 0.12
DEPTH = 2e-3
NOISE = {"readout.magnitude_noise": 3e-3, "readout.phase_noise": 3e-3}
FEW = {"sweep": {"frequencies": [1e3, 2e4, 2e5]}}


@pytest.fixture(scope="module")
def foam():
    return load_scene("foam").with_({"pixels": 3, **FEW, **NOISE})


@pytest.fixture
def compared(monkeypatch):
    """A function: errors are told of so many touches."""
    return lambda count: monkeypatch.setattr(rasterization_errors, "SAMPLE", count)


def pressed_at(scene, touch, solver, x, y, rise):
    depth = scene.parts.skin.pressed_depth(1 + rise)
    text = f"rect({x!r},{y!r},{touch.width!r},{touch.height!r}):{depth!r}m"
    return solver.solve(parse_press(text, np.nan)).Z


@pytest.mark.parametrize("size", [0.012, pytest.param(None, marks=pytest.mark.slow)])
def test_slopes_and_bounds_are_those_of_differences_of_the_full_model(foam, size):
    scene = foam.with_({"sweep": {"frequencies": [2e4, 6e4, 2e5]}})
    touch, solver, frequency = (
        chosen_touch(scene.parts.skin, scene.press, size),
        Solver(scene.parts, 1e-4),
        scene.frequencies,
    )
    fields = fields_of(scene.parts, float(frequency[-1]), touch)
    deep = DepthRasterizer(scene.parts.skin, fields.grid, (touch.width, touch.height))
    x, y, rise, step = 0.0683, 0.0552, touch.rise, 1.5e-3
    found = fields.respond(*deep.rasterized((x, y), touch), frequency)

    def impedance(dx, dy, more):
        return pressed_at(scene, touch, solver, x + dx, y + dy, rise * (1 + more))

    expected = {
        "x": (impedance(step, 0, 0) - impedance(-step, 0, 0)) / (2 * step),
        "y": (impedance(0, step, 0) - impedance(0, -step, 0)) / (2 * step),
        "strength": (impedance(0, 0, 0.02) - impedance(0, 0, -0.02)) / (0.04 * rise),
    }
    largest = max(np.abs(expected[name]).max() for name in ("x", "y"))
    for name, slope in expected.items():
        scale = largest if name != "strength" else np.abs(slope).max()
        assert np.abs(found.by_parameter[name] - slope).max() < 0.05 * scale
    told = place_likelihood(fields, [(x, y)], touch, frequency)
    model = error_model(scene.parts.setup, scene.parts.meter, frequency)
    own = in_noise(impedance(0, 0, 0), list(expected.values()), model)
    truth = replace(told, readings=replace(told.readings, by=own[None])).bounds()
    for name in ("x", "strength"):
        value = getattr(truth, name)
        np.testing.assert_allclose(getattr(told.bounds(), name), value, rtol=0.1)


def test_touches_are_six_cells_wide_or_refused(foam):
    widths = {
        size: fields_of(foam.parts, 1e5, chosen_touch(foam.parts.skin, foam.press, size)).cells
        * size
        / (SIDE / 3)
        for size in (0.1, SIDE / 3, 0.02, 0.012, 0.007)
    }
    assert min(widths.values()) >= 6 - 1e-9 and widths[SIDE / 3] == pytest.approx(6)
    with pytest.raises(InputError, match="at least 0.167 of a pixel wide, got 0.1"):
        fields_of(foam.parts, 1e5, chosen_touch(foam.parts.skin, foam.press, 0.004))
    plain = foam.with_({"press": {"capacitance_factor": 2.0}})
    gauge = foam.with_({"skin.top.piezoresistance": 2.0, "pixels": 1})
    for other in (plain, gauge):
        assert (
            fields_of(other.parts, 1e5, chosen_touch(other.parts.skin, other.press, 0.004)).cells
            == 4
        )


def test_a_foam_whose_skins_hardly_pull_is_pressed_as_by_factors(foam):
    loose = foam.with_(
        {"skin.foam.mechanics.tension": 2e-3, "skin.length": 0.03, "skin.width": 0.03}
    )
    touch = TouchSize(0.01, 0.01, 0.02)
    deep = DepthRasterizer(loose.parts.skin, (12, 12), (touch.width, touch.height))
    for place in ((0.0158, 0.0147), (0.0112, 0.016)):
        found, sharp = (
            deep.rasterized(place, touch),
            AreaRasterizer.of(loose.parts.skin, (12, 12)).rasterized(place, touch),
        )
        np.testing.assert_allclose(found.factors, sharp.factors, atol=0.1 * touch.rise)
        total = sharp.changes["strength"].sum()
        assert found.changes["strength"].sum() == pytest.approx(total, rel=0.08)
        at = np.arange(12) + 0.5
        moved = [(each.changes["x"] * at).sum() for each in (found, sharp)]
        assert moved[0] == pytest.approx(moved[1], rel=0.08)


@pytest.mark.slow
def test_a_touch_of_a_pixels_size_has_the_limits_of_the_pixel(foam, compared, coarse):
    compared(4)
    scene = foam.with_({"pixels": 2, "sweep": {"frequencies": [2e4]}})
    presses = own_presses(scene.parts.skin, scene.press)
    whole, laid = (TouchReadings(scene.parts, presses, size=size) for size in (None, SIDE / 2))
    told = laid.rasterization_errors(presses)
    assert whole.rasterization_errors(presses) is None and 0 < told.deflection < told.cells
    batch = PressBatch.even(np.arange(4)[:, None], np.full((4, 1), foam.pressed_factor - 1))
    own, other = whole._impedances(batch), laid._impedances(laid._rasterized(batch))
    assert 0 < relative_difference(other, own).max() <= told.cells


def test_estimated_errors_of_places_cover_those_of_others(foam, compared):
    compared(4)
    touch, fields = (
        chosen_touch(foam.parts.skin, foam.press, 0.012),
        FullFields(foam.parts, float(foam.frequencies[-1])),
    )
    inside = np.linspace(0.006, SIDE - 0.006, 5).tolist()
    told = errors_of_places(fields, [(x, y) for x in inside for y in inside], touch)
    deep, solver = (
        DepthRasterizer(foam.parts.skin, fields.grid, (touch.width, touch.height)),
        Solver(foam.parts, 1e-4),
    )
    for place in ((0.0071, 0.0082), (0.033, 0.0071), (0.1083, 0.0577)):
        Z = fields.respond(deep.rasterized(place, touch).factors, {}, foam.frequencies).Z
        exact = pressed_at(foam, touch, solver, *place, touch.rise)
        assert relative_difference(Z, exact).max() <= told.cells
    plain = foam.with_({"press": {"capacitance_factor": 2.0}})
    assert (
        errors_of_places(
            FullFields(plain.parts, 1e5),
            [(0.06, 0.06)],
            chosen_touch(plain.parts.skin, plain.press),
        )
        is None
    )


def test_touches_of_any_depth_run_through_those_of_a_few(foam):
    deep = DepthPixelTouches(foam.parts.skin, (9, 9), 0.015, 2.0)
    for touches in ([(0, 0.37)], [(4, 1.91)], [(0, 1.1), (1, 0.6)], [(0, 1.1), (8, 0.6)]):
        cells, rises = (np.array(each) for each in zip(*touches, strict=True))
        found = deep.rasterized(PressBatch.of([(cells, rises)])).one(0)
        solved = raised(deep.lattice, deep.applied(cells, rises))
        each = np.zeros((2, 81))
        for own, laid in zip(each, (found, solved), strict=True):
            own[laid.cells] = laid.rises
        np.testing.assert_allclose(*each, atol=3e-4 * rises.max())


def test_what_nodes_share_acts_on_straight_functions_as_the_nodes_do(foam):
    lattice = DepthRasterizer(foam.parts.skin, (12, 12), (0.02, 0.02)).lattice
    here = slice(0, 12), slice(2, 9)
    rows, columns = lattice.nodes(here)
    values = np.random.default_rng(1).standard_normal(
        (len(lattice.y[rows]), len(lattice.x[columns]))
    )
    shared = distributed_to_cells(lattice, values, here)
    nodes = np.prod(lattice.within)
    cell = SIDE / 12
    x, y = (np.arange(2, 9) + 0.5) * cell, (np.arange(12) + 0.5) * cell
    for a, b in ((0, 0), (1, 0), (0, 1)):
        by_cells = nodes * (shared * (1 + a * x + b * y[:, None])).sum()
        by_nodes = (values * (1 + a * lattice.x[columns] + b * lattice.y[rows][:, None])).sum()
        assert by_cells == pytest.approx(by_nodes, rel=1e-9)


def test_pixels_without_skin_do_not_end_the_training(kinds, coarse):
    mechanics, one = foam_of(load_scene("foam")), {"sweep": {"frequencies": [2e4]}}
    whole = {"skin.outline.holes": [], "contact.bottom.edge": "outline.5"}
    scene = kinds["l with a hole"].with_({**mechanics, **whole, "pixels": 2, **one, **NOISE})
    assert 0 < bayes_accuracy(scene.parts, "pixel", draws=50)[0] <= 1


def foam_of(scene):
    own = scene.model_dump(mode="json", by_alias=True, exclude_none=True)
    return {"skin.foam": own["skin"]["foam"], "press": {"depth": DEPTH}}


def run(*arguments):
    return CliRunner().invoke(rcskin.app, [str(each) for each in arguments])


def test_limits_of_a_size_by_depth_are_reported_with_their_errors(
    foam, tmp_path, undrawn, compared, coarse
):
    compared(1)
    path = tmp_path / "foam.toml"
    path.write_text(scene_text(foam.with_({"pixels": 2})), encoding="utf-8")
    done = run("limits", path, "--size", 20, "--draws", 50, "-n", 2, "-o", tmp_path / "found")
    assert done.exit_code == 0, done.output
    assert done.output.count("touches by depth are rasterized on cells") == 2
    assert "strength is that under the touch" in done.output
    told = json.loads((tmp_path / "found" / "limits.json").read_text())
    for off in (told["rasterization_error"], told["accuracy"]):
        assert 0 < off["deflection_error"] <= off["cells_error"] < 0.05


def test_size_and_factor_reach_the_frequencies_for_pixels(foam, tmp_path, coarse):
    path, told = tmp_path / "foam.toml", set()
    path.write_text(scene_text(foam.with_({"pixels": 2})), encoding="utf-8")
    asked = ("frequencies", path, "-n", 2, "--grid", 5, "--criterion", "column")
    for more in ((), ("--size", 20), ("--factor", 1.5)):
        done = run(*asked, *more)
        assert done.exit_code == 0, done.output
        told.add(done.stderr.splitlines()[0])
    assert len(told) == 3


def test_touches_that_lie_alike_are_solved_once(foam):
    touch = chosen_touch(foam.parts.skin, foam.press, 0.012)
    fields = FullFields(foam.parts, float(foam.frequencies[-1]))
    places = [(0.045, 0.055), (0.055, 0.055)]
    fresh = [
        DepthRasterizer(foam.parts.skin, fields.grid, (touch.width, touch.height)) for _ in places
    ]
    one = DepthRasterizer(foam.parts.skin, fields.grid, (touch.width, touch.height))
    for place, alone in zip(places, fresh, strict=True):
        found, expected = one.rasterized(place, touch), alone.rasterized(place, touch)
        np.testing.assert_allclose(found.factors, expected.factors, rtol=1e-6)
        for name, change in expected.changes.items():
            scale = np.abs(change).max()
            np.testing.assert_allclose(found.changes[name], change, atol=1e-6 * scale)
    assert len(one._cache) == 1

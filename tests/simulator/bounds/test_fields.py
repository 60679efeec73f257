"""Exact sensitivities against differences of the solver and of the exact line."""

import numpy as np
import pytest
from rcskin.simulator.bounds.full_fields import FullFields
from rcskin.simulator.bounds.reduced_fields import ReducedFields
from rcskin.simulator.bounds.touch_rasterizers import AreaRasterizer, TouchSize
from rcskin.simulator.models.line import Line
from rcskin.simulator.models.parameters import parts_with
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.models.terminals import read, trained
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.touch import Rectangle
from rcskin.simulator.scene.scene_files import load_scene

STEP = 1e-3


def answered(fields, place, touch, frequency):
    grid = AreaRasterizer.of(fields.parts.skin, fields.grid)
    changes = grid.raised(place, touch)
    return fields.respond(1 + touch.rise * changes["strength"], changes, frequency)


def differences(impedance, place, touch, step=STEP):
    """dZ by x, y and rise, of impedance(x, y, rise)."""
    x, y = place
    return {
        "x": (impedance(x + step, y, touch.rise) - impedance(x - step, y, touch.rise)) / (2 * step),
        "y": (impedance(x, y + step, touch.rise) - impedance(x, y - step, touch.rise)) / (2 * step),
        "strength": (impedance(x, y, touch.rise + 0.01) - impedance(x, y, touch.rise - 0.01))
        / 0.02,
    }


def assert_close(found, expected, rtol):
    assert np.abs(found - expected).max() < rtol * np.abs(expected).max()


@pytest.mark.parametrize("name", ["sheet-5x5", "sheet-5x5-two-interfaces"])
def test_derivatives_are_those_of_a_touch_that_moves_and_grows(name):
    scene = load_scene(name)
    scene = scene.model_copy(
        update={"sweep": scene.sweep.model_copy(update={"frequencies": (1e3, 2e4, 2e5)})}
    )
    solver, touch, place = Solver(scene.parts, 1e-4), TouchSize(0.024, 0.024, 1.0), (0.045, 0.033)

    def impedance(x, y, rise):
        press = Press((Rectangle(x, y, touch.width, touch.height, 1 + rise),))
        return solver.solve(press).Z

    found = answered(FullFields(scene.parts, 2e5), place, touch, scene.frequencies)
    np.testing.assert_allclose(found.Z, impedance(*place, touch.rise), rtol=2e-3)
    expected = differences(impedance, place, touch)
    assert_close(found.by_parameter["x"], expected["x"], 0.02)
    assert_close(found.by_parameter["y"], expected["y"], 0.02)
    assert_close(found.by_parameter["strength"], expected["strength"], 2e-3)


def test_an_edge_that_moves_on_a_strip_is_that_of_the_exact_line(noisy):
    scene = noisy(length=0.1, width=0.02, columns=5, frequencies=(1e2, 1e3, 1e4))
    line, touch, place = (
        Line(scene.parts.skin, scene.parts.setup),
        TouchSize(0.02, 0.02, 1.0),
        (0.0425, 0.01),
    )

    def impedance(x, y, rise):
        return line.solve(Press((Rectangle(x, 0.01, 0.02, 0.02, 1 + rise),)), scene.frequencies).Z

    found = answered(FullFields(scene.parts, 1e4), place, touch, scene.frequencies)
    expected = differences(impedance, place, touch)
    assert_close(found.by_parameter["x"], expected["x"], 5e-3)
    assert_close(found.by_parameter["strength"], expected["strength"], 1e-3)
    assert not found.by_parameter["y"].any()


def test_derivatives_by_the_skin_are_differences_of_skins(noisy):
    contacts = {
        "top-left": {"resistance": 50.0},
        "bottom-left": {"resistance": 90.0},
        "top-bottom": {"span": (0.3, 1.0)},
        "bottom-bottom": {"span": (0.3, 1.0)},
    }
    scene = noisy(contacts=contacts, loss_tangent=0.05, rows=2, columns=2)
    frequency, step = scene.frequencies, 1e-4
    press = np.where(np.arange(64).reshape(8, 8) % 7 < 2, 2.0, 1.0)
    found = FullFields(scene.parts, 1e5).respond(press, {}, frequency, {})
    for name, unit in (
        ("sheet_resistance", 1),
        ("sheet_mismatch", 1),
        ("capacitance", 1),
        ("contact_resistance", 1),
        ("loss_tangent", 1),
        ("lead_resistance", 1e3),
        ("stray_capacitance", 1e-12),
    ):
        own = {"loss_tangent": 0.05}.get(name, 0.0)
        two = [own + 2 * step * unit, own]
        high, low = (
            FullFields(parts_with(scene.parts, {name: value}), 1e5).respond(press, {}, frequency).Z
            for value in two
        )
        between = FullFields(parts_with(scene.parts, {name: own + step * unit}), 1e5)
        slope = between.respond(press, {}, frequency, {}).by_parameter[name]
        assert_close(slope, (high - low) / (2 * step * unit), 1e-3)
        assert found.by_parameter[name].shape == found.Z.shape


def test_earth_without_capacitance_changes_no_slope(make_scene):
    """Two excitations a reading, of which what rounding leaves of one is not taken for a field."""
    scene = make_scene(columns=2, frequencies=[1e3, 1e5])
    factors, f = np.array([[1.0, 2.0]]), scene.frequencies
    asked = factors, {"rise": factors - 1}, f, {"foam": np.ones((1, 2))}
    alone, earthed = (
        FullFields(each.parts, f[-1], 1).respond(*asked)
        for each in (scene, scene.with_({"surroundings": {}}))
    )
    np.testing.assert_allclose(earthed.Z, alone.Z, rtol=1e-4)
    for name in ("rise", "foam", "sheet_resistance"):
        np.testing.assert_allclose(earthed.by_parameter[name], alone.by_parameter[name], rtol=1e-3)


def test_a_reduced_model_of_all_terminals_agrees_near_earth():
    """Of a press by a finger: the capacitance of the foam alone is that of its map."""
    around = {
        "body": {"distance": 5e-3},
        "cover": {"thickness": 1e-3, "relative_permittivity": 1.0},
        "rim": {"mutual": 5e-12, "top": 6e-12, "bottom": 6e-12},
    }
    scene = load_scene("sheet-5x5").with_({"pixels": 2, "surroundings": around})
    model = read(trained(scene.parts, 1e-2), scene.interfaces)
    pressed = np.array([[[1.0, 2.0], [1.0, 1.0]], [[0.0, 4e-12], [0.0, 0.0]]])
    directions = {"finger": np.zeros_like(pressed)}
    directions["finger"][1, 0, 1] = 1.0
    of_foam = {"foam": pressed * np.array([1.0, 0.0])[:, None, None]}
    asked = pressed, directions, np.array([1e3, 1e5]), of_foam
    found = ReducedFields(scene.parts, model.at(None), 1).respond(*asked)
    expected = FullFields(scene.parts, 1e5, 1).respond(*asked)
    np.testing.assert_allclose(found.Z, expected.Z, rtol=1e-3)
    assert found.by_parameter.keys() == expected.by_parameter.keys()
    for name in ("finger", "capacitance", "body", "rim", "loss_tangent"):
        assert_close(found.by_parameter[name], expected.by_parameter[name], 0.02)
    assert_close(found.by_parameter["capacitance"], found.by_parameter["foam"], 1e-9)

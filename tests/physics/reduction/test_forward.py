"""A scene as a function: its values are those of the full solver, its slopes are exact."""

import numpy as np
import pytest
from rcskin.simulator.models.parameters import (
    SHEET_MODES,
    parts_with,
)
from rcskin.simulator.models.reduced.forward import Forward
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.batch import PressBatch, TouchedCells
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.meter import Sweep
from rcskin.simulator.scene.scene_files import load_scene
from rcskin.simulator.sweeps import InputError, parallel_capacitance

FILMS = {"top-left": {"resistance": 200.0}, "bottom-left": {"resistance": 100.0}}
CROSSED = {"top-left": {"resistance": 200.0}, "bottom-bottom": {"resistance": 300.0}}
FREQUENCIES = tuple(np.geomspace(1e3, 2e5, 5))
RTOL = 1e-4
ROUGH = 1e-2
"""Of models whose own answers are compared with each other alone."""


@pytest.fixture(scope="module")
def made(make_scene):
    """Forward models by what feeds them."""
    scenes = {
        name: make_scene(contacts, rows=2, columns=3, frequencies=FREQUENCIES)
        for name, contacts in (("one field", FILMS), ("two fields", CROSSED))
    }
    return {name: Forward(scene.parts, rtol=RTOL) for name, scene in scenes.items()}


@pytest.fixture(scope="module", params=["one field", "two fields"])
def forward(request, made):
    return made[request.param]


def test_values_are_those_of_the_full_solver(forward, moved):
    press = parse_press("1,2:1.8+2,3:2.5", 2.0)
    response = forward.slopes(forward.cells(press), moved)
    truth = Solver(parts_with(forward.parts.scene.parts, moved), 0.1 * RTOL).solve(press).Z
    np.testing.assert_allclose(response.Z.real, truth.real, rtol=RTOL)
    frequency = forward.parts.setup.frequency
    Cp, true_Cp = (parallel_capacitance(Z, frequency) for Z in (response.Z, truth))
    np.testing.assert_allclose(Cp, true_Cp, rtol=RTOL)


TWO_INTERFACES = "sheet-5x5-two-interfaces"


@pytest.fixture(scope="module", params=["plain", "floating", "uneven"])
def reader(request, make_scene, made):
    """Models of one field, of floating terminals at two interfaces, and with modes of sheets."""
    if request.param == "plain":
        return made["one field"]
    floating = load_scene(TWO_INTERFACES).with_({"pixels": 2})
    scene = floating if request.param == "floating" else make_scene(CROSSED)
    scene = scene.model_copy(update={"sweep": Sweep(frequencies=FREQUENCIES)})
    return Forward(scene.parts, rtol=ROUGH, modes=4 if request.param == "uneven" else 1)


@pytest.mark.parametrize("touches", [0, 1, 2, 4])
def test_presses_together_are_those_one_by_one(reader, moved, touches):
    random = np.random.default_rng(touches)
    pixels = reader.parts.skin.pixels.rows * reader.parts.skin.pixels.columns
    cells = np.stack([random.permutation(pixels)[:touches] for _ in range(6)])
    cells[5], rises = cells[0], random.uniform(-0.4, 2.0, cells.shape)
    waves = dict.fromkeys(SHEET_MODES, 0.1) if reader.modes > 1 else {}
    together = reader.slopes(PressBatch.even(cells, rises), moved | waves)
    for k in range(6):
        alone = reader.slopes(TouchedCells(cells[k], rises[k]), moved | waves)
        np.testing.assert_allclose(together.Z[k], alone.Z, rtol=1e-10)
        of_touches = alone.by_cell[..., cells[k]]
        np.testing.assert_allclose(together.by_cell[k], of_touches, rtol=1e-8)
        for name, slope in alone.by_parameter.items():
            atol = 1e-9 * np.abs(slope).max()
            np.testing.assert_allclose(together.by_parameter[name][k], slope, atol=atol)


def test_an_unknown_parameter_is_named(forward):
    none = np.zeros(0, dtype=np.int64)
    with pytest.raises(InputError, match="`parameter` must be one of sheet_resistance.*'sheet'"):
        forward.slopes(TouchedCells(none, np.zeros(0)), {"sheet": 1.0})

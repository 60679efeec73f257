"""Parameters of readers of gains: slopes by them, and scenes with them."""

import numpy as np
import pytest
from rcskin.simulator.models.line import Line
from rcskin.simulator.models.parameters import (
    READER,
    own_values,
    parts_with,
    reader_values,
    reading_of,
)
from rcskin.simulator.press.batch import TouchedCells
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.scene_files import load_scene, parse_scene, scene_text

LOAD = {"resistance": 2e6, "capacitance": 8e-12}
ALONE = {
    "interface.1.reader": "gain",
    "interface.1.series_resistance": 1e5,
    "interface.1.load": LOAD,
    "leads": {"resistance": 300.0, "inductance": 1e-3, "stray_capacitance": 3e-12},
}


@pytest.fixture(scope="module")
def alone():
    return load_scene("strip-1x3").with_(ALONE)


def steps(scene):
    own = own_values(scene.parts.skin, scene.parts.setup)
    return own, {name: 1e-4 * own[name] for name in READER}


def test_slopes_of_a_gain_by_its_reader_are_its_derivatives(alone):
    model, press = (
        Line(alone.parts.skin, alone.parts.setup),
        parse_press("1,2:2", 2.0),
    )
    cells, rises = model.cells(press)
    own, step = steps(alone)
    slopes = model.slopes(TouchedCells(cells, rises), own).by_parameter
    for name in READER:
        ends = [
            model.slopes(TouchedCells(cells, rises), own | {name: own[name] + side * step[name]}).Z
            for side in (1, -1)
        ]
        slope = (ends[0] - ends[1]) / (2 * step[name])
        np.testing.assert_allclose(slopes[name], slope, rtol=1e-6, atol=1e-9 / step[name])


def test_slopes_of_two_nodes_that_are_driven_at_once_are_their_derivatives():
    scene = load_scene("knit-36").with_({"leads": ALONE["leads"]})
    scene = parts_with(scene.parts, {"load_conductance": 1e-7}).scene
    own, step = steps(scene)
    random = np.random.default_rng(0)
    shape = len(scene.parts.setup.solved), len(scene.frequencies)
    Z = 3e5 * (random.random(shape) - 1j * random.random(shape))
    slopes = reading_of(scene.parts.setup, own).slopes(Z).by_leads
    for name in READER:
        ends = [
            reading_of(scene.parts.setup, own | {name: own[name] + side * step[name]}).at_meter(Z)
            for side in (1, -1)
        ]
        slope = (ends[0] - ends[1]) / (2 * step[name])
        np.testing.assert_allclose(slopes[name], slope, rtol=1e-5, atol=1e-9 / step[name])


def test_a_scene_with_reader_parameters_has_them_at_all_interfaces():
    scene = load_scene("knit-36")
    found = parts_with(
        scene.parts,
        {"series_resistance": 1.1e6, "load_capacitance": 15e-12, "load_conductance": 1e-8},
    ).scene
    for each in found.interfaces:
        assert each.series_resistance == pytest.approx(1.1e6)
        assert each.load.capacitance == pytest.approx(15e-12)
        assert each.load.resistance == pytest.approx(1e8)
    assert parse_scene(scene_text(found), "again") == found
    assert reader_values(found.parts.setup)["load_conductance"] == pytest.approx(1e-8)


def test_impedances_have_no_reader_parameters():
    assert not reader_values(load_scene("strip-1x3").parts.setup)

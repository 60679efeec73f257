"""The built-in scenes against the numbers of the paper they stand for."""

from copy import deepcopy

import numpy as np
import pytest
from rcskin.simulator.fem.circuit import two_fields
from rcskin.simulator.scene.scene_files import builtin_names, load_scene
from rcskin.simulator.scene.wiring_checks import conductor_groups

STRIPS = ["strip-1x3", "strip-1x4", "strip-1x5"]
SHEETS = [name for name in builtin_names() if name.startswith("sheet")]
OF_THE_PAPER = [name for name in builtin_names() if name.startswith(("sheet", "strip"))]


@pytest.mark.parametrize("name", STRIPS)
def test_strips_have_the_loop_resistance_and_capacitance_of_section_3(name):
    """100 mm x 20 mm; 50 kohm/mm of both sheets in series, 108 fF/mm."""
    skin = load_scene(name).skin
    loop = (skin.top.sheet_resistance + skin.bottom.sheet_resistance) / skin.width
    assert (skin.length, skin.width) == (0.100, 0.020)
    assert loop == pytest.approx(50e3 / 1e-3, rel=1e-12)
    per_metre = skin.foam.unpressed_capacitance_per_area * skin.width
    assert per_metre == pytest.approx(108e-15 / 1e-3, rel=1e-12)


@pytest.mark.parametrize("name", STRIPS)
def test_strips_are_read_at_the_frequencies_of_equation_6(name):
    """f_i = 0.0382 / (R C x_i²) at the far end of every pixel, to the hertz."""
    scene = load_scene(name)
    x = np.arange(1, scene.pixels.columns + 1) * 100e-3 / scene.pixels.columns
    expected = 0.0382 / (50e3 / 1e-3 * 108e-15 / 1e-3 * x**2)
    np.testing.assert_array_equal(scene.frequencies, np.round(expected[::-1]))


@pytest.mark.parametrize("name", SHEETS)
def test_sheets_have_the_size_and_capacitance_of_figure_1(name):
    """120 mm x 120 mm, 50 kohm/sq, 70 pF."""
    skin = load_scene(name).skin
    assert (skin.length, skin.width) == (0.120, 0.120)
    assert skin.top.sheet_resistance == skin.bottom.sheet_resistance == 50e3
    picofarad = skin.foam.unpressed_capacitance_per_area * skin.length * skin.width * 1e12
    assert round(picofarad, 2) == 70.0


@pytest.mark.parametrize("name", SHEETS)
def test_sheets_are_read_at_twenty_frequencies_from_1_to_200_kHz(name):
    frequencies = load_scene(name).frequencies
    assert (frequencies[0], frequencies[-1], frequencies.size) == (1e3, 200e3, 20)
    np.testing.assert_allclose(np.diff(np.log(frequencies)), np.log(200) / 19, rtol=1e-12)


@pytest.mark.parametrize("name", OF_THE_PAPER)
def test_every_scene_is_pressed_to_twice_its_capacitance(name):
    scene = load_scene(name)
    assert scene.press.capacitance_factor == 2.0
    assert scene.experiment.repetitions == 6
    assert scene.name.endswith(f"{scene.pixels.rows}x{scene.pixels.columns}") or "5x5-" in name


@pytest.mark.parametrize("name", OF_THE_PAPER)
def test_class_0_is_in_1x3_and_3x3_alone(name):
    assert load_scene(name).experiment.unpressed == name.endswith("x3")


def test_the_pairs_of_foils_on_two_edges_do_not_touch():
    scene = load_scene("sheet-5x5-two-interfaces")
    assert len(set(conductor_groups(scene.contacts, scene.skin))) == 4
    assert [
        drive.high for drive in two_fields(scene.parts.skin, scene.parts.setup).excitations
    ] == [(0,), (2,)]


def test_changes_of_a_scene_are_not_modified():
    """Tables that are given, and what later keys change within them."""
    changes = {"skin.top.map": {"kind": "gradient", "x": 0.2}, "skin.top.map.y": 0.1}
    given = deepcopy(changes)
    changed = load_scene("strip-1x3").with_(changes)
    assert changed.skin.top.map.y == 0.1 and changes == given


def test_the_knit_has_the_yarn_and_the_readings_of_its_paper():
    """0.5 Mohm, 1 Mohm at each end, 2 to 25.75 kHz in steps of 250 Hz, touches of 20 to 40 pF."""
    knit = load_scene("knit-36")
    skin = knit.skin
    assert skin.top.sheet_resistance * skin.length / skin.width == pytest.approx(0.5e6, rel=1e-4)
    assert [each.series_resistance for each in knit.interfaces] == [1e6, 1e6]
    np.testing.assert_allclose(knit.frequencies, 2e3 + 250 * np.arange(96), rtol=1e-12)
    drawn = knit.dataset.press.capacitance
    assert (drawn.low, drawn.high, knit.pixels.shape) == (20e-12, 40e-12, (1, 36))

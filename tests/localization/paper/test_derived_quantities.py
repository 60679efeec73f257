"""How the paper is read: numbers that its statements imply."""

import numpy as np
import pytest
from rcskin.localization.paper.paper_quantities import (
    capacitance_changes,
    low_frequency_resistances,
    open_line_frequencies,
    paper_frequencies,
    row_contrast,
    separation_peaks,
    totals,
    unpressed_resistance,
)
from rcskin.simulator.scene.scene_files import load_scene


def test_changes_of_capacitance_on_the_strip_at_its_highest_frequency():
    strip = load_scene("strip-1x5")
    changes = 100 * capacitance_changes(strip.parts, 17685.0)
    np.testing.assert_allclose(changes, [41.6, 6.0, -5.8, -7.1, -5.9], atol=0.05)


def test_the_stated_sheet_resistance_would_not_separate_the_curves():
    strip = load_scene("strip-1x5")
    stated = strip.with_({"skin.sheet_resistance": 50e3})
    assert totals(stated.parts.skin).R == pytest.approx(totals(strip.parts.skin).R / 10)
    assert np.ptp(capacitance_changes(stated.parts, 17685.0)) < 0.06


def test_position_follows_from_resistance_at_zero_frequency():
    expected = [1.6667, 1.2963, 1.5463, 1.7407, 1.8796, 1.9630]
    scene = load_scene("strip-1x5")
    resistances = (
        low_frequency_resistances(
            scene.parts.skin,
            scene.parts.setup,
            scene.press,
        )
        / 1e6
    )
    np.testing.assert_allclose(resistances, expected, atol=5e-5)


def test_strip_and_sheet_differ_in_loop_time_constant_and_so_in_every_cut_off():
    strip, sheet = load_scene("strip-1x3"), load_scene("sheet-3x3")
    ratio = (
        totals(strip.parts.skin).R
        * totals(strip.parts.skin).C
        / (totals(sheet.parts.skin).R * totals(sheet.parts.skin).C)
    )
    assert ratio == pytest.approx(7.714, abs=1e-3)
    for cut_offs in (paper_frequencies, open_line_frequencies):
        np.testing.assert_allclose(
            cut_offs(sheet.parts.skin) / cut_offs(strip.parts.skin), ratio, rtol=1e-9
        )


def test_columns_separate_best_above_the_interrogation_frequencies():
    for name in ("strip-1x3", "sheet-3x3"):
        scene = load_scene(name)
        assert (separation_peaks(scene.parts) > paper_frequencies(scene.parts.skin)[1:]).all()


def test_floating_foils_of_the_other_edge_lower_the_resistance_and_separate_rows():
    plain, floating = load_scene("sheet-5x5"), load_scene("sheet-5x5-two-interfaces")
    assert unpressed_resistance(plain.parts) == pytest.approx(100e3 / 3, rel=1e-9)
    assert unpressed_resistance(floating.parts) == pytest.approx(20.9e3, rel=2e-3)
    assert row_contrast(plain.parts) < 1e-10
    assert row_contrast(floating.parts) > 0.02

"""Errors are drawn on the skin they were made on: its outline and its foils."""

import numpy as np
import pytest
from matplotlib.figure import Figure
from rcskin.localization.evaluation.report import draw_skin_outline
from rcskin.simulator.scene.scene_files import load_scene

GLOVE = load_scene("glove")


def lines(scene):
    """What is drawn of a scene, by label, mm."""
    axes = Figure().subplots()
    draw_skin_outline(axes, scene and scene.parts.skin)
    return {str(line.get_label()): line.get_xydata() for line in axes.lines}


def test_a_rectangle_is_drawn_with_the_foils_of_both_sheets():
    outline, top, bottom = lines(GLOVE).values()
    np.testing.assert_allclose(outline.min(axis=0), 0)
    np.testing.assert_allclose(outline.max(axis=0), [90, 60])
    np.testing.assert_array_less(bottom[:, 0], top[:, 0])
    for foil in (top, bottom):
        assert -5 < foil[:, 0].min() and foil[:, 0].max() < 0
        np.testing.assert_allclose(np.ptp(foil[:, 1]), 60)


def test_holes_are_drawn_and_foils_lie_in_their_circle():
    around = {"circle": [0.045, 0.03, 0.03], "holes": [{"circle": [0.045, 0.03, 0.01]}]}
    foils = {f"contact.{k}.edge": "hole1" for k in (1, 2)}
    drawn = [*lines(GLOVE.with_({"skin.outline": around, **foils})).values()]
    radii = [np.linalg.norm(line - [45, 30], axis=1) for line in drawn]
    assert [each.mean() for each in radii[:2]] == pytest.approx([30, 10])
    assert all(5 < each.mean() < 10 for each in radii[2:])
    assert max(np.ptp(each) for each in radii) < 0.02


def test_a_skin_of_no_known_scene_has_no_plan():
    assert not lines(None)

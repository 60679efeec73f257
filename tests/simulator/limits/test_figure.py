"""The sheet below a map of limits: its rim, its pixels and its foils."""

import numpy as np
import pytest
from matplotlib.collections import LineCollection
from matplotlib.colors import same_color
from matplotlib.figure import Figure
from rcskin.simulator.limits.figure import FOIL, draw_sheet
from rcskin.simulator.scene.files import load_scene

CORNERS = [[0, 0], [0.12, 0], [0.12, 0.06], [0.06, 0.06], [0.06, 0.12], [0, 0.12]]
L_SHAPE = {
    "skin.outline": {"points": CORNERS},
    "contact.1.edge": "outline.6",
    "contact.2.edge": "outline.1",
    "pixels": 2,
}


@pytest.fixture
def drawn():
    """mm of all lines of a colour on the sheet of an L."""
    axes = Figure().subplots()
    draw_sheet(axes, load_scene("sheet-3x3").with_(L_SHAPE))
    lines = [each for each in axes.collections if isinstance(each, LineCollection)]

    def length(colour):
        own = [each for each in lines if same_color(each.get_color(), colour)]
        ends = np.concatenate([each.get_segments() for each in own])
        return np.hypot(*(ends[:, 1] - ends[:, 0]).T).sum()

    return length


def test_an_outline_is_drawn_with_its_pixels_and_foils(drawn):
    assert drawn("black") == pytest.approx(480)
    assert drawn("0.4") == pytest.approx(120)
    assert [drawn(FOIL[sheet]) for sheet in ("top", "bottom")] == pytest.approx([120, 120])

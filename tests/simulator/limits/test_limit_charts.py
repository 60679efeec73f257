"""Maps of limits: outline, pixels and foils of the sheet."""

from contextlib import contextmanager
from itertools import combinations

import numpy as np
import pytest
from matplotlib.colors import same_color
from matplotlib.figure import Figure
from rcskin.simulator.bounds.position_bound import PositionBounds
from rcskin.simulator.chart_style import FOIL_COLOURS
from rcskin.simulator.limits import survey_results
from rcskin.simulator.limits.survey import Variant
from rcskin.simulator.limits.survey_results import draw_maps, draw_sheet
from rcskin.simulator.scene.scene_files import load_scene

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
    draw_sheet(axes, load_scene("sheet-3x3").with_(L_SHAPE).parts.skin)

    def length(colour):
        own = [each.get_xydata() for each in axes.lines if same_color(each.get_color(), colour)]
        return sum(np.nansum(np.hypot(*np.diff(line, axis=0).T)) for line in own)

    return length


def test_an_outline_is_drawn_with_its_pixels_and_foils(drawn):
    assert drawn("black") == pytest.approx(480)
    assert drawn("0.4") == pytest.approx(120, rel=5e-3)
    assert [drawn(FOIL_COLOURS[sheet]) for sheet in ("top", "bottom")] == pytest.approx([120, 120])


@pytest.mark.parametrize("sides", [(0.18, 0.07), (0.07, 0.18), (0.12, 0.12)])
@pytest.mark.parametrize("unresolved", [False, True])
def test_labels_of_maps_do_not_overlap_on_any_skin(sides, unresolved, monkeypatch, tmp_path):
    drawn = Figure(layout="constrained")

    @contextmanager
    def chart(path, width, height):
        drawn.set_size_inches(width, height)
        yield drawn

    monkeypatch.setattr(survey_results, "chart", chart)
    scene = load_scene("sheet-3x3").with_({"skin.length": sides[0], "skin.width": sides[1]})
    places = np.array(sides) * [[0.3, 0.3], [0.3, 0.7], [0.7, 0.3], [0.7, 0.7]]
    x = np.array([1e-3, 3e-3, 1e-2, 0.1])
    y = np.full(4, np.inf) if unresolved else x
    bounds = PositionBounds(places, x, y, x, np.zeros(4), sides)
    draw_maps(
        scene.parts.skin, [Variant("", str(k), bounds, x) for k in range(3)], "title", tmp_path
    )
    drawn.draw_without_rendering()
    boxes = [each.get_position() for each in drawn.axes if each.get_aspect() != "auto"]
    assert len(boxes) == 9
    assert len({round(box.x0, 6) for box in boxes}) == 3
    assert len({round(box.y0, 6) for box in boxes}) == 3
    words = [text for axes in drawn.axes for text in (axes.yaxis.label, *axes.texts)]
    taken = [text.get_window_extent() for text in words if text.get_text()]
    assert not any(one.overlaps(other) for one, other in combinations(taken, 2))

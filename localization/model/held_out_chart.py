"""Small chart of a trained localizer: how well it answers the sweeps held out of its training."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...simulator.chart_style import COLOURS
from ...simulator.notebook_display import SmallChart
from ...simulator.report.findings import rate_bars
from ..trust.answers import CountedRate, with_intervals
from ..trust.fitted import Classifier

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ...simulator.scene.parts import Skin
    from .localizer_model import Model

PLACES = 100
"""Number of places around a circle."""


def held_out_chart(model: Model) -> SmallChart | None:
    """Rates of a classifier, or the median error on the skin; None if no sweep was held out."""
    learned = model.learned
    if isinstance(learned, Classifier):
        total = learned.held_out
        if not total:
            return None
        rates = {
            "most probable class right": CountedRate(learned.right, total, learned.independent),
            "answered": CountedRate(learned.answered, total),
        }
        return rate_bars(with_intervals(rates), 1 / len(learned.classes))
    scene, error = model.scene, learned.median_error
    return scene and SmallChart(lambda figure: _draw(figure, scene.parts.skin, error))


def _draw(figure: Figure, skin: Skin, error: float) -> None:
    """The skin from above, with a circle of the median error in mm around its middle."""
    from ...simulator.mesh.from_above import MM, draw_foils, draw_outline, draw_pixels

    axes = figure.subplots()
    axes.set_aspect("equal")
    axes.grid(False)
    draw_pixels(axes, skin)
    draw_outline(axes, skin)
    draw_foils(axes, skin, linewidth=2)
    middle, turn = MM * np.array(skin.sides) / 2, np.linspace(0, 2 * np.pi, PLACES)
    circle = middle[0] + error * np.cos(turn), middle[1] + error * np.sin(turn)
    axes.fill(*circle, color=COLOURS[2], alpha=0.6)
    axes.set_title(f"Circle: median error, {error:.3g} mm")
    axes.set_xlabel("x (mm)")
    axes.set_ylabel("y (mm)")

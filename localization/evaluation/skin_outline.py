"""Outline of a skin seen from above, for charts of places on it."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ...simulator.scene.parts import Skin


def draw_skin_outline(axes: Axes, skin: Skin | None) -> None:
    """Draw the skin's outline and foils, if known; not for a mesh from a file."""
    from ...simulator.report.from_above import draw_foils, draw_outline

    axes.grid(False)
    if skin is not None and skin.mesh is None:
        draw_outline(axes, skin, color="0.35", zorder=0.5)
        draw_foils(axes, skin, 3.0, clip_on=False, zorder=0.7)
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16))

"""A skin seen from above, for charts of places on it."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Sequence

    import xarray as xr
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

FOIL = {"top": "#D55E00", "bottom": "#0072B2"}
"""Vermilion and blue of M. Okabe and K. Ito, "Color Universal Design" (2008)."""
WIDTH = 3.0
"""Of foils, points."""


class Foil(NamedTuple):
    """On which sheet, top or bottom, and its line beside the edge in mm, shape (point, 2)."""

    electrode: str
    line: NDArray


class Plan(NamedTuple):
    """The lines around a skin and its holes, mm, each of shape (point, 2), and its foils."""

    outline: Sequence[NDArray]
    foils: Sequence[Foil]


def plan_of(sweeps: xr.Dataset) -> Plan | None:
    """Plan of the scene that the sweeps carry; None where they carry none, or a mesh."""
    import numpy as np

    from ...simulator.charts import foil_offset
    from ...simulator.scene.contacts import outwards, path
    from ...simulator.scene.files import parse_scene
    from ...simulator.scene.skin import curves
    from ...simulator.sweeps import InputError

    try:
        scene = parse_scene(str(sweeps.attrs.get("scene", "")), "scene")
    except InputError:
        return None
    if scene.skin.mesh is not None:
        return None
    marks = [
        np.union1d(each.marks, np.linspace(0, each.marks[-1], 181)) for each in curves(scene.skin)
    ]
    outline = [
        1e3 * np.array([curve.at(mark) for mark in along])
        for curve, along in zip(curves(scene.skin), marks, strict=True)
    ]
    foils = []
    for each in scene.contacts:
        line, off = path(each, scene.skin), foil_offset(each.electrode, max(scene.skin.sides))
        beside = line + off * outwards(line, scene.skin)
        foils.append(Foil(each.electrode, 1e3 * beside.T))
    return Plan(outline, foils)


def draw_plan(axes: Axes, plan: Plan) -> None:
    """Draw the skin's outline and its foils."""
    for line in plan.outline:
        axes.plot(*line.T, color="0.35", linewidth=1, zorder=0.5)
    named = set()
    for foil in plan.foils:
        axes.plot(
            *foil.line.T,
            color=FOIL[foil.electrode],
            linewidth=WIDTH,
            solid_capstyle="butt",
            clip_on=False,
            zorder=0.7,
            label=None if foil.electrode in named else f"foils of the {foil.electrode} sheet",
        )
        named.add(foil.electrode)
    if named:
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), frameon=False, fontsize=8)

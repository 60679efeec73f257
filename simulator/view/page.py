"""A page of its own to turn the skin about in any browser, offline: one file, drawn by plotly."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..charts import AT_REST
from ..sweeps import whole_file
from .painting import ARROW, BODY, GRID, ROLE_COLOURS, arrow_mesh, lifted, ribbon
from .surface import triangles

if TYPE_CHECKING:
    import plotly.graph_objects as go
    import pyvista as pv

    from .figure import Panel
    from .shown import Shown
    from .surface import Surface

Real = NDArray[np.float64]
COLOURS = 33
"""Of a colour map, as many as the page is given."""
MILLI = 1e3
RAISED = 3.0
"""Times as far above the skin as in pictures."""
FLAT = {"ambient": 0.85, "diffuse": 0.25, "specular": 0.0, "roughness": 1.0}


def write_page(path: Path, panels: Sequence[Panel], title: str) -> None:
    """Write an HTML page with a slider over the panels, whole or not at all."""
    import plotly.graph_objects as go

    groups = [_traces(panel) for panel in panels]
    for number, group in enumerate(groups):
        for trace in group:
            trace.visible = number == 0
    owners = [number for number, group in enumerate(groups) for _ in group]
    figure = go.Figure([trace for group in groups for trace in group], _layout(panels, title))
    if len(panels) > 1:
        figure.update_layout(sliders=[_slider(panels, owners)])
    with whole_file(path) as unfinished:
        figure.write_html(unfinished, include_plotlyjs=True, div_id="skin", default_height="92vh")


def _layout(panels: Sequence[Panel], title: str) -> dict[str, Any]:
    camera = panels[0].camera
    hidden = {"visible": False}
    axes = (camera.towards, camera.up)
    towards, up = (
        {axis: float(v) for axis, v in zip("xyz", vector, strict=True)} for vector in axes
    )
    return {
        "title": {"text": title, "x": 0.5},
        "scene": {
            **dict.fromkeys(("xaxis", "yaxis", "zaxis"), hidden),
            "aspectmode": "data",
            "camera": {
                "eye": {axis: 1.3 * v for axis, v in towards.items()},
                "up": up,
                "projection": {"type": "orthographic"},
            },
        },
        "annotations": [_heading(panels[0].shown)],
        "margin": {"l": 10, "r": 10, "t": 60, "b": 10},
        "font": {"family": "DejaVu Sans, Arial, sans-serif", "size": 14, "color": "#222222"},
    }


def _heading(shown: Shown) -> dict[str, Any]:
    lines = [f"<b>{shown.title}</b>", shown.moment, shown.note]
    return {
        "text": "<br>".join(filter(None, lines)),
        "showarrow": False,
        **{"xref": "paper", "yref": "paper", "x": 0.0, "y": 1.0},
        "align": "left",
    }


def _slider(panels: Sequence[Panel], owners: Sequence[int]) -> dict[str, Any]:
    steps = [
        {
            "label": "",
            "method": "update",
            "args": [
                {"visible": [owner == number for owner in owners]},
                {"annotations": [_heading(panel.shown)]},
            ],
        }
        for number, panel in enumerate(panels)
    ]
    return {"steps": steps, "currentvalue": {"visible": False}, "ticklen": 4}


def _traces(panel: Panel) -> list[Any]:
    scenery, shown = panel.scenery, panel.shown
    skin, marks = scenery.skin, scenery.marks
    traces: list[Any] = [_field(skin, shown), *(_surface(body, BODY) for body in scenery.bodies)]
    for foil in marks.foils:
        surface = _surface(ribbon(foil), ROLE_COLOURS[foil.role])
        surface.update(name=f"{foil.name} ({foil.role})", hoverinfo="name")
        traces.append(surface)
    for lines, colour, width in (
        (marks.pixels, GRID, 1.5),
        (marks.rim, AT_REST, 2),
        (shown.contours, "#FFFFFF", 2),
        (marks.pressed, AT_REST, 6),
    ):
        if lines:
            traces.append(_lines(skin, lines, colour, width))
    if shown.arrows is not None and shown.arrows.places.size:
        traces.append(_surface(arrow_mesh(shown.arrows), ARROW))
    return traces


def _field(skin: Surface, shown: Shown) -> go.Mesh3d:
    import plotly.graph_objects as go

    value = f"%{{customdata[2]:.4g}} {shown.unit}"
    told = np.vstack([MILLI * skin.x, shown.values]).T
    return go.Mesh3d(
        **_corners(skin.points, triangles(skin.cells)),
        intensity=shown.values.astype(np.float32),
        customdata=told.astype(np.float32),
        hovertemplate=f"x %{{customdata[0]:.1f}} mm, y %{{customdata[1]:.1f}} mm<br>{value}"
        "<extra></extra>",
        colorscale=_colour_scale(shown.colours),
        cmin=shown.limits[0],
        cmax=shown.limits[1],
        colorbar={"title": {"text": shown.unit}, "len": 0.75},
        lighting=FLAT,
    )


def _colour_scale(name: str) -> list[list[float | str]]:
    from matplotlib import colormaps
    from matplotlib.colors import to_hex

    return [[float(at), to_hex(colormaps[name](at))] for at in np.linspace(0, 1, COLOURS)]


def _corners(points: Real, cells: NDArray[np.int64]) -> dict[str, Any]:
    places = dict(zip("xyz", (MILLI * points).astype(np.float32), strict=True))
    return {**places, **dict(zip("ijk", cells.astype(np.int32), strict=True))}


def _surface(mesh: pv.PolyData, colour: str) -> go.Mesh3d:
    import plotly.graph_objects as go

    cells = mesh.triangulate().regular_faces.T
    corners = _corners(np.asarray(mesh.points, dtype=float).T, cells)
    return go.Mesh3d(**corners, color=colour, lighting=FLAT, hoverinfo="skip")


def _lines(skin: Surface, lines: Sequence[Real], colour: str, width: float) -> go.Scatter3d:
    import plotly.graph_objects as go

    gap = np.full((3, 1), np.nan)
    points = np.hstack(
        [part for line in lines for part in (MILLI * lifted(line, skin, RAISED), gap)]
    )
    return go.Scatter3d(
        **dict(zip("xyz", points.astype(np.float32), strict=True)),
        mode="lines",
        line={"color": colour, "width": width},
        hoverinfo="skip",
        showlegend=False,
    )

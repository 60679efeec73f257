"""Page to turn the skin on in any browser, offline: one file, drawn by plotly."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Integer, Real
from ..chart_style import UNPRESSED_COLOUR
from ..safe_text import plotly_text
from ..sweeps import whole_file
from .painting import ARROW, BODY, GRID, arrow_mesh, foil_colours, lifted, ribbon
from .skin_surface import triangles

if TYPE_CHECKING:
    import plotly.graph_objects as go
    import pyvista as pv

    from .displayed_quantity import DisplayedQuantity
    from .figure import Panel
    from .skin_surface import SkinSurface

COLOURS = 33
"""Number of colours of a colour map in the page."""
MILLI = 1e3
LINE_HEIGHT, TEXT_HEIGHT = 2.0, 20.0
"""Heights of wide lines, and of words on a curved skin, over that of fine lines."""
MARGIN_FACTOR = 1.04
"""Room given to the drawing over its size."""
HEAD, LINE, FOOT = 92, 21, 40
"""Room for headings, a line of the title, and foil names with the slider, pixels."""
TITLE_WIDTH = 45
BACKGROUND, TEXT_COLOUR, INVISIBLE = "#FFFFFF", "#222222", "rgba(0,0,0,0)"
FLAT = {"ambient": 0.85, "diffuse": 0.25, "specular": 0.0, "roughness": 1.0}
UNLIT = {"ambient": 1.0, "diffuse": 0.0, "specular": 0.0, "roughness": 1.0}
MID_LUMINANCE = 0.179
"""Luminance with which black and white have equal contrast."""
FIT_SCRIPT = """
const skin = document.getElementById("{plot_id}");
const [halfWidth, halfHeight] = [%.6g, %.6g];
function fit() {
  const size = skin._fullLayout._size, range = skin.layout.scene.xaxis.range;
  const scale = Math.min(1 / halfHeight, size.w / size.h / halfWidth);
  const ratio = scale * (range[1] - range[0]);
  Plotly.relayout(skin, {"scene.aspectratio": {x: ratio, y: ratio, z: ratio}});
}
fit();
window.addEventListener("resize", () => setTimeout(fit, 200));
"""
"""Script of the page.

In parallel projection half the visible height is 1, whatever the window.
"""


def write_page(path: Path, panels: Sequence[Panel], title: str) -> None:
    """Writes an HTML page with a slider over the panels, whole or not at all."""
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
        figure.write_html(
            unfinished,
            include_plotlyjs=True,
            div_id="skin",
            default_height="97vh",
            post_script=FIT_SCRIPT % _half_extent(panels),
        )


def _layout(panels: Sequence[Panel], title: str) -> dict[str, Any]:
    camera = panels[0].camera
    towards, up = (
        {axis: float(v) for axis, v in zip("xyz", vector, strict=True)}
        for vector in (camera.towards, camera.up)
    )
    middle, reach = _ball_around(panels)
    axes = {
        f"{axis}axis": {"visible": False, "range": [float(at - reach), float(at + reach)]}
        for axis, at in zip("xyz", middle, strict=True)
    }
    scale = 1 / max(_half_extent(panels))
    lines = [*map(plotly_text, textwrap.wrap(title, TITLE_WIDTH))]
    return {
        "title": {
            "text": "<br>".join(lines),
            "font": {"size": 17},
            "subtitle": {"text": _heading(panels[0].shown)},
            **{"x": 0.02, "yref": "container", "y": 1.0, "yanchor": "top", "pad": {"t": 10}},
        },
        "scene": {
            **axes,
            "aspectmode": "manual",
            "aspectratio": dict.fromkeys("xyz", 2 * reach * scale),
            "dragmode": "orbit",
            "camera": {
                "eye": {axis: 1.3 * v for axis, v in towards.items()},
                "up": up,
                "projection": {"type": "orthographic"},
            },
        },
        "legend": {"orientation": "h", "x": 0.0, "y": 0.0, "yanchor": "top"},
        "margin": {"l": 10, "r": 10, "t": HEAD + LINE * len(lines), "b": FOOT},
        "paper_bgcolor": BACKGROUND,
        "font": {"family": "DejaVu Sans, Arial, sans-serif", "size": 14, "color": TEXT_COLOUR},
    }


def _ball_around(panels: Sequence[Panel]) -> tuple[Real, float]:
    """Middle of all that is drawn, as the camera sees it, and its radius, mm."""
    camera, places = (
        panels[0].camera,
        MILLI * np.hstack([_surface_corners(panel) for panel in panels]),
    )
    depths = camera.towards @ places
    across, height = MILLI * (camera.low + camera.high) / 2
    depth = (depths.min() + depths.max()) / 2
    middle = across * camera.right + height * camera.up + depth * camera.towards
    return middle, float(np.linalg.norm(places - middle[:, None], axis=0).max()) * MARGIN_FACTOR


def _surface_corners(panel: Panel) -> Real:
    """Corners of all surfaces, m, (3, n)."""
    scenery = panel.scenery
    bodies = [np.asarray(body.points, dtype=float).T for body in scenery.bodies]
    ribbons = [foil.quads.reshape(3, -1) for foil in scenery.marks.foils]
    return np.hstack([scenery.skin.points, *bodies, *ribbons])


def _half_extent(panels: Sequence[Panel]) -> tuple[float, float]:
    """Half the width and the height of what the camera sees, with a margin, mm."""
    camera = panels[0].camera
    width, height = MARGIN_FACTOR * MILLI * (camera.high - camera.low) / 2
    return float(width), float(height)


def _heading(shown: DisplayedQuantity) -> str:
    title, *more = map(plotly_text, (shown.title, shown.moment, shown.note))
    return "<br>".join(filter(None, (f"<b>{title}</b>", *more)))


def _slider(panels: Sequence[Panel], owners: Sequence[int]) -> dict[str, Any]:
    alone = len({panel.shown.title for panel in panels}) == 1
    steps = [
        {
            "label": _slider_label(panel.shown, alone),
            "method": "update",
            "args": [
                {"visible": [owner == number for owner in owners]},
                {"title.subtitle.text": _heading(panel.shown)},
            ],
        }
        for number, panel in enumerate(panels)
    ]
    prefix = "Frequency: " if alone else ""
    return {
        "steps": steps,
        "currentvalue": {"prefix": prefix, "xanchor": "right", "font": {"color": TEXT_COLOUR}},
        "font": {"color": TEXT_COLOUR if alone else INVISIBLE},
        "ticklen": 4,
        "pad": {"t": 8, "b": 0, "l": 10, "r": 10},
    }


def _slider_label(shown: DisplayedQuantity, single: bool) -> str:
    named = shown.frequency if single else ", ".join(filter(None, (shown.title, shown.frequency)))
    return plotly_text(named)


def _traces(panel: Panel) -> list[Any]:
    scenery, shown = panel.scenery, panel.shown
    skin, marks = scenery.skin, scenery.marks
    traces: list[Any] = [_field(skin, shown, panel.camera.above)]
    traces += [_surface(body, BODY) for body in scenery.bodies]
    colours = foil_colours(marks.foils)
    for foil in marks.foils:
        surface = _surface(ribbon(foil), colours[foil.name])
        surface.update(name=plotly_text(foil.label), hoverinfo="name", showlegend=True)
        traces.append(surface)
    for lines, colour, width, lift in (
        (marks.pixels, GRID, 1.5, 1.0),
        (marks.rim, UNPRESSED_COLOUR, 2, 1.0),
        (shown.contours, "#FFFFFF", 2, 1.0),
        (marks.pressed, UNPRESSED_COLOUR, 6, LINE_HEIGHT),
    ):
        if lines:
            raised = [lifted(line, skin, lift) for line in lines]
            traces.append(_lines(raised, colour, width))
    if shown.arrows is not None and shown.arrows.places.size:
        traces.append(_surface(arrow_mesh(shown.arrows), ARROW))
    return [*traces, _pixel_names(panel)]


def _pixel_names(panel: Panel) -> go.Scatter3d:
    """Row,column in the middle of each pixel, in black or white for contrast."""
    import plotly.graph_objects as go

    skin, middles = panel.scenery.skin, panel.scenery.marks.middles
    rows, columns = np.nonzero(np.isfinite(middles).all(axis=0))
    places = middles[:, rows, columns]
    points = MILLI * lifted(places, skin, 1.0 if panel.camera.above else TEXT_HEIGHT)
    pale = _luminance(panel.shown)[skin.nearest(places)] > MID_LUMINANCE
    return go.Scatter3d(
        **dict(zip("xyz", points.astype(np.float32), strict=True)),
        mode="text",
        text=[f"{row + 1},{column + 1}" for row, column in zip(rows, columns, strict=True)],
        textposition="middle center",
        textfont={"size": 11, "color": np.where(pale, UNPRESSED_COLOUR, "#FFFFFF")},
        name="row,column",
        hoverinfo="skip",
    )


def _luminance(shown: DisplayedQuantity) -> Real:
    """Relative luminance of the colour at each point, (point,), by WCAG 2.2."""
    from matplotlib import colormaps
    from matplotlib.colors import Normalize

    red_green_blue = colormaps[shown.colours](Normalize(*shown.limits)(shown.values))[:, :3]
    linear = np.where(
        red_green_blue <= 0.04045, red_green_blue / 12.92, ((red_green_blue + 0.055) / 1.055) ** 2.4
    )
    return linear @ np.array([0.2126, 0.7152, 0.0722])


def _field(skin: SkinSurface, shown: DisplayedQuantity, unlit: bool) -> go.Mesh3d:
    import plotly.graph_objects as go

    value = f"%{{customdata[2]:.4g}} {shown.unit}"
    hover_values = np.vstack([MILLI * skin.x, shown.values]).T
    return go.Mesh3d(
        **_corners(skin.points, triangles(skin.cells)),
        intensity=shown.values.astype(np.float32),
        customdata=hover_values.astype(np.float32),
        hovertemplate=f"x %{{customdata[0]:.1f}} mm, y %{{customdata[1]:.1f}} mm<br>{value}"
        "<extra></extra>",
        colorscale=_colour_scale(shown.colours),
        cmin=shown.limits[0],
        cmax=shown.limits[1],
        colorbar={"title": {"text": shown.unit}, "len": 0.9},
        lighting=UNLIT if unlit else FLAT,
    )


def _colour_scale(name: str) -> list[list[float | str]]:
    from matplotlib import colormaps
    from matplotlib.colors import to_hex

    return [[float(at), to_hex(colormaps[name](at))] for at in np.linspace(0, 1, COLOURS)]


def _corners(points: Real, cells: Integer) -> dict[str, Any]:
    places = dict(zip("xyz", (MILLI * points).astype(np.float32), strict=True))
    return {**places, **dict(zip("ijk", cells.astype(np.int32), strict=True))}


def _surface(mesh: pv.PolyData, colour: str) -> go.Mesh3d:
    import plotly.graph_objects as go

    cells = mesh.triangulate().regular_faces.T
    corners = _corners(np.asarray(mesh.points, dtype=float).T, cells)
    return go.Mesh3d(**corners, color=colour, lighting=FLAT, hoverinfo="skip")


def _lines(lines: Sequence[Real], colour: str, width: float) -> go.Scatter3d:
    import plotly.graph_objects as go

    gap = np.full((3, 1), np.nan)
    points = MILLI * np.hstack([part for line in lines for part in (line, gap)])
    return go.Scatter3d(
        **dict(zip("xyz", points.astype(np.float32), strict=True)),
        mode="lines",
        line={"color": colour, "width": width},
        hoverinfo="skip",
        showlegend=False,
    )

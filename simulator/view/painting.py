"""Draws pictures off screen, on any machine."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..arrays import Real
from ..chart_style import COLOURS, UNPRESSED_COLOUR
from ..sweeps import InputError
from .skin_surface import polygons

if TYPE_CHECKING:
    from ctypes import CDLL

    import pyvista as pv
    from pyvista.plotting.themes import Theme

    from .camera import Camera
    from .displayed_quantity import DisplayedQuantity
    from .foils import Foil
    from .marks import Arrows, Marks
    from .skin_surface import SkinSurface

WINDOW_CLASS = "VTK_DEFAULT_OPENGL_WINDOW"
ON_EGL, ON_MESA = "vtkEGLRenderWindow", "vtkOSOpenGLRenderWindow"
"""Window classes that draw without any display."""


def has_display() -> bool:
    """True if a window can be opened."""
    if not sys.platform.startswith("linux"):
        return True
    return bool(os.environ.get("DISPLAY")) and bool(_library("libGL.so.1")) and _x_server_answers()


def _library(name: str) -> CDLL | None:
    """Library of the system; None if it is not installed."""
    from ctypes import CDLL

    try:
        return CDLL(name)
    except OSError:
        return None


def _x_server_answers() -> bool:
    from ctypes import c_char_p, c_void_p

    x11 = _library("libX11.so.6")
    if x11 is None:
        return False
    x11.XOpenDisplay.restype, x11.XOpenDisplay.argtypes = c_void_p, [c_char_p]
    display = x11.XOpenDisplay(None)
    if display:
        x11.XCloseDisplay.argtypes = [c_void_p]
        x11.XCloseDisplay(display)
    return bool(display)


@contextmanager
def off_screen(width: int, height: int) -> Iterator[pv.Plotter]:
    """Plotter of that size in pixels that needs no display.

    Raises InputError as `check_drawing` does.
    """
    import pyvista as pv

    with _window_class_without_screen():
        plotter = pv.Plotter(off_screen=True, window_size=[width, height], theme=_theme())
        try:
            yield plotter
        finally:
            plotter.close()


@contextmanager
def _window_class_without_screen() -> Iterator[None]:
    chosen = _window_class()
    if chosen is None:
        yield
        return
    os.environ[WINDOW_CLASS] = chosen
    try:
        yield
    finally:
        del os.environ[WINDOW_CLASS]


def check_drawing() -> None:
    """Raises InputError if there is nothing to draw with; VTK would crash then."""
    _window_class()


def _window_class() -> str | None:
    """Window class for drawing off screen; None leaves the choice to VTK.

    It is None on other systems than Linux, if a class is chosen already, and if only a display can
    draw.
    """
    if not sys.platform.startswith("linux") or WINDOW_CLASS in os.environ:
        return None
    if _egl_has_a_device():
        return ON_EGL
    if _library("libOSMesa.so.8"):
        return ON_MESA
    if has_display():
        return None
    raise InputError(
        "pictures need libEGL with a driver, libOSMesa or a display (Debian: apt install libegl1)"
    )


def _egl_has_a_device() -> bool:
    from ctypes import CFUNCTYPE, byref, c_char_p, c_int, c_uint, c_void_p

    egl = _library("libEGL.so.1")
    if egl is None:
        return False
    egl.eglGetProcAddress.restype, egl.eglGetProcAddress.argtypes = c_void_p, [c_char_p]
    address = egl.eglGetProcAddress(b"eglQueryDevicesEXT")
    count = c_int(0)
    ask = CFUNCTYPE(c_uint, c_int, c_void_p, c_void_p)
    return bool(address) and bool(ask(address)(0, None, byref(count))) and count.value > 0


def _theme() -> Theme:
    from pyvista.plotting.themes import DocumentTheme

    theme = DocumentTheme()
    theme.multi_samples = 8
    return theme


Image = NDArray[np.uint8]

ROLE_COLOURS = {"high": COLOURS[1], "low": COLOURS[0], "floating": "#5A5A5A"}
PALER = (1.0, 0.5, 0.75, 0.25)
"""Fractions of their role's colour that foils of one role get, in turn."""
LINE_LIFT = 2e-3
"""Height of lines above the skin over its size."""

BODY, ARROW, GRID = "#F2EEE8", "#FFFFFF", "#7F7F7F"


HALO, SHADE = 0.3, 0.5
"""Opacities of the white and the black of the lines between pixels."""


def under_grid(colours: Real) -> Real:
    """Colours, as fractions from 0 to 1, as visible under the lines between pixels."""
    return (1 - SHADE) * ((1 - HALO) * colours + HALO)


@dataclass(frozen=True)
class Scenery:
    """Everything in the picture but the field: the marks and what the skin lies on."""

    skin: SkinSurface
    marks: Marks
    bodies: tuple[pv.PolyData, ...] = ()


def paint(scenery: Scenery, shown: DisplayedQuantity, camera: Camera, pixels: int) -> Image:
    """Picture (height, width, 3) without any text.

    pixels: number along its longer side.
    """
    width, height = camera.high - camera.low
    scale = pixels / max(width, height)
    with off_screen(round(scale * width), round(scale * height)) as plotter:
        add_all(plotter, scenery, shown, lit=not camera.above, towards=camera.towards)
        camera.aim(plotter)
        image = plotter.screenshot(return_img=True)
    assert image is not None
    return np.asarray(image)


def add_all(
    plotter: pv.Plotter,
    scenery: Scenery,
    shown: DisplayedQuantity,
    *,
    lit: bool,
    towards: Real | None = None,
) -> None:
    """Puts field and scenery into a plotter.

    lit: True for shading, for shapes in space. towards: unit vector to the eye, (3,), if the eye
    stays there: then nothing stands out behind the edge of what is visible.
    """
    skin, marks = scenery.skin, scenery.marks
    _add_field(plotter, skin, shown, lit)
    for body in scenery.bodies:
        plotter.add_mesh(body, color=BODY, ambient=0.6, diffuse=0.42, smooth_shading=True)
    colours = foil_colours(marks.foils)
    for foil in marks.foils:
        plotter.add_mesh(ribbon(foil), color=colours[foil.name], lighting=False)
    for lines, colour, width, opacity, lift in (
        (marks.pixels, "#FFFFFF", 2.5, HALO, 1.0),
        (marks.pixels, UNPRESSED_COLOUR, 1.0, SHADE, 1.0),
        (marks.rim, UNPRESSED_COLOUR, 1.5, 1.0, 1.0),
        (shown.contours, "#FFFFFF", 1.5, 0.8, 1.0),
        (marks.pressed, "#FFFFFF", 7.0, 1.0, 1.5),
        (marks.pressed, UNPRESSED_COLOUR, 3.0, 1.0, 1.5),
    ):
        raised = [lifted(line, skin, lift, towards) for line in lines]
        _add_lines(plotter, raised, colour, width, opacity)
    visible = shown.arrows if shown.arrows is None else shown.arrows.facing(skin, towards)
    if visible is not None and visible.places.size:
        plotter.add_mesh(arrow_mesh(visible), color=ARROW, ambient=0.75, diffuse=0.25)


def _add_field(plotter: pv.Plotter, skin: SkinSurface, shown: DisplayedQuantity, lit: bool) -> None:
    mesh = polygons(skin.points, skin.cells)
    mesh.point_data["shown"] = shown.values
    mesh.point_data["normals"] = skin.normals.T
    mesh.point_data.active_normals_name = "normals"
    plotter.add_mesh(
        mesh,
        scalars="shown",
        cmap=shown.colours,
        clim=shown.limits,
        n_colors=256,
        interpolate_before_map=not shown.cyclic,
        show_scalar_bar=False,
        lighting=lit,
        ambient=0.8,
        diffuse=0.25,
    )


def foil_colours(foils: Sequence[Foil]) -> dict[str, str]:
    """Colour of each foil by name: its role's, paler for other foils of that role."""
    from matplotlib.colors import to_hex, to_rgb

    counts = dict.fromkeys(ROLE_COLOURS, 0)
    colours = {}
    for foil in foils:
        share = PALER[counts[foil.role] % len(PALER)]
        counts[foil.role] += 1
        mixed = 1 - share * (1 - np.array(to_rgb(ROLE_COLOURS[foil.role])))
        colours[foil.name] = to_hex(mixed.tolist())
    return colours


def ribbon(foil: Foil) -> pv.PolyData:
    """Foil for pyvista."""
    corners = foil.quads.reshape(3, -1)
    cells = np.arange(corners.shape[1]).reshape(4, -1)
    return polygons(corners, cells)


def _add_lines(
    plotter: pv.Plotter, lines: Sequence[Real], colour: str, width: float, opacity: float
) -> None:
    if not lines:
        return
    import pyvista as pv

    counts = np.array([line.shape[1] for line in lines])
    ends = zip(counts, np.cumsum(counts), strict=True)
    parts = [np.array([n, *range(end - n, end)]) for n, end in ends]
    points = np.ascontiguousarray(np.hstack(lines).T)
    mesh = pv.PolyData(points, lines=np.concatenate(parts))
    plotter.add_mesh(mesh, color=colour, line_width=width, opacity=opacity, lighting=False)


def lifted(line: Real, skin: SkinSurface, times: float = 1.0, towards: Real | None = None) -> Real:
    """Line (3, n) on the skin, raised a little to be visible.

    It is raised off the skin, or towards an eye (3,).
    """
    way = skin.normals_near(line) if towards is None else towards[:, None]
    return line + times * LINE_LIFT * skin.size * way


def arrow_mesh(arrows: Arrows) -> pv.PolyData:
    """Arrows for pyvista, with their middles at their places."""
    import pyvista as pv

    starts = arrows.places - 0.5 * arrows.length * arrows.directions
    cloud = pv.PolyData(np.ascontiguousarray(starts.T))
    cloud.point_data["along"] = arrows.directions.T
    shape = pv.Arrow(tip_length=0.42, tip_radius=0.17, shaft_radius=0.05, tip_resolution=16)
    glyphs = cloud.glyph(orient="along", scale=False, factor=arrows.length, geom=shape)
    assert isinstance(glyphs, pv.PolyData)
    return glyphs

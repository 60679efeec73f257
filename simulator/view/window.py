"""Where pictures are drawn: off screen, on any machine, or in a window where there is a display."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pyvista as pv
    from pyvista.plotting.themes import Theme

WINDOW_CLASS = "VTK_DEFAULT_OPENGL_WINDOW"
WITHOUT_SCREEN = {
    "libEGL.so.1": "vtkEGLRenderWindow",
    "libOSMesa.so.8": "vtkOSOpenGLRenderWindow",
}
"""By the library that it needs, the window class that draws without any display."""


def has_display() -> bool:
    """Whether a window can be opened."""
    if not sys.platform.startswith("linux"):
        return True
    return bool(os.environ.get("DISPLAY")) and _x_server_answers()


def _x_server_answers() -> bool:
    from ctypes import CDLL, c_char_p, c_void_p

    try:
        x11 = CDLL("libX11.so.6")
    except OSError:
        return False
    x11.XOpenDisplay.restype, x11.XOpenDisplay.argtypes = c_void_p, [c_char_p]
    display = x11.XOpenDisplay(None)
    if display:
        x11.XCloseDisplay.argtypes = [c_void_p]
        x11.XCloseDisplay(display)
    return bool(display)


@contextmanager
def off_screen(width: int, height: int) -> Iterator[pv.Plotter]:
    """A plotter of that size in pixels that needs no display."""
    import pyvista as pv

    with _window_class_without_screen():
        plotter = pv.Plotter(off_screen=True, window_size=[width, height], theme=_theme())
        try:
            yield plotter
        finally:
            plotter.close()


@contextmanager
def _window_class_without_screen() -> Iterator[None]:
    """Left to VTK where there is no X, or where a class is chosen already."""
    if not sys.platform.startswith("linux") or WINDOW_CLASS in os.environ:
        yield
        return
    os.environ[WINDOW_CLASS] = _class_without_screen()
    try:
        yield
    finally:
        del os.environ[WINDOW_CLASS]


def _class_without_screen() -> str:
    from ctypes import CDLL

    for library, window_class in WITHOUT_SCREEN.items():
        with suppress(OSError):
            CDLL(library)
            return window_class
    raise RuntimeError(
        "pictures need the library libEGL or libOSMesa (Debian: apt-get install libegl1)"
    )


def window(title: str, count: int) -> pv.Plotter:
    """A plotter of that many views side by side, in a window of its own."""
    import pyvista as pv

    return pv.Plotter(title=title, shape=(1, count), window_size=[900, 800], theme=_theme())


def _theme() -> Theme:
    from pyvista.plotting.themes import DocumentTheme

    theme = DocumentTheme()
    theme.multi_samples = 8
    return theme

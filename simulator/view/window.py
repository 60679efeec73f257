"""Where pictures are drawn: off screen, on any machine, or in a window where there is a display."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pyvista as pv

DISPLAYS = ("DISPLAY", "WAYLAND_DISPLAY")
WINDOW_CLASS = "VTK_DEFAULT_OPENGL_WINDOW"
WITHOUT_SCREEN = {
    "libEGL.so.1": "vtkEGLRenderWindow",
    "libOSMesa.so.8": "vtkOSOpenGLRenderWindow",
}
"""By the library that it needs, the window class that draws without any display."""


def has_display() -> bool:
    """Whether a window can be opened."""
    return not sys.platform.startswith("linux") or any(os.environ.get(name) for name in DISPLAYS)


@contextmanager
def off_screen(width: int, height: int) -> Iterator[pv.Plotter]:
    """A plotter of that size in pixels that needs no display."""
    if not has_display() and WINDOW_CLASS not in os.environ:
        os.environ[WINDOW_CLASS] = _class_without_screen()
    import pyvista as pv

    plotter = pv.Plotter(off_screen=True, window_size=[width, height], theme=_theme())
    try:
        yield plotter
    finally:
        plotter.close()


def _class_without_screen() -> str:
    from ctypes import CDLL

    for library, window_class in WITHOUT_SCREEN.items():
        with suppress(OSError):
            CDLL(library)
            return window_class
    raise RuntimeError(
        "pictures without a display need the library libEGL or libOSMesa "
        "(Debian: apt-get install libegl1)"
    )


def window(title: str, count: int) -> pv.Plotter:
    """A plotter of that many views side by side, in a window of its own."""
    import pyvista as pv

    return pv.Plotter(title=title, shape=(1, count), window_size=[900, 800], theme=_theme())


def _theme() -> pv.plotting.themes.Theme:
    import pyvista as pv

    theme = pv.plotting.themes.DocumentTheme()
    theme.multi_samples = 8
    return theme

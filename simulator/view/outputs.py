"""What comes of fields by the kind of file: pictures, movies, files for ParaView, a page."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from ..sweeps import InputError, check_needs
from .quantities import Quantity, chosen
from .shown import at_frequencies, over_the_phase

if TYPE_CHECKING:
    from .figure import Panel
    from .scenery import Stage

MOVIES = (".gif", ".mp4")
PICTURES = (".png", *MOVIES)
DATA = (".vtu", ".xdmf")
ENDINGS = (*PICTURES, *DATA, ".html")
WRITTEN_BY = {".mp4": "imageio_ffmpeg", ".xdmf": "meshio", ".html": "plotly"}
"""Libraries that endings need besides that of all surfaces."""
SURFACES = "pyvista"
EXTRA = "view"
ANIMATIONS = ("frequency", "phase")
ACROSS = 3
"""Panels in a row, where all are of one frequency."""
PHASES = 24
"""Frames of one period."""
MOVIE_DPI = 100
LONGEST_PRESS = 60
ROOM_FOR_WORDS = 1.35
"""Times what is seen in a window, for its title and colour bar."""


def check_output(path: Path) -> None:
    """Raises InputError where what writes the file, or draws it, is not installed."""
    writer = WRITTEN_BY.get(path.suffix)
    check_needs(path, EXTRA, SURFACES, *([writer] if writer else []))
    if path.suffix in PICTURES:
        from .painting import check_drawing

        check_drawing()


def check_shown() -> None:
    """Raises InputError where what shows a window, or a page in its place, is not installed."""
    check_needs("--interactive", EXTRA, SURFACES, WRITTEN_BY[".html"])


def write_output(path: Path, stage: Stage, what: str, animate: str | None) -> None:
    """Write the fields in the way that the file's ending asks for, whole or not at all.

    Raises InputError where nothing of the kind can be shown, or written here.
    """
    check_output(path)
    write: Callable[[Path, Stage, str], None]
    if path.suffix in MOVIES:
        write = _write_phases if animate == "phase" else _write_frequencies
    else:
        write = {".png": _write_picture, ".html": write_turnable}.get(path.suffix, _write_data)
    write(path, stage, what)


def title(stage: Stage) -> str:
    """Scene, press and interface in one line."""
    press = str(stage.press) if stage.press.touches else ""
    if len(press) > LONGEST_PRESS:
        press = f"{press[:LONGEST_PRESS]}…"
    pressed = f"press {press}" if press else "at rest"
    return f"{stage.scene.name}, {pressed}, interface {stage.interface.name}"


def rows_of_panels(stage: Stage, what: str) -> list[list[Panel]]:
    """A row for each quantity with a panel for each frequency; rows of ACROSS if that is one."""
    rows = [panels_of(stage, quantity) for quantity in chosen(what, stage.fields)]
    if max(map(len, rows)) > 1:
        return rows
    panels = [row[0] for row in rows]
    return [panels[first : first + ACROSS] for first in range(0, len(panels), ACROSS)]


def panels_of(stage: Stage, quantity: Quantity, own: bool = False) -> list[Panel]:
    """A panel for each frequency, or the only one. own: each with a colour scale of its own."""
    skin = stage.skin(quantity)
    numbers = [0] if quantity.everywhere else range(len(stage.fields.frequency))
    return stage.panels(skin, at_frequencies(quantity, stage.fields, skin, numbers, own))


def _write_picture(path: Path, stage: Stage, what: str) -> None:
    from .figure import draw

    draw(path, rows_of_panels(stage, what), title(stage))


def write_turnable(path: Path, stage: Stage, what: str) -> None:
    """Write a page to turn the skin about in a browser."""
    from .page import write_page

    quantities = chosen(what, stage.fields)
    panels = [panel for quantity in quantities for panel in panels_of(stage, quantity, own=True)]
    write_page(path, panels, title(stage))


def _write_frequencies(path: Path, stage: Stage, what: str) -> None:
    if all(quantity.everywhere for quantity in chosen(what, stage.fields)):
        raise InputError(f"--what {what}: is the same at all frequencies; write a .png")
    rows = [panels_of(stage, quantity) for quantity in chosen(what, stage.fields)]
    frames = [
        [row[min(at, len(row) - 1)] for row in rows] for at in range(len(stage.fields.frequency))
    ]
    _write_frames(path, stage, frames)


def _write_phases(path: Path, stage: Stage, what: str) -> None:
    if what not in ("potential", "current"):
        raise InputError(f"--animate phase: --what must be potential or current, got {what!r}")
    rows = []
    for quantity in chosen(what, stage.fields):
        skin = stage.skin(quantity)
        shown = over_the_phase(quantity, stage.fields, skin, 0, PHASES)
        rows.append(stage.panels(skin, shown))
    _write_frames(path, stage, [list(panels) for panels in zip(*rows, strict=True)])


def _write_frames(path: Path, stage: Stage, frames: list[list[Panel]]) -> None:
    from .figure import rendered
    from .movie import write_movie
    from .painting import Image

    def images() -> Iterator[Image]:
        for panels in frames:
            rows = [panels[low : low + ACROSS] for low in range(0, len(panels), ACROSS)]
            yield rendered(rows, title(stage), MOVIE_DPI)

    used = {panel.shown.colours for panels in frames for panel in panels}
    write_movie(path, images(), used)


def _write_data(path: Path, stage: Stage, what: str) -> None:
    from ..scene.files import scene_text
    from .paraview import write_dataset

    about = {
        "scene": scene_text(stage.scene),
        "press": str(stage.press),
        "interface": stage.interface.name,
    }
    write_dataset(path, stage.fields, stage.plain_skin(), about)


def show(stage: Stage, what: str) -> None:
    """Open a window with the first frequency of each quantity and wait until it is closed."""
    from .painting import add_all, window

    panels = [panels_of(stage, quantity)[0] for quantity in chosen(what, stage.fields)]
    plotter = window(title(stage), len(panels))
    for number, panel in enumerate(panels):
        plotter.subplot(0, number)
        add_all(plotter, panel.scenery, panel.shown, lit=not panel.camera.above, bar=True)
        shown = panel.shown
        told = "\n".join(filter(None, (shown.title, shown.moment, shown.note)))
        plotter.add_text(told.replace("Ω", "ohm"), font_size=9, color="black")
        panel.camera.aim(plotter)
        plotter.camera.parallel_scale *= ROOM_FOR_WORDS
    plotter.show()

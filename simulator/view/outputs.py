"""Output of fields by the kind of file: picture, movie, file for ParaView."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING

from ..chart_style import ENDINGS as STILLS
from ..progress import ProgressCallback, silent, tracked
from ..sweeps import InputError, require_packages
from .displayed_quantity import at_frequencies, over_one_period
from .quantities import ViewedQuantity, chosen

if TYPE_CHECKING:
    from .figure import Panel
    from .scenery import ViewedPress

MOVIES = (".gif", ".mp4")
PICTURES = (*STILLS, *MOVIES)
DATA = (".vtu", ".xdmf")
ENDINGS = (*PICTURES, *DATA)
WRITTEN_BY = {".mp4": "imageio_ffmpeg", ".xdmf": "meshio"}
"""Libraries that endings need in addition to the one for all surfaces."""
SURFACES = "pyvista"
EXTRA = "view"
ANIMATIONS = ("frequency", "phase")
PANELS_PER_ROW = 3
"""Number of panels in a row if all are of one frequency."""
PHASES = 24
"""Number of frames of one period."""
MOVIE_DPI = 100
LONG_DRAWING = 60.0
"""Drawing time in seconds above which a movie is announced by a note."""
MAX_PRESS_TEXT = 60


def check_output(path: Path) -> None:
    """Raises InputError if a library that writes or draws the file is missing."""
    writer = WRITTEN_BY.get(path.suffix)
    require_packages(path, EXTRA, SURFACES, *([writer] if writer else []))
    if path.suffix in PICTURES:
        from .painting import check_drawing

        check_drawing()


def write_output(
    path: Path,
    stage: ViewedPress,
    what: str,
    animate: str | None,
    progress: ProgressCallback = silent,
    report: Callable[[str], None] = lambda note: None,
) -> None:
    """Writes the fields in the format of the file's ending, whole or not at all.

    progress: reports on a movie's pictures. report: receives a note on a movie that takes minutes.
    Raises InputError where nothing of the kind can be shown, or written here.
    """
    check_output(path)
    if path.suffix in MOVIES:
        panels = _period_panels if animate == "phase" else _frequency_panels
        _write_frames(path, stage, panels(stage, what), progress, report)
        return
    write = _write_picture if path.suffix in STILLS else _write_data
    write(path, stage, what)


def title(stage: ViewedPress) -> str:
    """Scene, press and interface in one line."""
    press = stage.press_text if stage.press.touches else ""
    if len(press) > MAX_PRESS_TEXT:
        press = f"{press[:MAX_PRESS_TEXT]}…"
    pressed = f"press {press}" if press else "unpressed"
    return f"{stage.parts.skin.name}, {pressed}, interface {stage.interface.name}"


def rows_of_panels(stage: ViewedPress, what: str) -> list[list[Panel]]:
    """Rows of panels: one for each quantity, with a panel for each frequency.

    If there is one panel for each quantity, rows have ACROSS panels.
    """
    rows = [panels_of(stage, quantity) for quantity in chosen(what, stage.fields)]
    if max(map(len, rows)) > 1:
        return rows
    return _in_rows([row[0] for row in rows])


def _in_rows(panels: list[Panel]) -> list[list[Panel]]:
    firsts = range(0, len(panels), PANELS_PER_ROW)
    return [panels[first : first + PANELS_PER_ROW] for first in firsts]


def panels_of(stage: ViewedPress, quantity: ViewedQuantity) -> list[Panel]:
    """Panels of a quantity, one for each frequency, or the only one."""
    skin = stage.surface(quantity)
    numbers = [0] if quantity.everywhere else range(len(stage.fields.frequency))
    return stage.panels(skin, at_frequencies(quantity, stage.fields, skin, numbers))


def _write_picture(path: Path, stage: ViewedPress, what: str) -> None:
    from .figure import draw

    draw(path, rows_of_panels(stage, what), title(stage))


def _frequency_panels(stage: ViewedPress, what: str) -> list[list[Panel]]:
    """Panels of each picture of a movie over the frequencies."""
    if all(quantity.everywhere for quantity in chosen(what, stage.fields)):
        raise InputError(
            f"--what {what}: is the same at all frequencies; write a picture, OUT.png, instead"
        )
    rows = [panels_of(stage, quantity) for quantity in chosen(what, stage.fields)]
    return [
        [row[min(at, len(row) - 1)] for row in rows] for at in range(len(stage.fields.frequency))
    ]


def _period_panels(stage: ViewedPress, what: str) -> list[list[Panel]]:
    """Panels of each picture of a movie over one period."""
    if what not in ("potential", "current"):
        raise InputError(f"--animate phase: --what must be potential or current, got {what!r}")
    rows = []
    for quantity in chosen(what, stage.fields):
        skin = stage.surface(quantity)
        shown = over_one_period(quantity, stage.fields, skin, 0, PHASES)
        rows.append(stage.panels(skin, shown))
    return [list(panels) for panels in zip(*rows, strict=True)]


def _write_frames(
    path: Path,
    stage: ViewedPress,
    frames: list[list[Panel]],
    progress: ProgressCallback,
    report: Callable[[str], None],
) -> None:
    from .figure import rendered
    from .movie import write_movie
    from .painting import Image

    def images() -> Iterator[Image]:
        start = monotonic()
        for number, panels in enumerate(tracked(frames, "drawing", progress)):
            yield rendered(_in_rows(panels), title(stage), MOVIE_DPI)
            left = (monotonic() - start) * (len(frames) - 1)
            if number == 0 and left > LONG_DRAWING:
                report(f"{path}: {len(frames)} pictures, about {max(1, round(left / 60))} min")

    used = {panel.shown.colours for panels in frames for panel in panels}
    write_movie(path, images(), used)


def _write_data(path: Path, stage: ViewedPress, what: str) -> None:
    from .paraview import write_dataset

    about = {
        "scene": stage.parts.text,
        "press": str(stage.press),
        "interface": stage.interface.name,
    }
    write_dataset(path, stage.fields, stage.plain_skin(), about)

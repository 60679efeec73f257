"""Output of fields by the kind of file: picture, movie, file for ParaView."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator
from contextlib import suppress
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..arrays import Real
from ..chart_style import ENDINGS as STILLS
from ..progress import ProgressCallback, silent, tracked
from ..sweeps import InputError, OutputError, require_packages, whole_file
from .displayed_quantity import at_frequencies, over_one_period
from .painting import PALER, ROLE_COLOURS, Image, under_grid
from .quantities import ViewedQuantity, chosen

if TYPE_CHECKING:
    from pyvista import UnstructuredGrid

    from ..models.solution import SolutionFields
    from .figure import Panel
    from .scenery import ViewedPress
    from .skin_surface import SkinSurface

FPS = 8
GREYS = 24


def write_movie(path: Path, frames: Iterable[Image], colour_maps: Collection[str]) -> None:
    """Writes frames (height, width, 3) as a GIF that loops or as an MP4.

    All frames have one size. colour_maps: names of the maps that a GIF, which has 256 colours, must
    reproduce.
    """
    with whole_file(path) as unfinished:
        if path.suffix == ".gif":
            _write_gif(unfinished, frames, _palette(colour_maps))
        else:
            _write_mp4(unfinished, frames)


def _palette(colour_maps: Collection[str]) -> NDArray[np.uint8]:
    """256 colours, (256, 3): the maps, greys, and those of foils.

    Foils have paler ones too, for smooth edges. Half of the maps' colours are as the lines between
    pixels make them.
    """
    from matplotlib import colormaps
    from matplotlib.colors import to_rgb

    foils = np.array([to_rgb(colour) for colour in ROLE_COLOURS.values()])
    paler = [1 - share * (1 - foils) for share in PALER]
    fixed = np.vstack([np.repeat(np.linspace(0, 1, GREYS)[:, None], 3, axis=1), *paler])
    each = (256 - len(fixed)) // (2 * len(colour_maps))
    maps = [colormaps[name](np.linspace(0, 1, each))[:, :3] for name in sorted(colour_maps)]
    colours = np.vstack([fixed, *maps, *(under_grid(colours) for colours in maps)])
    filled = np.vstack([colours, np.repeat(colours[-1:], 256 - len(colours), axis=0)])
    return np.round(255 * filled).astype(np.uint8)


def _write_gif(path: Path, frames: Iterable[Image], colours: NDArray[np.uint8]) -> None:
    import PIL.Image

    palette = PIL.Image.new("P", (1, 1))
    palette.putpalette(colours.tobytes())
    first, *others = (
        PIL.Image.fromarray(frame).quantize(palette=palette, dither=PIL.Image.Dither.NONE)
        for frame in frames
    )
    first.save(path, save_all=True, append_images=others, duration=1000 // FPS, loop=0)


def _write_mp4(path: Path, frames: Iterable[Image]) -> None:
    from imageio_ffmpeg import write_frames

    frames = iter(frames)
    first, count = next(frames), 1
    height, width, _ = first.shape
    writer = write_frames(
        str(path), (width, height), fps=FPS, quality=8, macro_block_size=2, output_params=["-an"]
    )
    writer.send(None)
    try:
        writer.send(first)
        for frame in frames:
            writer.send(frame)
            count += 1
    finally:
        writer.close()
    _check_movie(path, count)


def _check_movie(path: Path, count: int) -> None:
    """Raises OutputError if ffmpeg could not write all frames; it does not say so."""
    from imageio_ffmpeg import count_frames_and_secs

    with suppress(RuntimeError):
        if count_frames_and_secs(path)[0] == count:
            return
    raise OutputError("the movie could not be written whole; is the disk full?")


SHEETS = ("top", "bottom")
CELLS = {3: "triangle", 4: "quad"}


def write_dataset(
    path: Path, fields: SolutionFields, skin: SkinSurface, about: dict[str, str]
) -> None:
    """Writes .vtu or .xdmf, whole or not at all. about: texts kept in a VTU by name."""
    with whole_file(path) as unfinished:
        if path.suffix == ".vtu":
            _write_vtu(unfinished, fields, skin, about)
        else:
            _write_xdmf(unfinished, fields, skin)


def constant_fields(fields: SolutionFields) -> Iterator[tuple[str, Real]]:
    """Fields that are the same at all frequencies: name with unit, values by point."""
    yield "capacitance_F_per_m2", fields.capacitance
    yield "capacitance_factor", fields.factor
    yield "deflection_m", fields.deflection
    yield "flat_position_m", _in_space(fields.x)


def fields_at(fields: SolutionFields, at: int) -> Iterator[tuple[str, Real]]:
    """Fields at a frequency by number: name with unit, values by point."""
    for number, sheet in enumerate(SHEETS):
        V, J = fields.potential[number, at], fields.current[number, at]
        for part, take in (("re", np.real), ("im", np.imag)):
            yield f"potential_{sheet}_{part}_V", take(V)
            yield f"current_{sheet}_{part}_A_per_m", _in_space(take(J))
    V = fields.potential[0, at] - fields.potential[1, at]
    yield "potential_difference_V", np.abs(V)
    yield "potential_phase_deg", np.degrees(np.angle(V))
    yield "power_W_per_m2", fields.power[at]
    yield "sensitivity_ln_Rs_per_m2", fields.by_rise_Rs[at]
    yield "sensitivity_ln_Cp_per_m2", fields.by_rise_Cp[at]


def _in_space(vectors: Real) -> Real:
    """Flat vectors (2, point) as rows of three."""
    return np.vstack([vectors, np.zeros_like(vectors[:1])]).T


def _write_vtu(
    path: Path, fields: SolutionFields, skin: SkinSurface, about: dict[str, str]
) -> None:
    grid = skin.mesh.cast_to_unstructured_grid()
    for name, values in constant_fields(fields):
        grid.point_data[name] = values
    for at, frequency in enumerate(fields.frequency):
        for name, values in fields_at(fields, at):
            grid.point_data[f"{name}@{frequency:.9g}Hz"] = values
    grid.field_data["frequency_Hz"] = fields.frequency
    grid.field_data["Z_re_ohm"], grid.field_data["Z_im_ohm"] = fields.Z.real, fields.Z.imag
    for name, text in about.items():
        grid.field_data[name] = [
            text.encode("ascii", "backslashreplace").decode()
        ]  # VTK accepts ASCII only
    path.write_text(_xml(grid), encoding="ascii")


def _xml(grid: UnstructuredGrid) -> str:
    """Text that VTK would write itself; there a full disk would end the process."""
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

    writer = vtkXMLUnstructuredGridWriter()
    writer.SetInputData(grid)
    writer.SetDataModeToBinary()
    writer.WriteToOutputStringOn()
    writer.Write()
    return writer.GetOutputString()


def _write_xdmf(path: Path, fields: SolutionFields, skin: SkinSurface) -> None:
    from meshio.xdmf import TimeSeriesWriter

    with TimeSeriesWriter(path, data_format="XML") as writer:
        writer.write_points_cells(skin.points.T, [(CELLS[len(skin.cells)], skin.cells.T)])
        for at, frequency in enumerate(fields.frequency):
            data = {**dict(constant_fields(fields)), **dict(fields_at(fields, at))}
            writer.write_data(float(frequency), point_data=data)


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

    about = {
        "scene": stage.parts.text,
        "press": str(stage.press),
        "interface": stage.interface.name,
    }
    write_dataset(path, stage.fields, stage.plain_skin(), about)

"""One style for all charts: readable in print and by colour-blind readers."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .safe_text import figure_style, rendering
from .sweeps import InputError, checked_output, whole_file

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

    from .arrays import Real

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
"""Palette of M. Okabe and K. Ito, "Color Universal Design" (2008), darker colours first."""
LINE_STYLES = ("-", "--", ":", "-.", (0, (5, 1, 1, 1, 1, 1)))
UNPRESSED_COLOUR = "#000000"
FOIL_COLOURS = {"top": COLOURS[1], "bottom": COLOURS[0]}
"""Colour of the foils of each electrode sheet."""
FOIL_OFFSETS = {"top": 0.018, "bottom": 0.042}
"""Offset from the edge over the longer side: bottom foils are drawn outside the top ones."""
ENDINGS = (".png", ".svg", ".pdf")
"""File endings of charts: pixels for screens, vectors for papers."""
ROUND_DIGITS = ((1,), (1, 3), (1, 2, 5), (1, 1.5, 2, 3, 5, 7))
"""First digits of round numbers; the roundest set comes first."""
MIN_TICKS, MAX_TICKS = 4, 8
"""Numbers of labelled ticks on a logarithmic axis."""
PRINTED_DPI = 300
"""Resolution of pixel images within vector charts, dots per inch."""
UNDATED = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}
"""Metadata without a time stamp: the same chart gives the same bytes."""

STYLE: dict[Any, Any] = {
    "figure.dpi": 110,
    "savefig.dpi": 150,
    "pdf.fonttype": 42,
    "svg.hashsalt": "rcskin",
    "font.size": 9,
    "axes.titlesize": 10,
    "axes.grid": True,
    "grid.color": "0.88",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
    "legend.fontsize": 8,
    "lines.linewidth": 1.4,
}


def foil_offset(electrode: str, longer: float) -> float:
    """Distance outside the edge at which a sheet's foils are drawn, in the unit of `longer`."""
    return FOIL_OFFSETS[electrode] * longer


def frequency_axis(axes: Axes) -> None:
    """A logarithmic x axis of frequencies given in kHz."""
    logarithmic_axis(axes, "Frequency (kHz)")


def logarithmic_axis(axes: Axes, label: str) -> None:
    """A logarithmic x axis in plain numbers."""
    axes.set_xscale("log")
    plain_numbers(axes.xaxis)
    axes.set_xlabel(label)


def plain_numbers(axis: Axis) -> None:
    """Numbers such as 0.5 and 20 at a few ticks of a logarithmic axis or colour bar."""
    from matplotlib.ticker import Locator, NullFormatter

    class Round(Locator):
        def __call__(self) -> Real:
            assert self.axis is not None
            return self.tick_values(*self.axis.get_view_interval())

        def tick_values(self, vmin: float, vmax: float) -> Real:
            return round_numbers(vmin, vmax)

    axis.set_major_locator(Round())
    axis.set_major_formatter("{x:g}")
    axis.set_minor_formatter(NullFormatter())


def round_numbers(low: float, high: float) -> Real:
    """Round tick values between two numbers: at least MIN_TICKS, else evenly spaced ones.

    More than MAX_TICKS values are thinned to every second, third and so on.
    """
    from matplotlib.ticker import MaxNLocator

    decades = 10.0 ** np.arange(np.floor(np.log10(low)), np.ceil(np.log10(high)) + 1)
    for digits in ROUND_DIGITS:
        ticks = np.outer(decades, digits).ravel()
        inside = ticks[(low <= ticks) & (ticks <= high)]
        if len(inside) >= MIN_TICKS:
            return inside[:: -(-len(inside) // MAX_TICKS)]
    ticks = np.asarray(MaxNLocator(MAX_TICKS, min_n_ticks=MIN_TICKS).tick_values(low, high))
    return ticks[(low <= ticks) & (ticks <= high)]


def unit_axis(axis: Axis, name: str, unit: str) -> None:
    """Labels an axis with name and unit, with the SI prefix that suits the largest number.

    axis: everything is drawn already, in the unit without a prefix.
    """
    from matplotlib.ticker import EngFormatter, FuncFormatter

    largest = max(abs(end) for end in axis.get_view_interval())
    prefixes = EngFormatter.ENG_PREFIXES
    power = 3 * math.floor(math.log10(largest) / 3) if largest > 0 else 0
    power = min(max(power, min(prefixes)), max(prefixes))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value / 10.0**power:g}"))
    axis.set_label_text(f"{name} ({prefixes[power]}{unit})")


def checked_chart(path: str | Path, *more: str) -> Path:
    """Returns the path if a chart can be written there.

    more: further endings that are allowed. Raises InputError as `checked_output`, and where
    matplotlib does not start because the environment names an unknown backend.
    """
    checked = checked_output(path, (*ENDINGS, *more))
    try:
        import matplotlib  # noqa: F401, PLC0415
    except ValueError as error:
        backend = os.environ.get("MPLBACKEND")
        raise InputError(
            "the environment variable MPLBACKEND must name a backend of matplotlib, got "
            f"{backend!r}: unset it, charts need none"
        ) from error
    return checked


def checked_ending(name: str) -> str:
    """The file ending of charts for a name such as svg. Raises InputError for other names."""
    if f".{name}" not in ENDINGS:
        names = " or ".join(ending[1:] for ending in ENDINGS)
        raise InputError(f"--charts must be {names}, got {name!r}")
    return f".{name}"


@contextmanager
def chart(path: Path, width: float, height: float) -> Iterator[Figure]:
    """Yields a figure of this size in inches, then writes it whole; the path ends in ENDINGS."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    with figure_style(STYLE):
        figure = Figure(figsize=(width, height), layout="constrained")
        FigureCanvasAgg(figure)
        yield figure
        with rendering(figure), whole_file(path) as unfinished:
            dpi = None if path.suffix == ".png" else PRINTED_DPI
            figure.savefig(unfinished, dpi=dpi, metadata=UNDATED.get(path.suffix))

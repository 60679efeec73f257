"""Results of a survey of limits: tables, maps of bounds on position, distances of pixels."""

from __future__ import annotations

import itertools
import math
import textwrap
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Real
from ..bounds.position_bound import PositionBounds
from ..bounds.rasterization_errors import RasterizationErrors
from ..chart_style import COLOURS, LINE_STYLES, chart, plain_numbers
from ..measure.symmetry import describe_repeated
from ..mesh.from_above import MM, draw_foils, draw_outline, draw_pixels
from ..report.findings import Chart, DataTable, Findings, Head, Items
from ..scene.parts import SceneParts, Skin
from ..sweeps.units import bound_text
from .survey import SurveyOptions, Variant
from .touch_identity import IdentityBounds

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure

UNRESOLVED = "not resolved"


def rounded(value: float, unit: float = 1.0, digits: int = 4) -> float | str:
    """A rounded number in other units, or UNRESOLVED where it is infinite."""
    return float(f"{unit * value:.{digits}g}") if math.isfinite(value) else UNRESOLVED


def summary(variant: Variant) -> dict[str, Any]:
    """Summary of one variant; medians are over the sheet."""
    own = variant.bounds
    return {
        "comparison": variant.comparison,
        "variant": variant.name,
        "frequencies_Hz": variant.frequency.tolist(),
        "median_deviation_x_mm": rounded(float(np.median(own.x)), 1e3),
        "median_deviation_y_mm": rounded(float(np.median(own.y)), 1e3),
        "median_deviation_strength": rounded(float(np.median(own.strength))),
        "largest_deviation_x_mm": rounded(float(own.x.max()), 1e3),
        "largest_deviation_y_mm": rounded(float(own.y.max()), 1e3),
        "share_of_places_with_x": float(np.isfinite(own.x).mean()),
        "share_of_places_with_y": float(np.isfinite(own.y).mean()),
        "median_error_mm": rounded(own.median_error(), 1e3),
    }


MAX_ROWS = 14
"""Largest number of rows of the table on the terminal; all rows are in limits.json."""
WRITTEN = ("limits.csv", "limits.json", "pixels.*")
"""Name patterns of the written files."""
ERROR = (
    "error: median distance in the plane; a coordinate that is not resolved, or less precise than "
    "a guess, has the error of a guess over its range"
)


def _number(key: str, head: str | None = None) -> Head:
    return Head(key, head, str)


PLACES = ("comparison", "variant", *map(_number, ("x_mm", "y_mm")))
PLACES += tuple(_number(f"deviation_{each}") for each in ("x_mm", "y_mm", "strength"))
SHOWN = {
    "comparison": "",
    "variant": "median deviation of",
    "median_deviation_x_mm": "x (mm)",
    "median_deviation_y_mm": "y (mm)",
    "median_deviation_strength": "strength",
    "median_error_mm": "error (mm)",
}


class SurveyResults(NamedTuple):
    """Bounds of a scene.

    rasterization: errors of touches rasterized on cells; None where presses are factors.
    """

    parts: SceneParts
    options: SurveyOptions
    variants: Sequence[Variant]
    identity: IdentityBounds
    rasterization: RasterizationErrors | None

    @property
    def report(self) -> Findings:
        """Bounds on position and accuracy: sentences, tables, maps."""
        skin, setup, assumed = self.parts.skin, self.parts.setup, self.options.assumptions
        numbers: dict[str, Any] = {"scene": skin.name, "assumptions": assumed}
        said = [f"bounds for a touch: {assumed}"]
        if self.rasterization is not None:
            numbers["rasterization_error"] = self.rasterization.summary()
            said.append(f"  {self.rasterization.sentence}")
        numbers |= {"median_error_of": ERROR, "accuracy": self.identity.summary()}
        if each := setup.own:
            numbers["frequencies_of_each_Hz"] = each
        repeated = describe_repeated(skin, setup, self.parts.plan.press)
        meaning = bound_text(self.options.against_rest, "a known skin")
        below = Items([ERROR, *repeated]), *self.identity.lines(), Items([meaning])
        return Findings(
            f"Limits of {skin.name}",
            [*said, *self._tables(), *below, *self._charts()],
            numbers=numbers,
        )

    def _tables(self) -> Iterator[DataTable]:
        rows = [summary(variant) for variant in self.variants]
        forms = {"comparison": "", "variant": ""}
        heads = [Head(k, SHOWN.get(k), forms.get(k, str), k in SHOWN) for k in rows[0]]
        yield DataTable("position", heads, [[*row.values()] for row in rows], MAX_ROWS, json=True)
        places = [
            [
                variant.comparison,
                variant.name,
                *(rounded(each, 1e3) for each in place),
                rounded(strength),
            ]
            for variant in self.variants
            for *place, strength in np.column_stack(
                [variant.bounds.places, variant.bounds.x, variant.bounds.y, variant.bounds.strength]
            )
        ]
        yield DataTable("limits", PLACES, places, 0, csv=True)
        names, separation = self.identity.names, self.identity.separation
        pairs = itertools.combinations(range(len(names)), 2)
        distances = [[names[i], names[j], rounded(separation[i, j])] for i, j in pairs]
        yield DataTable("pixels", ("pixel", "other", "distance_errors"), distances, 0, csv=True)

    def _charts(self) -> Iterator[Chart]:
        skin, identity, title = self.parts.skin, self.identity, self._title()
        for comparison in dict.fromkeys(variant.comparison for variant in self.variants):
            chosen = [each for each in self.variants if each.comparison == comparison]
            yield Chart(comparison, title, partial(draw_maps, skin, chosen, title))
        title = (
            f"{skin.name}: distance between the sweeps of pixels, at their nearest "
            f"factors; {identity.assumptions}"
        )
        yield Chart(
            "pixels", title, partial(draw_distances, identity.separation, identity.names, title)
        )

    def _title(self) -> str:
        options = self.options
        count = options.against_rest
        baseline = f" minus the mean of {count} baseline sweeps" if count else ""
        return (
            f"{self.parts.skin.name}: smallest standard deviation from one sweep{baseline}, at "
            f"{1 + options.touch.rise:.3g} times the capacitance; {options.assumptions}"
        )


QUANTITIES = {
    "x": (1e3, "Deviation\nof x (mm)"),
    "y": (1e3, "Deviation\nof y (mm)"),
    "strength": (100.0, "Deviation of\nthe rise (% of C)"),
}
LONGER, MIN_WIDTH, MIN_HEIGHT = 2.4, 1.5, 1.3
"""Inches of a map: its longer side, and its smallest width and height, for title and label."""
BAR_WIDTH, MAP_GAP, OUTER_SPACE = 1.6, 0.45, 1.4
"""Inches: colour bar with label, space between maps, and space above and below all of them."""
UNRESOLVED_COLOUR = "0.8"
MARGIN = 0.08
NOISE = 1.0
LETTERS_PER_INCH = 11


def draw_maps(skin: Skin, variants: Sequence[Variant], title: str, path: Path) -> None:
    """Draws the bounds of x, y and strength of all variants, as maps, or as lines for a strip."""
    if len(np.unique(variants[0].bounds.places[:, 1])) == 1:
        return _draw_lines(skin, variants, title, path)
    wide, high = _size_of_map(skin)
    columns, rows = len(variants), len(QUANTITIES)
    width = (wide + MAP_GAP) * columns + BAR_WIDTH
    with chart(path, width, (high + MAP_GAP) * rows + OUTER_SPACE) as figure:
        grid = figure.add_gridspec(rows, columns + 1, width_ratios=[*[wide] * columns, 0.12])
        panels = grid.subplots(squeeze=False)
        for row, (quantity, (unit, label)) in zip(panels, QUANTITIES.items(), strict=True):
            values = [unit * getattr(variant.bounds, quantity) for variant in variants]
            _draw_row(row, skin, variants, values, label)
        for axes, variant in zip(panels[0, :-1], variants, strict=True):
            axes.set_title(variant.name)
        for axes in panels[:, 0]:
            axes.set_ylabel("y (mm)")
        for axes in panels[-1, :-1]:
            axes.set_xlabel("x (mm)")
        for axes in panels[:, :-1].flat:
            axes.label_outer()
        _draw_legend(figure)
        figure.suptitle(textwrap.fill(title, round(LETTERS_PER_INCH * width)))
    return None


def _size_of_map(skin: Skin) -> tuple[float, float]:
    """Width and height of each map in inches, both large enough for its texts."""
    longer = max(skin.sides)
    wide, high = (LONGER * side / longer for side in skin.sides)
    return max(wide, MIN_WIDTH), max(high, MIN_HEIGHT)


def _draw_row(
    panels: NDArray[np.object_],
    skin: Skin,
    variants: Sequence[Variant],
    values: Sequence[Real],
    label: str,
) -> None:
    from matplotlib.cm import ScalarMappable
    from matplotlib.colorbar import Colorbar

    norm, bar_axes = _norm(values), panels[-1]
    bar_axes.grid(False)
    for axes, variant, own in zip(panels, variants, values, strict=False):
        _draw_map(axes, skin, variant.bounds, own, norm)
    if norm is None:
        bar_axes.set_axis_off()
        text, position = f"{label}:\nnot resolved anywhere", (0.0, 0.5)
        bar_axes.text(
            *position, text, rotation=90, va="center", ha="left", transform=bar_axes.transAxes
        )
        return
    bar = Colorbar(bar_axes, ScalarMappable(norm, "viridis_r"), label=label)
    plain_numbers(bar.ax.yaxis)


def _norm(values: Sequence[Real]) -> Normalize | None:
    from matplotlib.colors import LogNorm

    finite = np.concatenate([each[np.isfinite(each)] for each in values])
    if not finite.size:
        return None
    return LogNorm(0.999 * float(finite.min()), 1.001 * float(finite.max()))


def _draw_map(
    axes: Axes, skin: Skin, bounds: PositionBounds, values: Real, norm: Normalize | None
) -> None:
    x, y = (np.unique(1e3 * bounds.places[:, axis]) for axis in (0, 1))
    pixels = skin.pixels
    cells = skin.length / pixels.columns, skin.width / pixels.rows
    axes.set_facecolor("white")
    edges = _edges(x, 1e3 * cells[0]), _edges(y, 1e3 * cells[1])
    shown, evaluated = np.full((2, len(y), len(x)), np.nan)
    at = (
        np.searchsorted(y, 1e3 * bounds.places[:, 1]),
        np.searchsorted(x, 1e3 * bounds.places[:, 0]),
    )
    shown[at], evaluated[at] = values, 0.0
    grey: Any = {"cmap": "Greys", "vmin": -1, "vmax": 3}
    for own, looks in ((evaluated, grey), (shown, {"cmap": "viridis_r", "norm": norm})):
        axes.pcolormesh(*edges, np.ma.masked_invalid(own), **looks)
    draw_sheet(axes, skin)


def _edges(middles: Real, alone: float) -> Real:
    step = middles[1] - middles[0] if len(middles) > 1 else alone
    return np.append(middles - step / 2, middles[-1] + step / 2)


def draw_sheet(axes: Axes, skin: Skin) -> None:
    """Draws outline, pixel grid and foils, in mm."""
    length, width = MM * np.array(skin.sides)
    longer = max(length, width)
    axes.grid(False)
    axes.set_xlim(-MARGIN * longer, length + MARGIN * longer)
    axes.set_ylim(-MARGIN * longer, width + MARGIN * longer)
    axes.set_aspect("equal")
    draw_pixels(axes, skin)
    draw_outline(axes, skin)
    draw_foils(axes, skin)


def _draw_legend(figure: Figure) -> None:
    from matplotlib.patches import Patch

    foils, labels = figure.axes[0].get_legend_handles_labels()
    handles, named = [*foils, Patch(color=UNRESOLVED_COLOUR)], [*labels, "not resolved"]
    figure.legend(handles, named, loc="outside lower center", ncols=3)


def _draw_lines(skin: Skin, variants: Sequence[Variant], title: str, path: Path) -> None:
    with chart(path, 6.5, 3.6) as figure:
        axes = figure.subplots()
        for k, variant in enumerate(variants):
            x, deviation = 1e3 * variant.bounds.places[:, 0], 1e3 * variant.bounds.x
            finite = np.where(np.isfinite(deviation), deviation, np.nan)
            colour, style = COLOURS[k % len(COLOURS)], LINE_STYLES[k % len(LINE_STYLES)]
            axes.plot(x, finite, linestyle=style, color=colour, label=variant.name)
        for line in np.linspace(0, 1e3 * skin.length, skin.pixels.columns + 1):
            axes.axvline(line, color="0.7", linewidth=0.5)
        axes.set_xlim(0, 1e3 * skin.length)
        axes.grid(False, axis="x")
        axes.set_yscale("log")
        plain_numbers(axes.yaxis)
        axes.set_xlabel("Middle of the touch, x (mm); lines between pixels")
        axes.set_ylabel(QUANTITIES["x"][1])
        axes.legend()
        figure.suptitle(textwrap.fill(title, round(LETTERS_PER_INCH * 6.5)))


def draw_distances(separation: Real, names: Sequence[str], title: str, path: Path) -> None:
    """Draws the distances between the sweeps of all pairs of pixels as a matrix."""
    from matplotlib.colors import LogNorm

    size = 2.4 + 0.22 * len(names)
    width = max(5.0, size + 0.8)
    with chart(path, width, max(4.4, size)) as figure:
        axes = figure.subplots()
        shown = np.ma.masked_less(separation, NOISE / 10)
        top = float(max(separation.max(), 10 * NOISE))
        image = axes.imshow(shown, cmap="viridis", norm=LogNorm(NOISE / 10, top))
        axes.set_facecolor(UNRESOLVED_COLOUR)
        axes.grid(False)
        ticks = list(range(0, len(names), max(1, math.ceil(len(names) / 36))))
        axes.set_xticks(ticks, [names[k] for k in ticks], rotation=90, fontsize=7)
        axes.set_yticks(ticks, [names[k] for k in ticks], fontsize=7)
        axes.set_xlabel("Pixel (row, column)")
        axes.set_ylabel("Pixel (row, column)")
        bar = figure.colorbar(image, ax=axes, pad=0.02)
        bar.set_label("Distance (meter's errors); grey: less than 0.1")
        plain_numbers(bar.ax.yaxis)
        figure.suptitle(textwrap.fill(title, round(LETTERS_PER_INCH * width)))

"""Results of a survey of limits, as files and on the terminal."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Real
from ..bounds.touches.rasterization_errors import RasterizationErrors
from ..measure.symmetry import describe_repeated
from ..report.files import filled_at_once, table, write_json, write_rows
from ..safe_text import say, terminal
from ..scene.parts import SceneParts
from ..sweeps.units import bound_text
from .limit_charts import draw_distances, draw_maps
from .survey import SurveyOptions, Variant
from .touch_identity import IdentityBounds

UNRESOLVED = "not resolved"
HEADER = (
    "comparison",
    "variant",
    "x_mm",
    "y_mm",
    "deviation_x_mm",
    "deviation_y_mm",
    "deviation_strength",
)


def rounded(value: float, unit: float = 1.0, digits: int = 4) -> float | str:
    """A rounded number in other units, or UNRESOLVED where it is infinite."""
    return float(f"{unit * value:.{digits}g}") if math.isfinite(value) else UNRESOLVED


def write_places(variants: Sequence[Variant], path: Path) -> None:
    """Writes a CSV line for every position of every variant."""
    write_rows(
        path,
        HEADER,
        (
            [
                variant.comparison,
                variant.name,
                *(rounded(each, 1e3) for each in place),
                rounded(strength),
            ]
            for variant in variants
            for *place, strength in np.column_stack(
                [variant.bounds.places, variant.bounds.x, variant.bounds.y, variant.bounds.strength]
            )
        ),
    )


def write_distances(separation: Real, names: Sequence[str], path: Path) -> None:
    """Writes the distance between the sweeps of each pair of pixels as a CSV line."""
    pairs = itertools.combinations(range(len(names)), 2)
    rows = ([names[i], names[j], rounded(separation[i, j])] for i, j in pairs)
    write_rows(path, ["pixel", "other", "distance_errors"], rows)


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
        "places_where_x_is_told": float(np.isfinite(own.x).mean()),
        "places_where_y_is_told": float(np.isfinite(own.y).mean()),
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
COLUMNS = {
    "x (mm)": "median_deviation_x_mm",
    "y (mm)": "median_deviation_y_mm",
    "strength": "median_deviation_strength",
    "error (mm)": "median_error_mm",
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

    def write(self, folder: Path, ending: str) -> None:
        """Writes maps with this ending, tables and a summary."""
        content = {
            "scene": self.parts.skin.name,
            "position_asked": self.options.assumptions,
            **(
                {}
                if self.rasterization is None
                else {"position_laid": self.rasterization.summary()}
            ),
            "median_error_of": ERROR,
            "position": [summary(variant) for variant in self.variants],
            "accuracy": self.identity.summary(),
        }
        if each := self.parts.setup.own:
            content["frequencies_of_each_Hz"] = each
        with filled_at_once(folder) as made:
            self._draw(made, ending)
            write_places(self.variants, made / "limits.csv")
            write_distances(self.identity.separation, self.identity.names, made / "pixels.csv")
            write_json(made / "limits.json", content)

    def show(self, folder: Path) -> None:
        """Prints the first rows and the place of the others."""
        shown = [(variant, summary(variant)) for variant in self.variants[:MAX_ROWS]]
        rows = (
            [variant.comparison, variant.name, *(str(numbers[key]) for key in COLUMNS.values())]
            for variant, numbers in shown
        )
        say(f"bounds for a touch: {self.options.assumptions}")
        if self.rasterization is not None:
            say(f"  {self.rasterization.sentence}")
        terminal().print(table(["", "median deviation of", *COLUMNS], rows))
        left = len(self.variants) - MAX_ROWS
        more = [f"  {left} more rows in {folder / 'limits.json'}"] if left > 0 else []
        repeated = [
            f"  {line}"
            for line in describe_repeated(self.parts.skin, self.parts.setup, self.parts.plan.press)
        ]
        meaning = f"  {bound_text(self.options.against_rest, 'a known skin')}"
        say(*more, f"  {ERROR}", *repeated, *self.identity.lines(), meaning)
        say(f"maps and tables written to {folder}")

    def _draw(self, folder: Path, ending: str) -> None:
        for comparison in dict.fromkeys(variant.comparison for variant in self.variants):
            chosen = [each for each in self.variants if each.comparison == comparison]
            draw_maps(self.parts.skin, chosen, self._title(), folder / f"{comparison}{ending}")
        draw_distances(
            self.identity.separation,
            self.identity.names,
            f"{self.parts.skin.name}: distance between the sweeps of pixels, at their nearest "
            f"factors; {self.identity.assumptions}",
            folder / f"pixels{ending}",
        )

    def _title(self) -> str:
        options = self.options
        count = options.against_rest
        baseline = f" minus the mean of {count} baseline sweeps" if count else ""
        return (
            f"{self.parts.skin.name}: smallest standard deviation from one sweep{baseline}, at "
            f"{1 + options.touch.rise:.3g} times the capacitance; {options.assumptions}"
        )

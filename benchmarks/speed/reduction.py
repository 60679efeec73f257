"""Reduced models: whether they keep their targets, how they grow, and how others fare beside them.

Random presses of one and of two pixels, factors from 1.2 to 3, 20 frequencies from 40 Hz to
200 kHz; the truth is the full solver at 1e-8. Times are of one core and warm.

Run: python benchmarks/speed/reduction.py [--quick]
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pandas as pd
from rcskin.benchmarks.bench import Run, launch, machine
from rcskin.benchmarks.speed import reduction_tables
from rcskin.benchmarks.speed.reduction_tables import RTOL
from rcskin.simulator.chart_style import COLOURS, UNPRESSED_COLOUR, chart
from rcskin.simulator.fem.factors import one_blas_thread
from rcskin.simulator.sweeps import whole_file

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FULL, REDUCED, PREPARATION, CERTIFICATE = UNPRESSED_COLOUR, COLOURS[0], COLOURS[1], COLOURS[2]
WAYS = (COLOURS[0], UNPRESSED_COLOUR, *COLOURS[1:])
MARKERS = "soDv^P*"


def draw(
    path: Path, pixels: pd.DataFrame, sizes: pd.DataFrame, ways: pd.DataFrame, rtol: float
) -> None:
    """Write the chart. rtol: asked of the models in the first and the last panel."""
    with chart(path, 13, 4.6) as figure:
        panels = figure.subplots(1, 3, width_ratios=(1, 1, 1.15))
        _cost(panels[0], pixels)
        _error(panels[1], sizes)
        _ways(panels[2], ways, rtol)


def _cost(axes: Axes, table: pd.DataFrame) -> None:
    along = table["pixels along a side"]
    for column, scale, label, marker, colour in (
        ("preparation (s)", 1e3, "preparation, once", "D", PREPARATION),
        ("full (µs)", 1e-3, "full model, a further press", "o", FULL),
        ("reduced (µs)", 1e-3, "reduced model, a press", "s", REDUCED),
    ):
        axes.loglog(along, scale * table[column], marker=marker, color=colour, label=label)
    _tell_vectors(axes, table)
    axes.set_ylim(bottom=0.4e-3 * table["reduced (µs)"].min())
    axes.set_xticks(along, [f"{n}" for n in along])
    axes.minorticks_off()
    axes.set_xlabel("Pixels along a side (in blue: vectors in the basis)")
    axes.set_ylabel("Time of a sweep of 20 frequencies (ms)")
    axes.set_title("Cost against pixels, tolerance 1e-5", loc="left")
    axes.legend(loc="upper left")


def _tell_vectors(axes: Axes, table: pd.DataFrame) -> None:
    places = zip(table["pixels along a side"], 1e-3 * table["reduced (µs)"], strict=True)
    for place, vectors in zip(places, table["vectors"], strict=True):
        axes.annotate(
            f"{vectors}",
            place,
            xytext=(0, -12),
            textcoords="offset points",
            ha="center",
            fontsize=8,
            color=REDUCED,
        )


def _error(axes: Axes, table: pd.DataFrame) -> None:
    axes.semilogy(
        table["vectors"], table["certificate"], "^--", color=CERTIFICATE, label="certificate"
    )
    axes.semilogy(table["vectors"], table["error"], "s-", color=REDUCED, label="error")
    axes.set_xlabel("Vectors in the basis")
    axes.set_ylabel("Largest relative error of Rs and Cp left by the basis")
    axes.set_title("Error against basis size, sheet-5x5 trained at 1e-7", loc="left")
    axes.legend(loc="upper right")


def _ways(axes: Axes, table: pd.DataFrame, rtol: float) -> None:
    axes.axhline(rtol, color="0.45", lw=1, ls=":", label=f"{rtol:g} is asked")
    names = table["way"] + ", " + table["setting"]
    places = zip(1e-3 * table["a sweep (µs)"], table["true error"], strict=True)
    for name, place, colour, marker in zip(names, places, WAYS, MARKERS, strict=False):
        axes.loglog(*place, marker, color=colour, markersize=8, label=name)
    axes.margins(x=0.12, y=0.2)
    axes.set_xlabel("Time of a sweep, all being prepared (ms)")
    axes.set_ylabel("Largest relative error of Rs and Cp")
    axes.set_title("Ways to a sweep of sheet-5x5", loc="left")
    axes.legend(loc="upper left")


NAME = "reduction"
TITLES = {
    "targets": "Accuracy and time of reduced models",
    "pixels": "Cost against pixels on the square sheet",
    "size": "Error against the size of the basis, sheet-5x5",
    "ways": "Ways to a sweep of sheet-5x5",
}
TABLES = {
    "targets": reduction_tables.by_targets,
    "pixels": reduction_tables.by_pixels,
    "size": reduction_tables.by_size,
    "ways": reduction_tables.by_ways,
}
ERRORS = (
    "true error",
    "left out by the basis",
    "largest certificate",
    "difference",
    "error",
    "certificate",
    "of the same matrices",
)


def main(run: Run) -> None:
    """Measure, print and write."""
    tables = {}
    with one_blas_thread():
        for name, table in TABLES.items():
            tables[name] = table(run)
            print(titled(name, tables[name]), flush=True)
    write(run.results, tables)


def write(folder: Path, tables: dict[str, pd.DataFrame]) -> None:
    """The tables as Markdown and in long form as CSV, and the chart."""
    with whole_file(folder / f"{NAME}.md") as unfinished:
        unfinished.write_text(told(tables), encoding="utf-8")
    with whole_file(folder / f"{NAME}.csv") as unfinished:
        in_long_form(tables).to_csv(unfinished, index=False, lineterminator="\n")
    draw(folder / f"{NAME}.png", tables["pixels"], tables["size"], tables["ways"], RTOL)


def told(tables: dict[str, pd.DataFrame]) -> str:
    """For people: the machine, then every table."""
    parts = ["# Reduced models", f"{machine('pymor')}"]
    return "\n\n".join([*parts, *(titled(*each) for each in tables.items())]) + "\n"


def titled(name: str, table: pd.DataFrame) -> str:
    """One table under its title."""
    header, *rows = [list(table.columns), *formatted(table).to_numpy().tolist()]
    lines = [" | ".join(row) for row in [header, ["---"] * len(header), *rows]]
    return "\n\n".join([f"## {TITLES[name]}", "\n".join(f"| {line} |" for line in lines)])


def formatted(table: pd.DataFrame) -> pd.DataFrame:
    """Errors with two digits, other fractions with three, as text."""
    text = table.astype(str)
    for column in table.select_dtypes("floating"):
        digits = "{:.1e}" if column in ERRORS else "{:.3g}"
        text[column] = table[column].map(digits.format).replace("nan", "-")
    return text


def in_long_form(tables: dict[str, pd.DataFrame]) -> pd.DataFrame:
    """One value a row: table, number of its row, quantity, value."""
    text = {name: formatted(table).rename_axis("row") for name, table in tables.items()}
    long = {
        name: table.melt(var_name="quantity", ignore_index=False).reset_index()
        for name, table in text.items()
    }
    return (
        pd.concat(long, names=["table"])
        .reset_index("table")
        .sort_values(["table", "row"], kind="stable")
    )


if __name__ == "__main__":
    launch(main)

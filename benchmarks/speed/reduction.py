"""Reduced models: whether they keep their targets, how they grow, and how others fare beside them.

Random presses of one and of two pixels, factors from 1.2 to 3, 20 frequencies from 40 Hz to
200 kHz; the truth is the full solver at 1e-8. Times are of one core and warm.

Run: python benchmarks/speed/reduction.py [--quick]
"""

from __future__ import annotations

from pathlib import Path

import pandas as pd
from rcskin.benchmarks.bench import Run, launch, machine
from rcskin.benchmarks.speed.reduction_parts import growth, targets, ways
from rcskin.benchmarks.speed.reduction_parts.cases import RTOL
from rcskin.benchmarks.speed.reduction_parts.chart import draw
from rcskin.simulator.fem.factors import one_blas_thread
from rcskin.simulator.sweeps import whole_file

NAME = "reduction"
TITLES = {
    "targets": "Accuracy and time of reduced models",
    "pixels": "Cost against pixels on the square sheet",
    "size": "Error against the size of the basis, sheet-5x5",
    "ways": "Ways to a sweep of sheet-5x5",
}
TABLES = {
    "targets": targets.table,
    "pixels": growth.by_pixels,
    "size": growth.by_size,
    "ways": ways.table,
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

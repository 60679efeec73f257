"""Tables that pages quote from `results/`: whether they are those that were written last.

A quote is a comment and the table below it. Columns may be chosen, in their order; without them
the whole table is quoted:

    <!-- quoted: dataset.md; made by; workers -->
    | made by | workers |
    ...

Run: python benchmarks/quoted.py [--write]    code 1 where a page differs
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from rcskin.benchmarks.bench import HERE, RESULTS

ROOT = HERE.parent
MARK = re.compile(r"<!-- quoted: (?P<table>[\w.-]+)(?P<columns>(; [^;>]+)*) -->")


@dataclass(frozen=True)
class Quote:
    """A quoted table: on a page, from line `first` (counted from 0) on, of a file of results."""

    page: Path
    first: int
    lines: tuple[str, ...]
    table: str
    columns: tuple[str, ...]

    def told(self) -> str:
        """Where it stands, for people."""
        return f"{self.page.relative_to(ROOT)}: line {self.first + 1}: {self.table}"


def pages() -> list[Path]:
    """Every page of the repository."""
    rooms = ("docs", "paper", "simulator", "localization", "hardware", "benchmarks")
    return [*ROOT.glob("*.md"), *(page for room in rooms for page in (ROOT / room).rglob("*.md"))]


def quotes(page: Path) -> Iterator[Quote]:
    """The quoted tables of a page."""
    lines = page.read_text(encoding="utf-8").splitlines()
    for number, line in enumerate(lines):
        if found := MARK.fullmatch(line.strip()):
            there = tuple(_table(lines[number + 1 :]))
            columns = tuple(each.strip() for each in found["columns"].split(";") if each.strip())
            yield Quote(page, number + 1, there, found["table"], columns)


def written(table: str, columns: Sequence[str] = ()) -> tuple[str, ...]:
    """The table as it was written last, or some of its columns.

    Raises KeyError where there is no such column, OSError where there is no such file.
    """
    lines = (RESULTS / table).read_text(encoding="utf-8").splitlines()
    first = next(number for number, line in enumerate(lines) if line.startswith("|"))
    rows = [_cells(line) for line in _table(lines[first:])]
    if not columns:
        return tuple(map(_row, rows))
    header = {name: place for place, name in enumerate(rows[0])}
    return tuple(_row([row[header[name]] for name in columns]) for row in rows)


def differing() -> list[Quote]:
    """Quotes of all pages that are not what was written last."""
    found = (quote for page in pages() for quote in quotes(page))
    return [quote for quote in found if quote.lines != written(quote.table, quote.columns)]


def correct(quote: Quote) -> None:
    """Write the table anew into its page."""
    lines = quote.page.read_text(encoding="utf-8").splitlines()
    last = quote.first + len(quote.lines)
    lines[quote.first : last] = written(quote.table, quote.columns)
    quote.page.write_text("\n".join([*lines, ""]), encoding="utf-8")


def _table(lines: Sequence[str]) -> Iterator[str]:
    for line in lines:
        if not line.startswith("|"):
            return
        yield line


def _cells(line: str) -> list[str]:
    return [cell.strip() for cell in line.strip("|").split("|")]


def _row(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def main() -> int:
    """Tell every quote that differs; with --write, correct it."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--write", action="store_true", help="put the tables into the pages")
    write = parser.parse_args().write
    while found := differing():
        for quote in found:
            print(quote.told())
        if not write:
            return 1
        correct(found[0])
    return 0


if __name__ == "__main__":
    sys.exit(main())

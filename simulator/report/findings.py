"""What a command or function found, written once for every reader.

`Findings` are sentences, lists, tables and charts in their order, a verdict, and numbers. There is
one writer each for the terminal, a page in HTML, JSON, CSV, a notebook and files of charts. The
page stands alone: it contains its pictures and requests nothing from the network.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from base64 import b64encode
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from shutil import get_terminal_size
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import numpy as np

from ..chart_style import COLOURS
from ..cleanup import temporary_folder
from ..notebook_display import MARGINS, TOP, SmallChart, html_table, side_by_side
from ..safe_text import escaped, say, template_environment
from .files import files_in, filled_at_once, write_json, write_rows, write_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MAX_ROWS = 20
"""Largest number of rows of a table that a terminal or a notebook shows."""
BAR, WIDTH, NAMES = 0.26, 3.4, 1.2
"""Inches: height of a bar with its space, width of the chart, and space for names on the left."""


class Rate(NamedTuple):
    """A rate and its interval, each from 0 to 1."""

    name: str
    value: float
    low: float
    high: float


def rate_bars(rates: Sequence[Rate], guess: float | None = None) -> SmallChart:
    """Chart of rates in percent. guess: accuracy of a guess, a dashed line."""
    height = MARGINS["bottom"] + TOP + BAR * len(rates)
    return SmallChart(lambda figure: _draw(figure, rates, guess), WIDTH, height)


def _draw(figure: Figure, rates: Sequence[Rate], guess: float | None) -> None:
    figure.subplots_adjust(left=NAMES / WIDTH)
    axes, at = figure.subplots(), np.arange(len(rates))
    value, low, high = 100 * np.array([each[1:] for each in rates]).T
    off = np.maximum([value - low, high - value], 0)
    axes.barh(at, value, xerr=off, height=0.7, color=COLOURS[5], ecolor="0.3", capsize=2)
    axes.set_yticks(at, [each.name for each in rates])
    axes.set_ylim(len(rates) - 0.5, -0.5)
    axes.set_xlim(0, 100)
    axes.grid(False, axis="y")
    axes.set_xlabel("% of sweeps, with 95 % interval")
    if guess is not None:
        line = axes.axvline(100 * guess, color=COLOURS[1], linestyle="--")
        figure.legend([line], ["guess without a sweep"], loc="upper right", borderaxespad=0.1)


@dataclass(frozen=True)
class Cell:
    """Text in a table, with small text below it.

    agrees: marks the text as good or bad.
    """

    text: str
    below: str = ""
    agrees: bool | None = None


class Head(NamedTuple):
    """Column of a table: its names, and how its values are written.

    key: its name in files. head: its name with the unit, for people; the key by default. form: how
    a value is written for people, as a format or a function. shown: False for files alone. left:
    True if it is no number, which is aligned to the right.
    """

    key: str
    head: str | None = None
    form: str | Callable[[Any], str] = ""
    shown: bool = True
    left: bool = False

    @property
    def title(self) -> str:
        """Name for people."""
        return self.key if self.head is None else self.head

    def text(self, value: object) -> str | Cell:
        """A value for people; empty for None."""
        if value is None or isinstance(value, Cell):
            return value or ""
        if callable(self.form):
            return self.form(value)
        return value if isinstance(value, str) else format(value, self.form)


@dataclass(frozen=True)
class DataTable:
    """Rows of values below columns.

    name: in JSON, and of the file as CSV. columns: texts stand for columns without a format. most:
    number of rows that a terminal shows; 0 for a table of files alone. csv: True for a file. json:
    True if JSON has the rows, by the columns' keys. instead: what stands for a table that is wider
    than the terminal; empty for the table all the same.
    """

    name: str
    columns: Sequence[Head | str]
    rows: Sequence[Sequence[Any]]
    most: int = MAX_ROWS
    csv: bool = False
    json: bool = False
    instead: str = ""

    @property
    def heads(self) -> list[Head]:
        """All columns."""
        return [Head(each) if isinstance(each, str) else each for each in self.columns]

    @property
    def titles(self) -> list[tuple[str, bool]]:
        """Names of the columns for people, and whether they are numbers, aligned to the right."""
        shown = (column for column in self.heads if column.shown)
        return [(each.title, bool(each.form) and not each.left) for each in shown]

    def texts(self, most: int | None = None) -> list[list[str | Cell]]:
        """Rows for people. most: number of rows, all of them for None."""
        each = (zip(self.heads, row, strict=True) for row in self.rows[:most])
        return [[column.text(value) for column, value in row if column.shown] for row in each]

    @property
    def cells(self) -> list[list[str]]:
        """The names, and the rows that a terminal shows, as text."""
        rows = [[escaped(getattr(v, "text", v)) for v in row] for row in self.texts(self.most)]
        return [[escaped(title) for title, _ in self.titles], *rows]

    @property
    def lines(self) -> list[str]:
        """The table as text, with aligned columns."""
        cells, sides = self.cells, ["<>"[number] for _, number in self.titles]
        widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
        line = "  ".join(f"{{:{each}{width}}}" for each, width in zip(sides, widths, strict=True))
        return [line.format(*row).rstrip() for row in cells]

    @property
    def records(self) -> list[dict[str, Any]]:
        """Rows as mappings from the columns' keys."""
        keys = [column.key for column in self.heads]
        return [dict(zip(keys, row, strict=True)) for row in self.rows]


@dataclass(frozen=True)
class Items:
    """List of lines; `about` gives the subject of each, in bold before it, if any."""

    lines: Sequence[str]
    about: Sequence[str] = ()

    @property
    def both(self) -> Sequence[tuple[str, str]]:
        """Pairs of a line's subject, empty if there is none, and the line."""
        return list(zip(self.about or [""] * len(self.lines), self.lines, strict=True))


@dataclass(frozen=True)
class Chart:
    """Chart: its name in files, its caption, and the function that draws it to a path.

    below: True if the caption also stands below it on a page.
    """

    name: str
    caption: str
    draw: Callable[[Path], None]
    below: bool = True


@dataclass(frozen=True)
class Heading:
    """Heading of the parts that follow on a page."""

    text: str


Finding = str | Items | DataTable | Chart | Heading
P = TypeVar("P", Items, DataTable, Chart)


@dataclass(frozen=True)
class Findings:
    """What was found.

    title: of the page, and above the tables in Python. parts: in their order; a text is a sentence
    or a paragraph. verdict: what stands first. numbers: further numbers of the JSON file, before
    its tables. files: functions that write further files, by their names. small: chart for a
    notebook.
    """

    title: str
    parts: Sequence[Finding] = ()
    verdict: str = ""
    numbers: Mapping[str, Any] = field(default_factory=dict)
    files: Mapping[str, Callable[[Path], object]] = field(default_factory=dict)
    small: Callable[[], SmallChart | None] = lambda: None

    def of(self, kind: type[P]) -> list[P]:
        """All parts of a kind."""
        return [part for part in self.parts if isinstance(part, kind)]

    @property
    def said(self) -> list[Finding]:
        """Verdict and parts without charts, tables of files alone, and headings of these."""
        found: list[Finding] = []
        for part in reversed((*filter(None, [self.verdict]), *self.parts)):
            if isinstance(part, Heading):
                found += [part] if found and not isinstance(found[-1], Heading) else []
            elif not isinstance(part, Chart) and getattr(part, "most", 1):
                found.append(part)
        return found[::-1]

    @property
    def json(self) -> dict[str, Any]:
        """Numbers, and rows of the tables, for JSON."""
        return {
            **self.numbers,
            **{each.name: each.records for each in self.of(DataTable) if each.json},
        }

    def lines(self, file: object = None) -> list[str]:
        """Verdict, sentences, lists and tables, as lines of text. file: with all rows."""
        return [line for part in self.said for line in lines_of(part, file)]

    def show(self, file: object = None) -> None:
        """Prints these lines on the terminal."""
        say(*self.lines(file))

    def write(
        self,
        folder: Path,
        *,
        json: str | None = None,
        page: str | None = None,
        charts: Collection[str] = (".png",),
    ) -> Sequence[str]:
        """Writes tables as CSV, charts, further files, JSON and the page, all or none.

        json, page: names of these files, None for none. charts: endings of the charts' own files.
        Returns the names. Raises InputError as `filled_at_once`.
        """
        with filled_at_once(folder) as made, temporary_folder() as apart:
            for name, wrote in self.files.items():
                wrote(made / name)
            for table in self.of(DataTable):
                if table.csv:
                    heads = [column.key for column in table.heads]
                    write_rows(made / f"{table.name}.csv", heads, table.rows)
            shown = made if ".png" in charts else apart
            places = [(made, ending) for ending in dict.fromkeys(charts)]
            places += [(apart, ".png")] if page and shown is apart else []
            for chart in self.of(Chart):
                for place, ending in places:
                    chart.draw(place / f"{chart.name}{ending}")
            if json:
                write_json(made / json, self.json)
            if page:
                write_text(made / page, self.html(shown))
            return files_in(made)

    def html(self, pictures: Path) -> str:
        """The page. pictures: folder of the charts as PNG."""
        folder = Path(__file__).parent
        environment = template_environment(folder, trim_blocks=True, lstrip_blocks=True)
        environment.tests |= {
            kind.__name__.lower(): lambda part, kind=kind: isinstance(part, kind)
            for kind in (Items, DataTable, Chart, Heading, Cell)
        }
        environment.filters["picture"] = lambda name: b64encode(
            (pictures / f"{name}.png").read_bytes()
        ).decode("ascii")
        return environment.get_template("page.html.jinja").render(findings=self) + "\n"

    def __str__(self) -> str:
        """Title and lines."""
        return "\n".join(map(escaped, [self.title, *self.lines()]))

    @property
    def notebook(self) -> str:
        """Title, sentences, tables and charts as HTML on one line."""
        shown = [f"<div>{escape(escaped(self.title))}</div>"]
        for part in self.said:
            lines = lines_of(part)
            if isinstance(part, DataTable):
                shown, lines = [*shown, html_table(part.cells)], lines[len(part.cells) :]
            shown += [f"<div>{escape(escaped(line))}</div>" for line in lines]
        return "".join(shown)


class Result(ABC):
    """A result that prints its findings in Python, and shows them with a chart in a notebook."""

    @property
    @abstractmethod
    def report(self) -> Findings:
        """What was found."""

    def __repr__(self) -> str:
        return str(self.report)

    def _repr_html_(self) -> str:
        return shown(lambda: self.report)


def shown(findings: Callable[[], Findings]) -> str:
    """Findings in a notebook."""
    return side_by_side(lambda: findings().notebook, lambda: findings().small())


def lines_of(part: Finding, file: object = None) -> list[str]:
    """A part as lines of text. file: with all rows of a table."""
    match part:
        case Items():
            return [f"  {about}: {line}" if about else f"  {line}" for about, line in part.both]
        case Heading():
            return [f"{part.text}:"]
        case DataTable() if part.instead and get_terminal_size().columns < len(part.lines[-1]):
            return [part.instead]
        case DataTable():
            left = len(part.rows) - part.most
            more = f"  {left} more rows{f' in {file}' if file else ''}"
            return [*part.lines, *([more] if left > 0 else [])]
        case _:
            return [str(part)]

"""A report as one HTML page: sections of text, lists, tables and pictures, in one style.

The page stands alone: pictures are within it, and it asks nothing of the network.
"""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ..safe_text import template_environment
from .files import write_text


@dataclass(frozen=True)
class Cell:
    """Text in a table with what stands in small below it. agrees: marks the text as good or bad."""

    text: str
    below: str = ""
    agrees: bool | None = None


@dataclass(frozen=True)
class TableGrid:
    """A table: heads of its columns, rows of cells, and which columns hold numbers."""

    heads: Sequence[str]
    rows: Sequence[Sequence[str | Cell]]
    numbers: Sequence[int] = ()


@dataclass(frozen=True)
class Items:
    """A list of lines; before each of them, in bold, what it is about, where `about` says it."""

    lines: Sequence[str]
    about: Sequence[str] = ()

    @property
    def both(self) -> Sequence[tuple[str, str]]:
        """Pairs of what a line is about, empty where that is not said, and the line."""
        return list(zip(self.about or [""] * len(self.lines), self.lines, strict=True))


@dataclass(frozen=True)
class Picture:
    """A PNG file, what it shows, and whether that stands below it too."""

    path: Path
    caption: str
    below: bool = True

    @property
    def name(self) -> str:
        """Of the file, without its ending."""
        return self.path.stem

    @property
    def base64(self) -> str:
        """The file's bytes as text."""
        return b64encode(self.path.read_bytes()).decode("ascii")


@dataclass(frozen=True)
class ReportSection:
    """A heading, empty for none, and what stands below it; a text is a paragraph."""

    title: str
    parts: Sequence[str | Items | TableGrid | Picture]


def write_page(path: Path, title: str, sections: Sequence[ReportSection], answer: str = "") -> None:
    """Write a page, whole or not at all. answer: what stands first, in bold."""
    environment = template_environment(Path(__file__).parent, trim_blocks=True, lstrip_blocks=True)
    environment.tests |= {
        kind.__name__.lower(): lambda part, kind=kind: isinstance(part, kind)
        for kind in (Items, TableGrid, Picture, Cell)
    }
    template = environment.get_template("page.html.jinja")
    write_text(path, template.render(title=title, sections=sections, answer=answer) + "\n")

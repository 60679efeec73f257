"""Report as one HTML page: text, lists, tables and pictures, in one style.

The page stands alone: it contains its pictures and requests nothing from the network.
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
    """Text in a table, with small text below it.

    agrees: marks the text as good or bad.
    """

    text: str
    below: str = ""
    agrees: bool | None = None


@dataclass(frozen=True)
class TableGrid:
    """Table: heads of its columns, rows of cells, and which columns hold numbers."""

    heads: Sequence[str]
    rows: Sequence[Sequence[str | Cell]]
    numbers: Sequence[int] = ()


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
class Picture:
    """PNG file and what it shows.

    below: True if the caption also stands below it.
    """

    path: Path
    caption: str
    below: bool = True

    @property
    def name(self) -> str:
        """Name of the file, without its ending."""
        return self.path.stem

    @property
    def base64(self) -> str:
        """Bytes of the file as text."""
        return b64encode(self.path.read_bytes()).decode("ascii")


@dataclass(frozen=True)
class ReportSection:
    """Heading, empty for none, and what stands below it; a text is a paragraph."""

    title: str
    parts: Sequence[str | Items | TableGrid | Picture]


def write_page(path: Path, title: str, sections: Sequence[ReportSection], answer: str = "") -> None:
    """Writes a page, whole or not at all. answer: what stands first, in bold."""
    environment = template_environment(Path(__file__).parent, trim_blocks=True, lstrip_blocks=True)
    environment.tests |= {
        kind.__name__.lower(): lambda part, kind=kind: isinstance(part, kind)
        for kind in (Items, TableGrid, Picture, Cell)
    }
    template = environment.get_template("page.html.jinja")
    write_text(path, template.render(title=title, sections=sections, answer=answer) + "\n")

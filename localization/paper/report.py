"""The report: one HTML file with every picture in it."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ...simulator.shown import pages
from ...simulator.sweeps import whole_file


@dataclass(frozen=True)
class Picture:
    """A PNG file and what it shows."""

    path: Path
    caption: str

    @property
    def base64(self) -> str:
        """The file's bytes as text."""
        return b64encode(self.path.read_bytes()).decode("ascii")


@dataclass(frozen=True)
class Section:
    """A heading over some pictures."""

    title: str
    pictures: Sequence[Picture]


def write_report(path: Path, **content: object) -> None:
    """Fill the template with `content` and write it to `path`, whole or not at all."""
    environment = pages(Path(__file__).parent, keep_trailing_newline=True)
    text = environment.get_template("report.html.jinja").render(content)
    with whole_file(path) as unfinished:
        unfinished.write_text(text, encoding="utf-8")

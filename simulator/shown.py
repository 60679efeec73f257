"""Text on a terminal: what names hold is shown, never obeyed.

Scenes, sweeps and meters come from others. A control character in a name could move the cursor,
rename the window or hide a line, a direction mark reorder one, and brackets are rich's markup.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import Console

OBEYED = {"Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp"}
"""Unicode's categories of control, format (direction marks), lone surrogates, and other lines."""
PLAIN = re.compile(r"[ -~]*")


def shown(text: object) -> str:
    """On one line, with what a terminal would obey written as Python writes it: \\x1b, \\u202e."""
    given = str(text)
    if PLAIN.fullmatch(given):
        return given
    return "".join(map(_visible, given))


def _visible(character: str) -> str:
    obeyed = unicodedata.category(character) in OBEYED
    return character.encode("unicode_escape").decode() if obeyed else character


def say(*lines: object, err: bool = False) -> None:
    """Write lines to standard output, or to standard error."""
    import typer

    typer.echo("\n".join(map(shown, lines)), err=err)


def terminal(*, stderr: bool = False, highlight: bool = True) -> Console:
    """A rich console that takes no text for markup, and shows it as `shown` does."""
    from rich.console import Console, ConsoleOptions
    from rich.segment import Segment
    from rich.text import Text

    class Shown(Console):
        def render_str(self, text: str, **options: Any) -> Text:
            return super().render_str(shown(text), **options)

        def render(self, renderable: Any, options: ConsoleOptions | None = None) -> Iterable:
            for each in super().render(renderable, options):
                yield each if each.control else Segment(_lines(each.text), each.style)

    return Shown(stderr=stderr, highlight=highlight, markup=False, emoji=False)


def _lines(text: str) -> str:
    return "\n".join(map(shown, text.split("\n")))

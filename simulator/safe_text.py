"""Safe text for terminals, charts, pages and notebooks: names are shown and never interpreted.

Scenes, sweeps and meters come from others. A control character in a name could move the cursor,
rename the window or hide a line; a direction mark could reorder one; brackets are markup of rich.
"""

from __future__ import annotations

import html
import re
import sys
import unicodedata
import warnings
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from jinja2 import Environment
    from matplotlib.figure import Figure
    from rich.console import Console

CONTROL_CATEGORIES = {"Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp"}
"""Unicode categories: control, format (direction marks), surrogates, unassigned, separators."""
PRINTABLE_ASCII = re.compile(r"[ -~]*")


def escaped(text: object) -> str:
    """The text on one line; control characters appear as Python escapes: \\x1b, \\u202e."""
    given = str(text)
    if PRINTABLE_ASCII.fullmatch(given):
        return given
    return "".join(map(_escaped_character, given))


def _escaped_character(character: str) -> str:
    control = unicodedata.category(character) in CONTROL_CATEGORIES
    return character.encode("unicode_escape").decode() if control else character


def say(*lines: object, err: bool = False) -> None:
    """Writes lines to standard output, or to standard error."""
    print(*map(escaped, lines), sep="\n", file=sys.stderr if err else sys.stdout, flush=True)


def terminal(*, stderr: bool = False, highlight: bool = True) -> Console:
    """A rich console that interprets no markup and escapes text as `escaped` does."""
    from rich.console import Console, ConsoleOptions
    from rich.segment import Segment
    from rich.text import Text

    class SafeConsole(Console):
        def render_str(self, text: str, **options: Any) -> Text:
            return super().render_str(escaped(text), **options)

        def render(self, renderable: Any, options: ConsoleOptions | None = None) -> Iterable:
            for each in super().render(renderable, options):
                yield each if each.control else Segment(_lines(each.text), each.style)

    return SafeConsole(stderr=stderr, highlight=highlight, markup=False, emoji=False)


@contextmanager
def figure_style(style: Mapping[Any, Any]) -> Iterator[None]:
    """Matplotlib settings while a figure is made: the style, and text without mathematics.

    Names may contain `$`, which matplotlib would read as mathematics. Names may contain letters
    that the font lacks (drawn as boxes) or be too long for their place; both warnings are off.
    """
    from matplotlib import rc_context

    with rc_context({**style, "text.parse_math": False}), warnings.catch_warnings():
        for about in (r"Glyph \d+ ", "constrained_layout not applied"):
            warnings.filterwarnings("ignore", about, UserWarning)
        yield


@contextmanager
def rendering(figure: Figure) -> Iterator[None]:
    """Settings while a figure made under `figure_style` is rendered: ticks may be powers of ten."""
    from matplotlib import rc_context
    from matplotlib.text import Text
    from matplotlib.ticker import FixedFormatter, LogFormatterMathtext

    for text in figure.findobj(Text):
        assert isinstance(text, Text)
        safe = _lines(text.get_text())
        if text.get_wrap():  # matplotlib wraps text as mathematics whatever is set
            safe = safe.replace("$", r"\$")
            text.set_parse_math(True)
        text.set_text(safe)
    for axis in (axis for axes in figure.axes for axis in (axes.xaxis, axes.yaxis)):
        formatter = axis.get_major_formatter()
        if isinstance(formatter, FixedFormatter):
            axis.set_major_formatter(FixedFormatter([*map(_lines, formatter.seq)]))
        if isinstance(formatter, LogFormatterMathtext):
            for text in axis.findobj(Text):
                assert isinstance(text, Text)
                text.set_parse_math(text is not axis.label)
    with rc_context({"text.parse_math": True}):
        yield


def template_environment(folder: Path, **options: Any) -> Environment:
    """Jinja environment of a folder's templates; all values that fill them are escaped."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined
    from markupsafe import Markup

    return Environment(
        loader=FileSystemLoader(folder),
        autoescape=True,
        undefined=StrictUndefined,
        finalize=lambda value: value if isinstance(value, Markup) else _lines(str(value)),
        **options,
    )


def markdown_text(text: str) -> str:
    """The text on one line for a page in Markdown, without markup, HTML and addresses."""
    return re.sub(r"([!-,./:-@\[-`{-~])", r"\\\1", escaped(text))


def plotly_text(text: str) -> str:
    """The text on one line with HTML escaped, because plotly reads text as HTML."""
    return html.escape(escaped(text), quote=False)


def _lines(text: str) -> str:
    return "\n".join(map(escaped, text.split("\n")))

"""Names on a terminal are shown, never obeyed."""

import io
import re

import pytest
from rcskin.simulator.safe_text import escaped, markdown_text, terminal

OBEYED = ["\x1b[31m", "\x9b2J", "\x1b]0;title\x07", "a\rb", "a\nb", "\u202eabc", "\u2028", "\x7f"]
HARMLESS = ["[red]it[/red]", "[/]", "[link=http://x]y[/link]", "kΩ, 10 µm², 5°", "指尖", ":smile:"]


@pytest.mark.parametrize("text", OBEYED)
def test_what_a_terminal_would_obey_is_written_out(text):
    assert escaped(text).isprintable() and escaped(text) != text
    assert escaped(escaped(text)) == escaped(text)


@pytest.mark.parametrize(
    "text",
    [
        *("<script>alert(1)</script>", "![x](http://x/y.png)", "[x](javascript:alert(1))"),
        *(
            "www.x.org",
            "http://x",
            "a@x.org",
            "**a**",
            "`a`",
            "$a$",
            "&lt;",
            "# a",
            "a\n# b",
            "|a|",
        ),
    ],
)
def test_nothing_in_a_name_is_markdown(text):
    """Each sign that begins some has a backslash before it."""
    shown = markdown_text(text)
    assert shown.isprintable() and not re.search(r"(?<!\\)[!#$&*./:<=>@\[\]_`|~](?!\\)", shown)
    assert re.sub(r"\\(.)", r"\1", shown) == escaped(text)
    assert markdown_text("left-top 1") == "left-top 1"


@pytest.mark.parametrize("text", HARMLESS)
def test_other_text_and_markup_stay_as_they_are(text):
    assert escaped(text) == text


@pytest.mark.parametrize("text", [*OBEYED, *HARMLESS])
def test_tables_titles_and_lines_show_it_whole(text, monkeypatch):
    from rich.table import Table
    from rich.text import Text

    monkeypatch.setenv("COLUMNS", "200")
    console = terminal()
    console.file = written = io.StringIO()
    table = Table(text, title=text)
    table.add_row(text)
    for each in (table, text, Text(text.replace("\n", ""))):
        console.print(each)
    got = written.getvalue()
    assert got.count(escaped(text)) >= 4
    assert all(line.isprintable() for line in got.split("\n"))

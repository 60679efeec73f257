"""Lines of a text file in any usual encoding, and their cells."""

from __future__ import annotations

import codecs
import csv
import re
from collections.abc import Iterator
from pathlib import Path

from .. import inputs
from ..digests import check_text
from ..errors import InputError

Lines = list[tuple[int, str]]
"""Numbers and texts of lines."""
SEPARATORS = {"\t": "tab", ";": "semicolon", ",": "comma"}
WIDE, SPACE = "  ", " "
"""Separators of at least two spaces, and of any space."""
ALL_SEPARATORS = (*SEPARATORS, WIDE, SPACE)
COMMENTS = "#%;!"
BYTE_ORDER_MARK = "\N{ZERO WIDTH NO-BREAK SPACE}"
"""Stands at the start of a file, and inside where files were joined; it is no text."""
QUOTED_LINE = re.compile(r'\s*"((?:[^"]|"")*)"[\s;,]*')
"""A line that another program wrote as one cell."""
GLUED = re.compile(r"(?<!\s)\s+(?=[(\[/])|(?<=/)\s+")
"""Space between a name and its unit."""


def text_lines(path: Path) -> Iterator[Lines]:
    """The lines of a file, in each encoding that may be meant, the most likely first.

    Raises InputError if the file is not text or does not match its checksum.
    """
    content = inputs.table(path)
    check_text(path, content)
    for text in _decoded(content):
        if "\0" in text:
            line = text[: text.index("\0")].count("\n") + 1
            raise InputError(f"{path}: line {line}: not text")
        plain = text.replace(BYTE_ORDER_MARK, "").replace("\r\r\n", "\n")
        plain = plain.replace("\r\n", "\n").replace("\r", "\n")
        yield list(enumerate(map(_unquoted, plain.split("\n")), 1))


def _unquoted(line: str) -> str:
    """The line without the quotes around the whole of it."""
    match = QUOTED_LINE.fullmatch(line)
    return line if match is None else match[1].replace('""', '"')


def _decoded(content: bytes) -> Iterator[str]:
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        yield content.decode("utf-16", errors="replace")
    elif (wide := _utf_16(content)) is not None:
        yield content.decode(wide, errors="replace")
    else:
        content = content.replace(codecs.BOM_UTF8, b"")
        try:
            yield content.decode("utf-8")
        except UnicodeDecodeError:
            yield from _legacy(content)


def _utf_16(content: bytes) -> str | None:
    """The encoding of UTF-16 without a mark, in which every other byte of ASCII is 0."""
    even, odd = content[:4000:2], content[1:4000:2]
    for encoding, zeros, others in (("utf-16-le", odd, even), ("utf-16-be", even, odd)):
        if zeros.count(0) > 0.4 * len(zeros) and others.count(0) < 0.1 * len(others):
            return encoding
    return None


def _legacy(content: bytes) -> Iterator[str]:
    """Shift-JIS where its signs and Greek letters occur, Western encodings, and GB 18030."""
    if re.search(rb"[\x81-\x84][\x40-\xfc]", content):
        try:
            yield content.decode("cp932")
        except UnicodeDecodeError:
            pass
    try:
        yield content.decode("cp1252")
    except UnicodeDecodeError:
        yield content.decode("latin-1")
    try:
        yield content.decode("gb18030")
    except UnicodeDecodeError:
        pass


def is_comment(text: str, separator: str | None = None) -> bool:
    """True for a line that begins with a comment sign other than the separator."""
    bare = text.lstrip(" ")
    signs = tuple(COMMENTS.replace(separator or "\n", ""))
    return bare.startswith(signs) and not bare.upper().startswith("#N/A")


def header_cells(text: str, separator: str) -> list[str]:
    """The cells of a line as column names, without leading comment signs."""
    bare = text.strip(" ").lstrip(COMMENTS if separator != ";" else "#%!").strip(" ")
    if separator in (WIDE, SPACE) and '" "' not in bare:
        pattern = r"\s{2,}|\t" if separator == WIDE else r"\s+"
        names = re.split(pattern, GLUED.sub("\0", bare.strip()))
        return _named([name.replace("\0", " ") for name in names])
    try:
        cells = next(csv.reader([bare], delimiter=separator[0], skipinitialspace=True), [])
    except csv.Error:
        return []
    return _named([cell.strip() for cell in cells])


def _named(cells: list[str]) -> list[str]:
    """The names without empty ones and numbers at the end."""
    end = len(cells)
    while end and (not cells[end - 1] or cells[end - 1].isdigit()):
        end -= 1
    return cells[:end]


def line_cells(text: str, separator: str) -> list[str]:
    """The cells of a line. Raises csv.Error for a quote without its end."""
    if separator in (WIDE, SPACE):
        return text.split() if separator == SPACE else re.split(r"\s{2,}|\t", text.strip())
    cells = next(csv.reader([text], delimiter=separator, strict=True), [])
    return [cell.strip() for cell in cells]


def trimmed(cells: list[str], length: int = 0) -> list[str]:
    """The cells without empty ones at the end, at least `length` where there are as many."""
    end = len(cells)
    while end > length and not cells[end - 1]:
        end -= 1
    return cells[:end]

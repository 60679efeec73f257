"""Constant tables, statements and text of C code."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

A_LINE = 6
"""Numbers on a line of a table."""


@dataclass
class CTable:
    """A constant table. kind: type in C. content: its numbers as text."""

    name: str
    kind: str
    size: int
    content: str


@dataclass
class CCode:
    """What a model adds to the templates of C code.

    statements: lines of the function that localizes. functions: names of the helpers in use.
    width: largest number of values between two statements. work: size of the scratch array.
    table_bytes: bytes of all tables.
    """

    tables: list[CTable] = field(default_factory=list)
    statements: list[str] = field(default_factory=list)
    functions: set[str] = field(default_factory=set)
    width: int = 1
    work: int = 1
    table_bytes: int = 0

    def numbers(self, values: ArrayLike) -> str:
        """Name of a new table of single precision, row by row."""
        single = np.asarray(values, dtype=np.float64).astype(np.float32).ravel()
        return self._table("float", 4, [number(each) for each in single])

    def indices(self, values: ArrayLike) -> str:
        """Name of a new table of integers below 2**16."""
        return self._table("unsigned short", 2, [str(int(each)) for each in np.ravel(values)])

    def _table(self, kind: str, size: int, parts: list[str]) -> str:
        lines = [", ".join(parts[k : k + A_LINE]) for k in range(0, len(parts), A_LINE)]
        content = ",\n    ".join(lines)
        for known in self.tables:
            if (known.kind, known.content) == (kind, content):
                return known.name
        name = f"table_{len(self.tables)}"
        self.tables.append(CTable(name, kind, len(parts), content))
        self.table_bytes += size * len(parts)
        return name

    def call(self, function: str, *arguments: object, result: str = "") -> None:
        """Adds the statement that calls a helper."""
        self.functions.add(function)
        text = ", ".join(map(str, arguments))
        self.statements.append(f"{result}{function}({text});")


def number(value: float | np.floating) -> str:
    """A number of single precision in C."""
    text = str(np.float32(value))
    return f"{text}f" if re.search(r"[.e]", text) else f"{text}.0f"


def identifier(text: str) -> str:
    """The text as an identifier of C."""
    name = re.sub(r"[^a-z0-9_]", "_", text.lower()).strip("_")
    return name if name[:1].isalpha() else f"model_{name}"


def string(text: str) -> str:
    """A string literal of C: bytes of UTF-8, with an escape for all but plain characters."""
    plain = {*range(0x20, 0x7F)} - {*b'"\\?'}
    return '"' + "".join(chr(b) if b in plain else f"\\{b:03o}" for b in text.encode()) + '"'


def comment(text: str) -> str:
    """The text within a comment of C."""
    return " ".join(ascii(text)[1:-1].replace("*/", "* /").replace("/*", "/ *").split())


def listed(items: Iterable[str]) -> str:
    """Items of an initializer."""
    return ", ".join(items)

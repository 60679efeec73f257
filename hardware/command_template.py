"""Command lines of other programs with placeholders."""

from __future__ import annotations

import os
import re
import shlex
from string import Formatter
from typing import Any

from ..simulator.sweeps import InputError

PATH_OF_WINDOWS = re.compile(r"""(^|[\s"'=])([A-Za-z]:\\|\\\\\w)""")
"""Start of `C:\\lab` or `\\\\server\\lab`."""


def split_command(command: str) -> list[str]:
    """Words of a command line, split at spaces outside of quotes.

    A backslash escapes the next character. On Windows, or if the command holds a Windows path, a
    backslash is an ordinary character. Raises ValueError for a quote without its end.
    """
    lexer = shlex.shlex(command, posix=True, punctuation_chars=False)
    lexer.whitespace_split, lexer.commenters = True, ""
    if os.name == "nt" or PATH_OF_WINDOWS.search(command):
        lexer.escape = ""
    return list(lexer)


class CommandTemplate:
    """A command line with placeholders `{name}`.

    Raises InputError if it is empty, or has an unknown placeholder, a format or an attribute.
    """

    def __init__(self, command: str, option: str, needed: bool = False, **examples: Any) -> None:
        """option: its name in errors. needed: True if a placeholder must be there.

        examples: the known placeholders, each with an example value.
        """
        try:
            self._words = split_command(command)
            parts = [part[1:] for word in self._words for part in Formatter().parse(word)]
            fields = {part for part in parts if part[0] is not None}
            known = {(name, "", None) for name in examples}
            if not "".join(self._words[:1]) or not fields <= known or (needed and not fields):
                raise ValueError(command)
        except ValueError as error:
            *others, last = (f"{{{name}}}" for name in examples)
            listed = f"{', '.join(others)} or {last}" if others else last
            raise InputError(
                f"`{option}` must be a command with the placeholder {listed}, got {command!r}"
            ) from error

    def filled(self, **values: Any) -> list[str]:
        """Words of the command with these values."""
        return [word.format(**values) for word in self._words]

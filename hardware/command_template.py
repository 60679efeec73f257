"""A command of another program, with what it is told filled in."""

from __future__ import annotations

import os
import re
import shlex
from string import Formatter
from typing import Any

from ..simulator.sweeps import InputError

PATH_OF_WINDOWS = re.compile(r"""(^|[\s"'=])([A-Za-z]:\\|\\\\\w)""")
"""The begin of `C:\\lab` or `\\\\server\\lab`."""


def split_command(command: str) -> list[str]:
    """The words of a command line, split at spaces outside of quotes.

    A backslash takes the next character as it stands, but on Windows and where the command names a
    path of Windows it is a character like others. Raises ValueError for a quote without its end.
    """
    lexer = shlex.shlex(command, posix=True, punctuation_chars=False)
    lexer.whitespace_split, lexer.commenters = True, ""
    if os.name == "nt" or PATH_OF_WINDOWS.search(command):
        lexer.escape = ""
    return list(lexer)


class CommandTemplate:
    """A command line with `{name}` in it, each to be filled in with a value of its own.

    Raises InputError where it is empty, names another, or asks for a part of a value or a format of
    its own.
    """

    def __init__(self, command: str, option: str, needed: bool = False, **examples: Any) -> None:
        """option: as errors call it. needed: whether a name must be there. examples: of each."""
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
                f"`{option}` must be a command with {listed} to be filled in, got {command!r}"
            ) from error

    def filled(self, **values: Any) -> list[str]:
        """The words of the command."""
        return [word.format(**values) for word in self._words]

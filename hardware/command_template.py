"""Command lines of other programs with placeholders."""

from __future__ import annotations

import os
import re
import shlex
from string import Formatter
from typing import Any, NoReturn

from ..simulator.sweeps import InputError

PATH_OF_WINDOWS = re.compile(r"""(^|[\s"'=])([A-Za-z]:\\|\\\\\w)""")
"""Start of `C:\\lab` or `\\\\server\\lab`."""
OPTION = re.compile(r"-(?!\d+$)")
"""Start of a word that programs take for an option; -1 is a number."""
BATCH_FILE, SIGNS_OF_CMD = (".bat", ".cmd"), re.compile(r"""["%&|<>^!()]""")
"""Programs that Windows runs by its shell cmd.exe, and what that would obey in an argument."""


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
            self._option, self._words = option, split_command(command)
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
        """Words of the command with these values, which may come from files of others.

        Raises InputError for a value that the program would take for an option, or that the shell
        of Windows would obey.
        """
        words = [word.format(**values) for word in self._words]
        program = self._words[0]
        for number, (word, given) in enumerate(zip(words, self._words, strict=True)):
            named = given.startswith("-") or "--" in self._words[1:number]
            if OPTION.match(word) and not named:
                self._refuse(word, f"an option of {program}", "write -- before it")
            if program.lower().endswith(BATCH_FILE) and word != given and SIGNS_OF_CMD.search(word):
                self._refuse(word, "a command to cmd.exe", "call another program than a batch file")
        return words

    def _refuse(self, word: str, role: str, instead: str) -> NoReturn:
        raise InputError(f"`{self._option}`: {word!r} would be {role}: rename it, or {instead}")

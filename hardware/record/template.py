"""A command of another program, with what it is told filled in."""

from __future__ import annotations

import shlex
from string import Formatter
from typing import Any

from ...simulator.sweeps import InputError


class Template:
    """A command line with `{name}` in it, each to be filled in with a value of its own.

    Raises InputError where it is empty, names another, or asks for a part of a value.
    """

    def __init__(self, command: str, option: str, **examples: Any) -> None:
        """option: as errors call it. examples: a value of each name."""
        try:
            self._words = shlex.split(command)
            parts = [part for word in self._words for part in Formatter().parse(word)]
            names = {name for _, name, _, _ in parts if name is not None}
            if not self._words or not names <= examples.keys():
                raise ValueError(command)
            self.filled(**examples)
        except (ValueError, LookupError, TypeError) as error:
            *others, last = (f"{{{name}}}" for name in examples)
            listed = f"{', '.join(others)} or {last}" if others else last
            raise InputError(
                f"`{option}` must be a command with {listed} to be filled in, got {command!r}"
            ) from error

    def filled(self, **values: Any) -> list[str]:
        """The words of the command."""
        return [word.format(**values) for word in self._words]

"""A command of another program, with what it is told filled in."""

from __future__ import annotations

import shlex
from string import Formatter
from typing import Any

from ..simulator.sweeps import InputError


class Template:
    """A command line with `{name}` in it, each to be filled in with a value of its own.

    Raises InputError where it is empty, names another, or asks for a part of a value or a format of
    its own.
    """

    def __init__(self, command: str, option: str, needed: bool = False, **examples: Any) -> None:
        """option: as errors call it. needed: whether a name must be there. examples: of each."""
        try:
            self._words = shlex.split(command)
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

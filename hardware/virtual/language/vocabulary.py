"""Vocabulary of a dialect: its commands, found by their words."""

from __future__ import annotations

import re
from collections.abc import Iterable

from .meter_command import MeterCommand, all_forms

DIGITS = re.compile(r"\d+$")


class Vocabulary:
    """Commands by all their forms. A word with `#` takes a number as its suffix, 1 if missing."""

    def __init__(self, commands: Iterable[MeterCommand]) -> None:
        self.commands = tuple(commands)
        self._forms = {
            tuple(word.removesuffix("#") for word in form): (command, form)
            for command in self.commands
            for form in all_forms(command.header)
        }

    def find(self, words: tuple[str, ...]) -> tuple[MeterCommand, tuple[int, ...]] | None:
        """Command that these words write in long or short form, and the numbers of its suffixes.

        None if unknown.
        """
        found = self._forms.get(words)
        if found is None:
            found = self._forms.get(tuple(DIGITS.sub("", word) for word in words))
        if found is None:
            return None
        command, form = found
        suffixes = []
        for word, known in zip(words, form, strict=True):
            digits = DIGITS.search(word)
            if known.endswith("#"):
                suffixes.append(int(digits[0][:6]) if digits else 1)
            elif word != known:
                return None
        return command, tuple(suffixes)

"""Vocabulary of a dialect: its commands, found by their words."""

from __future__ import annotations

import re
from collections.abc import Iterable
from itertools import product

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
        for form in product(*({word: 0, DIGITS.sub("", word): 0} for word in words)):
            command, known = self._forms.get(form, (None, ()))
            if command and all(
                word == written or mark.endswith("#")
                for word, written, mark in zip(words, form, known, strict=True)
            ):
                return command, tuple(
                    int(word.removeprefix(mark[:-1])[:6] or 1)
                    for word, mark in zip(words, known, strict=True)
                    if mark.endswith("#")
                )
        return None

"""Commands of a virtual meter: header in short and long form, set and query."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import chain, product
from typing import Any

from .parser import MISSING_PARAMETER, PARAMETER_NOT_ALLOWED, CommandError, Message

NODE = re.compile(r"(\[)?:?([A-Za-z*][A-Za-z0-9]*#?)\]?")


def short_form(word: str) -> str:
    """`FREQuency` -> `FREQ`."""
    return "".join(letter for letter in word if not letter.islower())


def all_forms(header: str) -> set[tuple[str, ...]]:
    """All forms of a header such as `:RANGe[:VALue]`, in capitals, word by word.

    A word in brackets may be omitted. A word that ends with `#` keeps this mark.
    """
    nodes = NODE.findall(header if header.startswith(("*", ":", "[")) else f":{header}")
    choices = [
        {(short_form(word),), (word.upper(),), *([()] if bracket else [])}
        for bracket, word in nodes
    ]
    return {tuple(chain.from_iterable(form)) for form in product(*choices)}


def matched_word(text: str, words: Iterable[str]) -> str | None:
    """Word that the text writes in short or long form, in its long form; None if there is none."""
    given = text.upper()
    return next((word.upper() for word in words if given in (short_form(word), word.upper())), None)


Act = Callable[..., Any]


@dataclass(frozen=True)
class MeterCommand:
    """A header in its documented form, whose capitals are the short form.

    on_set, on_query: called with the meter and the arguments; None if the form does not exist.
    set_arguments, query_arguments: their numbers of arguments, or the lowest and highest number.
    has_header: True if answers may have a header. siblings_only: True if the first model of a
    family knows it in compatibility mode only.
    """

    header: str
    on_set: Act | None = None
    on_query: Act | None = None
    set_arguments: int | tuple[int, int] = 1
    query_arguments: int | tuple[int, int] = 0
    has_header: bool = True
    siblings_only: bool = False

    def check_arguments(self, message: Message) -> None:
        """Raise CommandError if the message has too few or too many arguments."""
        allowed = self.query_arguments if message.query else self.set_arguments
        low, high = allowed if isinstance(allowed, tuple) else (allowed, allowed)
        if len(message.arguments) < low:
            raise CommandError(message.arguments, MISSING_PARAMETER)
        if len(message.arguments) > high:
            raise CommandError(message.arguments, PARAMETER_NOT_ALLOWED)

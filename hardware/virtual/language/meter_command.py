"""Commands of the virtual meter: header in short and long form, set and query."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import product
from typing import Any

from .parser import Message


def short_form(word: str) -> str:
    """`FREQuency` -> `FREQ`."""
    return "".join(letter for letter in word if not letter.islower())


def all_forms(header: str) -> set[tuple[str, ...]]:
    """All forms of a header such as `:RANGe:AUTO`, in capitals, word by word."""
    words = header.lstrip(":").split(":")
    return set(product(*({short_form(word), word.upper()} for word in words)))


def matched_word(text: str, words: Iterable[str]) -> str | None:
    """Word that the text writes in short or long form, in its long form; None if there is none."""
    given = text.upper()
    return next((word.upper() for word in words if given in (short_form(word), word.upper())), None)


Act = Callable[..., Any]


@dataclass(frozen=True)
class MeterCommand:
    """A header in its documented form, whose capitals are the short form.

    on_set, on_query: called with the meter and the arguments; None if the form does not exist.
    set_arguments, query_arguments: their numbers of arguments. has_header: True if answers may have
    a header.
    siblings_only: True if the IM3523 knows it in compatibility mode only.
    """

    header: str
    on_set: Act | None = None
    on_query: Act | None = None
    set_arguments: int = 1
    query_arguments: int = 0
    has_header: bool = True
    siblings_only: bool = False

    def fits(self, message: Message) -> bool:
        """True if the message has the right number of arguments."""
        return len(message.arguments) == (
            self.query_arguments if message.query else self.set_arguments
        )

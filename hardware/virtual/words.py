"""Words of commands: exactly the short form or the long one, in any case, and nothing between."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import product


def short(word: str) -> str:
    """`FREQuency` -> `FREQ`."""
    return "".join(letter for letter in word if not letter.islower())


def forms(header: str) -> set[tuple[str, ...]]:
    """Every way to write a header such as `:RANGe:AUTO` in capitals, word by word."""
    words = header.lstrip(":").split(":")
    return set(product(*({short(word), word.upper()} for word in words)))


def chosen(text: str, words: Iterable[str]) -> str | None:
    """The one of `words` that the text writes in short or long form, in its long form."""
    given = text.upper()
    return next((word.upper() for word in words if given in (short(word), word.upper())), None)

"""Language of a virtual meter: commands in short and long form, found by their words.

A line is parsed into messages; `;` keeps the path of words, a leading `:` resets it.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from decimal import Decimal
from itertools import chain, product
from typing import Any

NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d{1,3})?", re.ASCII)


def engineering(value: float, digits: int) -> str:
    """Engineering notation with so many significant digits, such as `49.9299E+03`."""
    mantissa, exponent = f"{value:.{digits - 1}E}".split("E")
    shift = int(exponent) % 3
    moved = Decimal(mantissa).scaleb(shift)
    return f"{moved:.{max(digits - 1 - shift, 0)}f}E{int(exponent) - shift:+03d}"


def number(text: str, low: float, high: float) -> float:
    """Number in an argument.

    Raises CommandError if it is none, ExecutionError if it is out of range.
    """
    if NUMBER.fullmatch(text) is None:
        raise CommandError(text, NUMERIC_DATA_ERROR)
    if not low <= float(text) <= high:
        raise ExecutionError(text, DATA_OUT_OF_RANGE)
    return float(text)


def integer(text: str, low: int, high: int) -> int:
    """Number in an argument, rounded to a whole one as a meter does. Raises as `number`."""
    value = number(text, -math.inf, math.inf)
    if not low - 0.5 <= value < high + 0.5:
        raise ExecutionError(text, DATA_OUT_OF_RANGE)
    return math.floor(value + 0.5)


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


WORDS = r"[A-Za-z]\w*(?::[A-Za-z]\w*)*"
SYNTAX_ERROR, PARAMETER_NOT_ALLOWED, MISSING_PARAMETER = -102, -108, -109
UNDEFINED_HEADER, SUFFIX_OUT_OF_RANGE, NUMERIC_DATA_ERROR = -113, -114, -120
TRIGGER_IGNORED, DATA_OUT_OF_RANGE = -211, -222
HEADER = re.compile(rf"(\*[A-Za-z]+|:?{WORDS})(\?)?", re.ASCII)


class LanguageError(Exception):
    """An error of a client. code: number of the error in SCPI 1999, volume 2, chapter 21."""

    default_code = 0

    def __init__(self, text: object, code: int | None = None) -> None:
        super().__init__(text)
        self.code = self.default_code if code is None else code


class CommandError(LanguageError):
    """The message is no command: the rest of the line is discarded."""

    default_code = -100


class ExecutionError(LanguageError):
    """The command is impossible now or with this value."""

    default_code = -200


@dataclass(frozen=True)
class Message:
    """One command or query; words in capitals, a common command as the single word `*XXX`."""

    words: tuple[str, ...]
    query: bool
    arguments: tuple[str, ...]


def messages(line: str) -> Iterator[Message]:
    """Messages of a line, one by one, so that those before an error are executed.

    Raises CommandError at the first malformed message.
    """
    path: tuple[str, ...] = ()
    for text in line.split(";"):
        header, *rest = text.split(maxsplit=1) or [""]
        match = HEADER.fullmatch(header)
        if match is None:
            raise CommandError(text, SYNTAX_ERROR)
        written = match[1].upper()
        words = tuple(written.lstrip(":").split(":"))
        if not written.startswith("*"):
            words = words if written.startswith(":") else path + words
            path = words[:-1]
        yield Message(words, bool(match[2]), _arguments(*rest))


def _arguments(text: str = "") -> tuple[str, ...]:
    if not text.strip():
        return ()
    arguments = tuple(part.strip() for part in text.split(","))
    if not all(arguments):
        raise CommandError(text, SYNTAX_ERROR)
    return arguments

"""Language of a virtual meter: commands in short and long form, found by their words.

A line is parsed into messages; `;` keeps the path of words, a leading `:` resets it.
"""

from __future__ import annotations

import math
import re
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from itertools import chain, product
from typing import Any

from ..meter.setting import (
    ChoiceFormat,
    IntegerFormat,
    MeterProperty,
    NumberFormat,
    OnOffFormat,
    PartsFormat,
    RegisterFormat,
    StateFormat,
    TokenFormat,
    ValueFormat,
    WordFormat,
)


def engineering(value: float, digits: int) -> str:
    """Engineering notation with so many significant digits, such as `49.9299E+03`."""
    mantissa, exponent = f"{value:.{digits - 1}E}".split("E")
    shift = int(exponent) % 3
    moved = Decimal(mantissa).scaleb(shift)
    return f"{moved:.{max(digits - 1 - shift, 0)}f}E{int(exponent) - shift:+03d}"


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


class Language(ABC):
    """How the meters of a maker read arguments and write answers, by the formats of a dialect."""

    @abstractmethod
    def number(self, text: str, low: float, high: float, unit: str = "") -> float:
        """Number in an argument. Raises CommandError if it is none, ExecutionError out of range."""

    @abstractmethod
    def unknown_word(self, text: str) -> LanguageError:
        """Error of an argument that is none of the words."""

    @abstractmethod
    def word_text(self, word: str) -> str:
        """A word in an answer. word: as the manual prints it."""

    @abstractmethod
    def switch_text(self, on: bool) -> str:
        """Answer of a switch."""

    def integer(self, text: str, low: int, high: int) -> int:
        """Whole number in an argument, rounded. Raises as `number`."""
        return math.floor(self.number(text, low, high) + 0.5)

    def word(self, text: str, words: Iterable[str]) -> str:
        """The one of the words that an argument writes, as the manual prints it."""
        found = next((word for word in words if matched_word(text, (word,))), None)
        if found is None:
            raise self.unknown_word(text)
        return found

    def switch(self, text: str) -> bool:
        """True for ON or 1, False for OFF or 0."""
        return self.word(text, ("ON", "1", "OFF", "0")) in ("ON", "1")

    def parse(self, allowed: ValueFormat[Any], texts: Sequence[str], present: Any = None) -> Any:
        """Value in the arguments of a command, as the driver reads it in an answer.

        present: value before, of which parts without an argument are kept. Raises LanguageError.
        """
        text = texts[0]
        match allowed:
            case NumberFormat(unit, low, high, _, resolution):
                value = self.number(text, low, high, unit.upper())
                return float(f"{value:.{resolution - 1}E}") if resolution else value
            case IntegerFormat(low, high, word):
                return low if word and text.upper() == word else self.integer(text, low, high)
            case ChoiceFormat(unit, numbers):
                value = self.number(text, -math.inf, math.inf, unit.upper())
                if value not in numbers:
                    raise self.unknown_word(text)
                return allowed.read(str(value))
            case WordFormat(words):
                return self.word(text, words).upper()
            case TokenFormat(words):
                return short_form(self.word(text, words))
            case OnOffFormat():
                return self.switch(text)
            case StateFormat():
                return "ON" if self.switch(text) else "OFF"
            case RegisterFormat(highest):
                return tuple(
                    self.integer(each, 0, n) for each, n in zip(texts, highest, strict=True)
                )
            case PartsFormat(parts):
                given = zip(parts, texts, strict=False)
                return (*(self.parse(part, [one]) for part, one in given), *present[len(texts) :])
        raise TypeError(f"no argument has the format {allowed}")

    def show(self, allowed: ValueFormat[Any], value: Any) -> str:
        """A value of a setting in an answer."""
        match allowed:
            case NumberFormat(answered=form):
                return engineering(value, int(form[3:])) if form[:3] == "eng" else f"{value:{form}}"
            case IntegerFormat(low, _, word):
                return word if word and value == low else str(value)
            case WordFormat(words):
                return self.word_text(next(word for word in words if word.upper() == value))
            case OnOffFormat() | StateFormat():
                return self.switch_text(value in (True, "ON"))
            case RegisterFormat():
                return ",".join(map(str, value))
            case PartsFormat(parts):
                return ",".join(map(self.show, parts, value))
        return str(value)


def arguments_of(allowed: ValueFormat[Any]) -> int | tuple[int, int]:
    """Number of arguments of a value, or the lowest and the highest number."""
    if isinstance(allowed, RegisterFormat):
        return allowed.count
    return (1, len(allowed.parts)) if isinstance(allowed, PartsFormat) else 1


def manual_form(header: str) -> str:
    """Header of a row with all words that may be omitted in square brackets."""
    return header.replace("(", "[").replace(")", "]")


def setting_command(
    language: Language, name: str, row: MeterProperty[Any], moves_reading: bool = True
) -> MeterCommand:
    """Command of a row: it sets the virtual meter's setting of this name, and answers it."""
    header, allowed = manual_form(row.header), row.twin
    suffixes = header.count("#")

    def set_value(meter: Any, *given: Any) -> None:
        check_suffixes(given[:suffixes])
        present = getattr(meter.settings, name)
        setattr(meter.settings, name, language.parse(allowed, given[suffixes:], present))
        if moves_reading:
            meter.changed()

    def query(meter: Any, *given: Any) -> str:
        check_suffixes(given)
        return language.show(allowed, getattr(meter.settings, name))

    return MeterCommand(header, set_value, query, set_arguments=arguments_of(allowed))


def setting_commands(
    language: Language,
    found: Mapping[str, MeterProperty[Any]],
    special: Mapping[str, MeterCommand],
    shown_only: Sequence[str] = (),
) -> tuple[MeterCommand, ...]:
    """Commands of the rows of a dialect, in their order.

    special: commands of rows that do more than set a value. shown_only: settings that change what
    an answer holds, and no reading.
    """
    return tuple(
        special.get(name) or setting_command(language, name, row, name not in shown_only)
        for name, row in found.items()
        if name in special or row.default is not None
    )


def check_suffixes(suffixes: Sequence[int]) -> None:
    """Raise CommandError unless all numbers of a header's suffixes are 1."""
    if any(number != 1 for number in suffixes):
        raise CommandError(suffixes, SUFFIX_OUT_OF_RANGE)

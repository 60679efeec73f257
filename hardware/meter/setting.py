"""Settings of a meter as declared properties: the rows of a dialect.

A dialect is a class whose attributes are rows: `frequency = Setting(":FREQuency[:CW]", ...)`. A
driver is a subclass and sets by the rows; the virtual meter parses and answers by the same rows.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass
from numbers import Real
from typing import TYPE_CHECKING, Any, Generic, Protocol, Self, TypeVar, overload

from ...simulator.sweeps import InputError
from .errors import RefusedError

if TYPE_CHECKING:
    from .conversation import Conversation

Value_co = TypeVar("Value_co", covariant=True)
NO_NUMBER = 9.9e37
"""A meter that speaks SCPI writes this number where it has none."""
NO_VALUE = 9e37
"""From here on a number stands for none."""


class ValueFormat(Protocol[Value_co]):
    """Allowed values of a setting, and their written form."""

    def __str__(self) -> str:
        """Allowed values with their unit."""
        ...

    def write(self, value: Any) -> str | None:
        """Value as the meter reads it; None if it is not allowed."""
        ...

    def read(self, text: str) -> Value_co:
        """Value that the meter wrote. Raises ValueError if the text is none."""
        ...


@dataclass(frozen=True)
class NumberFormat:
    """Numbers in a unit, sent with `digits` significant digits.

    resolution: digits to which the meter rounds; 0 if it keeps the number. answered: format of the
    meter's answer, or `eng5` for five digits with an exponent in threes.
    """

    unit: str
    low: float
    high: float
    digits: int
    resolution: int = 0
    answered: str = "+.5E"

    def __str__(self) -> str:
        return f"from {self.low:g} to {self.high:g} {self.unit}"

    def write(self, value: Any) -> str | None:
        """The number in exponent form, such as `1.0000E+03`."""
        within = _is_number(value) and self.low <= value <= self.high
        return f"{value:.{self.digits - 1}E}" if within else None

    def read(self, text: str) -> float:
        """A finite number."""
        value = float(text)
        if not math.isfinite(value):
            raise ValueError(text)
        return value


@dataclass(frozen=True)
class IntegerFormat:
    """Whole numbers. lowest_word: the meter's word for the lowest, or empty."""

    low: int
    high: int
    lowest_word: str = ""

    def __str__(self) -> str:
        return f"a whole number from {self.low} to {self.high}"

    def write(self, value: Any) -> str | None:
        """The number in digits, or the word for the lowest."""
        if not (_is_number(value) and value == int(value) and self.low <= value <= self.high):
            return None
        return self.lowest_word if self.lowest_word and value == self.low else str(int(value))

    def read(self, text: str) -> int:
        """A whole number."""
        if self.lowest_word and text.upper() == self.lowest_word:
            return self.low
        return int(text)


@dataclass(frozen=True)
class WordFormat:
    """One of several words. The meter may answer with the short or the long form."""

    words: tuple[str, ...]

    def __str__(self) -> str:
        return "one of " + ", ".join(word.upper() for word in self.words)

    def write(self, value: Any) -> str | None:
        """The word in its long form."""
        return next((word for word in self._long() if str(value).upper() == word), None)

    def read(self, text: str) -> str:
        """The word in its long form."""
        for word, long in zip(self.words, self._long(), strict=True):
            if text.strip().upper() in (long, "".join(c for c in word if not c.islower())):
                return long
        raise ValueError(text)

    def _long(self) -> list[str]:
        return [word.upper() for word in self.words]


@dataclass(frozen=True)
class RegisterFormat:
    """Registers of eight bits, of which a meter has at least these; further ones are left out if 0.

    highest: largest number that the meter takes in each.
    """

    highest: tuple[int, ...]

    @property
    def count(self) -> int:
        """Number of registers."""
        return len(self.highest)

    def __str__(self) -> str:
        return f"{self.count} whole numbers from 0 to 255"

    def write(self, value: Any) -> str | None:
        """The numbers in digits, separated by commas."""
        fits = len(value) >= self.count and all(_is_number(each) for each in value)
        return ",".join(str(int(each)) for each in value) if fits else None

    def read(self, text: str) -> tuple[int, ...]:
        """The numbers."""
        numbers = [int(each) for each in text.split(",")]
        while len(numbers) > self.count and not numbers[-1]:
            numbers.pop()
        return tuple(numbers)


@dataclass(frozen=True)
class OnOffFormat:
    """On or off."""

    def __str__(self) -> str:
        return "True or False"

    def write(self, value: Any) -> str | None:
        """ON or OFF."""
        return ("ON" if value else "OFF") if isinstance(value, bool) else None

    def read(self, text: str) -> bool:
        """True if on. A header before the word is ignored."""
        text = text.split()[-1]
        return {"ON": True, "1": True, "OFF": False, "0": False}[text.strip().upper()]


@dataclass(frozen=True)
class ChoiceFormat:
    """One of several numbers in a unit."""

    unit: str
    numbers: tuple[float, ...]

    def __str__(self) -> str:
        return f"one of {', '.join(f'{number:g}' for number in self.numbers)} {self.unit}"

    def write(self, value: Any) -> str | None:
        """The number."""
        return f"{value:g}" if _is_number(value) and value in self.numbers else None

    def read(self, text: str) -> float:
        """A finite number; one of `numbers` as it stands there."""
        value = NumberFormat(self.unit, -math.inf, math.inf, 12).read(text)
        return next((each for each in self.numbers if each == value), value)


@dataclass(frozen=True)
class StateFormat:
    """ON or OFF as a word; the meter may answer with 1 or 0."""

    def __str__(self) -> str:
        return "ON or OFF"

    def write(self, value: Any) -> str | None:
        """The word."""
        return str(value).upper() if str(value).upper() in ("ON", "OFF") else None

    def read(self, text: str) -> str:
        """The word."""
        return "ON" if OnOffFormat().read(text) else "OFF"


@dataclass(frozen=True)
class TokenFormat:
    """Any word of the meter, such as the name of a page; it is kept as the meter wrote it.

    words: those that are known, in short and long form. The driver sends others, too.
    """

    words: tuple[str, ...] = ()

    def __str__(self) -> str:
        return "a word of the meter"

    def write(self, value: Any) -> str | None:
        """The word."""
        text = str(value).upper()
        return text if text.replace(",", "").isalnum() else None

    def read(self, text: str) -> str:
        """The word."""
        if not text:
            raise ValueError(text)
        return text.upper()


@dataclass(frozen=True)
class PartsFormat:
    """Several values in one command, separated by commas, each in its own format."""

    parts: tuple[ValueFormat[Any], ...]

    def __str__(self) -> str:
        return "; ".join(map(str, self.parts))

    def write(self, value: Any) -> str | None:
        """The values."""
        pairs = zip(self.parts, value, strict=True)
        written = [part.write(each) for part, each in pairs]
        return None if None in written else ",".join(filter(None, written))

    def read(self, text: str) -> tuple[Any, ...]:
        """The values."""
        pairs = zip(self.parts, text.split(","), strict=True)
        return tuple(part.read(each.strip()) for part, each in pairs)


@dataclass(frozen=True)
class NumbersFormat:
    """Numbers, any or each in a format. most: largest count of them."""

    each: NumberFormat | None = None
    most: int = 3000

    def __str__(self) -> str:
        return f"at most {self.most} numbers {self.each}" if self.each else "numbers"

    def write(self, value: Any) -> str | None:
        """The numbers."""
        texts = [self.each.write(one) if self.each else f"{one:.12g}" for one in value]
        fits = None not in texts and len(texts) <= self.most
        return (",".join(filter(None, texts)) if fits else None) or None

    def read(self, text: str) -> tuple[float, ...]:
        """The numbers; none in an empty answer."""
        numbers = [float(one) for one in text.split(",") if text]
        if self.each and not all(math.isfinite(number) for number in numbers):
            raise ValueError(text)
        return tuple(number for number in numbers if not self.each or number < NO_VALUE)


def _is_number(value: Any) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value)


T = TypeVar("T")


class SettingsOwner(Protocol):
    """An object with settings: it has a conversation with a meter."""

    talk: Conversation
    original: dict[str, Any] | None
    cached: dict[str, Any]

    @property
    def restored_last(self) -> tuple[str, ...]:
        """Settings that are restored after all others, in this order."""
        ...

    def save_original(self) -> None:
        """Save `original`, which has changed; the meter is about to change, too."""
        ...


def driver_form(header: str) -> str:
    """Header as the driver sends it: `:FREQuency[:CW]` -> `:FREQuency`, `#` -> 1.

    Words in square brackets may be omitted and are; words in round ones may be, and are sent.
    """
    return re.sub(r"\[.*?\]|[()]", "", header).replace("#", "1")


class MeterProperty(Generic[T]):
    """A property that the meter reports. Each access queries the meter.

    header: of the command, as the manual prints it (capitals are the short form), see
    `driver_form`; empty if this is no row of a dialect. default: value after a reset. twin: what
    the virtual meter allows, where a real one may have more.
    """

    def __init__(
        self,
        header: str,
        allowed: ValueFormat[T],
        meaning: str,
        default: Any = None,
        *,
        twin: ValueFormat[Any] | None = None,
    ) -> None:
        self.header, self.allowed, self.meaning = header, allowed, meaning
        self.command = driver_form(header)
        self.query, self.__doc__ = f"{self.command}?", f"{meaning}: {allowed}."
        self.default, self.twin = default, twin or allowed

    def for_twin(self, allowed: ValueFormat[Any]) -> Self:
        """A copy of this row with fewer values on the virtual meter."""
        row = copy(self)
        row.twin = allowed
        return row

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    @overload
    def __get__(self, meter: None, owner: type) -> Self: ...
    @overload
    def __get__(self, meter: SettingsOwner, owner: type) -> T: ...
    def __get__(self, meter: Any, owner: type) -> Self | T:
        return self if meter is None else self.query_of(meter)

    def query_of(self, meter: Any) -> T:
        """Present value on a meter."""
        return meter.talk.query(self.query, self.read_answer)

    def __set__(self, meter: SettingsOwner, value: T) -> None:
        raise AttributeError(f"`{self.name}` is read from the meter and cannot be set")

    def read_answer(self, text: str) -> T:
        """Value in an answer. Raises ValueError."""
        try:
            return self.allowed.read(text.strip())
        except (KeyError, IndexError) as error:
            raise ValueError(text) from error


class Setting(MeterProperty[T]):
    """A property that can also be set. Each set is followed by a check of the event register."""

    def __init__(
        self,
        header: str,
        allowed: ValueFormat[T],
        meaning: str,
        default: Any = None,
        *,
        twin: ValueFormat[Any] | None = None,
        each_range: Sequence[int] = (),
        moves: str = "",
        clear: str = "",
    ) -> None:
        """each_range: numbers of the ranges, if the meter keeps one value per range; all are set to
        the same value.

        moves: another setting that changes with this one. clear: command that empties a table.
        """
        super().__init__(header, allowed, meaning, default, twin=twin)
        self.command_text = f"{self.command} ALL," if each_range else f"{self.command} "
        self.each_range, self._moves, self._clear = each_range, moves, clear

    def query_of(self, meter: Any) -> T:
        """Present value on a meter; that of the present range if each has its own."""
        query = f"{self.query} {meter.range}" if self.each_range else self.query
        return meter.talk.query(query, self.read_answer)

    def __set__(self, meter: SettingsOwner, value: T) -> None:
        """Set it.

        Raises InputError if the value is not allowed, RefusedError if the meter refuses.
        """
        text = self.allowed.write(value)
        if text is None:
            raise InputError(f"`{self.name}` must be {self.allowed}, got {value}")
        self._save_original(meter)
        meter.talk.send(f"{self.command_text}{text}")
        meter.cached[self.name] = self.allowed.read(text)

    def current_value(self, meter: SettingsOwner) -> T | tuple[T, ...]:
        """Present value, or one value per range; an empty table if the meter refuses the query."""
        if self.each_range:
            return tuple(
                meter.talk.query(f"{self.query} {n}", self.read_answer) for n in self.each_range
            )
        try:
            return self.__get__(meter, type(meter))
        except RefusedError:
            if isinstance(self.allowed, NumbersFormat):
                return ()
            raise

    def restore(self, meter: SettingsOwner, found: Any) -> None:
        """Set a value that `current_value` gave earlier. Raises as `__set__`.

        A table that was empty is emptied if the model has a command for it.
        """
        if isinstance(self.allowed, NumbersFormat) and not found:
            if self._clear:
                meter.talk.send(self._clear)
        elif not self.each_range or len(set(found)) == 1:
            self.__set__(meter, found[0] if self.each_range else found)
        else:
            for n, value in zip(self.each_range, found, strict=True):
                meter.talk.send(f"{self.command} {n},{self.allowed.write(value)}")

    def _save_original(self, meter: SettingsOwner) -> None:
        """Add the present value to the meter's original settings, with `moves`, if missing."""
        if meter.original is None:
            return
        missing = [each for each in (self._moves, self.name) if each and each not in meter.original]
        for each in missing:
            meter.original[each] = getattr(type(meter), each).current_value(meter)
        if missing:
            meter.save_original()


class SettingPart(MeterProperty[T]):
    """One value of a setting that holds several, see `PartsFormat`."""

    def __init__(self, whole: Setting[Any], index: int, meaning: str) -> None:
        allowed: ValueFormat[T] = whole.allowed.parts[index]  # pyright: ignore
        super().__init__("", allowed, meaning)
        self._whole, self._index = whole, index

    def query_of(self, meter: Any) -> T:
        """Present value of the part."""
        return self._whole.query_of(meter)[self._index]

    def __set__(self, meter: SettingsOwner, value: T) -> None:
        """Set it, and leave the other parts. Raises as a `Setting`."""
        text = self.allowed.write(value)
        if text is None:
            raise InputError(f"`{self.name}` must be {self.allowed}, got {value}")
        values = list(self._whole.query_of(meter))
        values[self._index] = self.allowed.read(text)
        self._whole.__set__(meter, tuple(values))


FROM_MEMORY, CHOSEN = "from memory", "chosen here"
"""Sources of what rests on no text that was at hand."""


def source_of(dialect: Any, name: str) -> str:
    """What a row of a dialect rests on: a text of `sources`, or else `source`."""
    known = (text for text, names in dialect.sources.items() if name in names.split())
    return next(known, dialect.source)


def rows(dialect: type) -> dict[str, MeterProperty[Any]]:
    """Rows of a dialect by name, those of its base classes first."""
    found: dict[str, Any] = {}
    for each in reversed(dialect.__mro__):
        found |= vars(each)
    return {
        name: row for name, row in found.items() if isinstance(row, MeterProperty) and row.header
    }

"""Formats of settings: the allowed values, and how they are written and read."""

from __future__ import annotations

import math
from dataclasses import dataclass
from numbers import Real
from typing import Any, Protocol, TypeVar

Value_co = TypeVar("Value_co", covariant=True)


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
    """Numbers in a unit, sent with `digits` significant digits."""

    unit: str
    low: float
    high: float
    digits: int

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
    """`count` registers of eight bits. Further ones of a model are left out if they are 0."""

    count: int

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
        """A finite number."""
        return NumberFormat(self.unit, -math.inf, math.inf, 12).read(text)


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
    """Any word of the meter, such as the name of a page; it is kept as the meter wrote it."""

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


def _is_number(value: Any) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value)

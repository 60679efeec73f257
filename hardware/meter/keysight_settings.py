"""Settings of Keysight's meters that are more than one number or word."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from .errors import RefusedError
from .keysight_meter import NO_VALUE
from .setting import Setting, SettingsOwner
from .setting_formats import NumberFormat, ValueFormat


class AmplitudeFormat:
    """Amplitude with its unit: `0.5 V` or `0.001 A`, rms."""

    limits: ClassVar[Mapping[str, float]] = {"V": 20.0, "A": 0.1}
    commands: ClassVar[Mapping[str, str]] = {"V": ":VOLTage", "A": ":CURRent"}

    def __str__(self) -> str:
        return " or ".join(f"from 0 to {most:g} {unit}" for unit, most in self.limits.items())

    def write(self, value: Any) -> str | None:
        """The command with the number."""
        number, _, unit = str(value).partition(" ")
        if unit not in self.limits:
            return None
        try:
            text = NumberFormat(unit, 0, self.limits[unit], 4).write(float(number))
        except ValueError:
            return None
        return text and f"{self.commands[unit]} {text}"

    def read(self, text: str) -> str:
        """The amplitude in a command."""
        command, _, number = text.partition(" ")
        unit = next(unit for unit, each in self.commands.items() if each == command)
        return f"{float(number):.4g} {unit}"


class AmplitudeSetting(Setting[str]):
    """Amplitude of the generator: a voltage or a current, whichever the meter controls.

    The query of the other one is an error and has no answer.
    """

    def __init__(self) -> None:
        super().__init__("", AmplitudeFormat(), "Amplitude of the generator, rms")
        self.command_text = ""

    def __get__(self, meter: Any, owner: type) -> Any:
        if meter is None:
            return self
        commands = AmplitudeFormat.commands
        latest = str(meter.cached.get(self.name, "V"))[-1]
        first, second = sorted(commands, key=lambda unit: unit != latest)
        try:
            value = self._query(meter, first)
        except RefusedError:
            value = self._query(meter, second)
        meter.cached[self.name] = value
        return value

    def _query(self, meter: SettingsOwner, unit: str) -> str:
        command = AmplitudeFormat.commands[unit]
        return meter.talk.query(f"{command}?", lambda text: self.allowed.read(f"{command} {text}"))


class FrequencyListFormat:
    """Frequencies in Hz."""

    def __init__(self, each: NumberFormat, most: int) -> None:
        self._each, self.most = each, most

    def __str__(self) -> str:
        return f"at most {self.most} frequencies {self._each}"

    def write(self, value: Any) -> str | None:
        """The frequencies."""
        texts = [self._each.write(each) for each in value]
        return None if None in texts or len(texts) > self.most else ",".join(filter(None, texts))

    def read(self, text: str) -> tuple[float, ...]:
        """The frequencies; none in an empty answer."""
        numbers = [self._each.read(each) for each in text.split(",") if text]
        return tuple(number for number in numbers if number < NO_VALUE)


class NumbersFormat:
    """Any numbers."""

    def __str__(self) -> str:
        return "numbers"

    def write(self, value: Any) -> str | None:
        """The numbers."""
        return ",".join(f"{each:.12g}" for each in value) or None

    def read(self, text: str) -> tuple[float, ...]:
        """The numbers; none in an empty answer."""
        return tuple(float(each) for each in text.split(",") if text)


class NumbersSetting(Setting[tuple[float, ...]]):
    """A table of numbers; empty if the meter has none.

    clear: command that empties the table; empty if the model has none, and then the table of the
    driver stays.
    """

    def __init__(
        self, command: str, allowed: ValueFormat[tuple[float, ...]], meaning: str, clear: str = ""
    ) -> None:
        super().__init__(command, allowed, meaning)
        self._clear = clear

    def current_value(self, meter: SettingsOwner) -> tuple[float, ...]:
        """Present numbers."""
        try:
            return self.__get__(meter, type(meter))
        except RefusedError:
            return ()

    def restore(self, meter: SettingsOwner, found: Any) -> None:
        """Set numbers that `current_value` gave earlier."""
        if found:
            self.__set__(meter, found)
        elif self._clear:
            meter.talk.send(self._clear)

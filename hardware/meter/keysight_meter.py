"""Common part of Keysight's LCR meters and analysers: sweeps, and settings of several values."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any, ClassVar

from .errors import GarbledError, RefusedError
from .lcr_meter import SEARCHES, LcrMeter
from .meter_reading import MeterReading, ReadingStatus
from .setting import MeterProperty, NumberFormat, Setting, SettingsOwner, StateFormat, ValueFormat

NO_VALUE = 9e37
"""The meter writes 9.9E37 where it has no number."""
CORRECTION_SECONDS = 120.0
"""Time that the meter may be silent while it acquires a correction, s."""


class KeysightMeter(LcrMeter):
    """A meter that sweeps by itself, with a queue of errors.

    max_points: of a sweep. rounding: largest relative rounding of a frequency by the meter. delays:
    settings that `set_up` sets to 0 s, because they make each reading longer.
    correction_commands: acquire a correction. correction_states: switch its use ON or OFF.
    """

    extents = ("ALL", "OFF")
    sweeps = True
    error_query = ":SYSTem:ERRor?"
    max_points: ClassVar[int]
    rounding: ClassVar[float]
    delays: ClassVar[tuple[str, ...]]
    correction_commands: ClassVar[Mapping[str, str]]
    correction_states: ClassVar[Mapping[str, str]]
    open_correction: ClassVar[MeterProperty[str]]
    short_correction: ClassVar[MeterProperty[str]]

    def set_up(self) -> None:
        """End a sweep that may still run, and set the meter up; readings have no delay."""
        self.talk.send(":ABORt")
        super().set_up()
        for name in self.delays:
            setattr(self, name, 0.0)

    @abstractmethod
    def sweep_once(self, frequencies: Sequence[float]) -> list[MeterReading]:
        """Readings of one sweep, at most `max_points` frequencies in Hz."""

    def read_sweep(self, frequencies: Sequence[float]) -> list[MeterReading]:
        """Readings at frequencies in Hz, by sweeps of at most `max_points`."""
        found: list[MeterReading] = []
        for begin in range(0, len(frequencies), self.max_points):
            found += self.sweep_once(frequencies[begin : begin + self.max_points])
        return found

    @contextmanager
    def sweeping(self, frequencies: Sequence[float]) -> Iterator[float]:
        """Block in which a sweep runs. Gives its longest time, s.

        After a signal the meter counts as busy for that time.
        """
        _ = self.seconds  # fills the cache
        each = [self.reading_seconds({**self.cached, "frequency": f}) for f in frequencies]
        self._sweep_seconds = SEARCHES * sum(each)
        yield self._sweep_seconds
        self._sweep_seconds = 0.0

    def check_frequencies(self, frequencies: Sequence[float], reported: Sequence[float]) -> None:
        """Raises GarbledError if the meter measured at other frequencies, Hz."""
        if len(reported) != len(frequencies):
            raise GarbledError(
                f"{self.resource}: the meter swept {len(reported)} frequencies instead of "
                f"{len(frequencies)}; check that nothing else sets it"
            )
        for wanted, found in zip(frequencies, reported, strict=True):
            if not abs(found / wanted - 1) <= self.rounding:
                raise GarbledError(
                    f"{self.resource}: the meter is at {found:g} Hz instead of {wanted:g} Hz; "
                    "check that nothing else sets it, and that the model has this frequency"
                )

    def start_correction(self, kind: str, extent: str) -> None:
        """Start to acquire a correction at all frequencies, or end its use.

        The meter may be silent until it has the correction.
        """
        if extent == "OFF":
            self.talk.send(f"{self.correction_states[kind]} OFF")
            return
        self.talk.send("*CLS")
        self._sweep_seconds = CORRECTION_SECONDS
        self.talk.send(self.correction_commands[kind], CORRECTION_SECONDS)

    def correction_fault(self, kind: str) -> str:
        """Fault of the correction that has ended; empty if there is none, and then it is used."""
        self._sweep_seconds = 0.0
        error = self.talk.query(self.error_query, str.strip)
        if not error.lstrip("+").startswith("0"):
            return f"error {error}"
        self.talk.send(f"{self.correction_states[kind]} ON")
        return ""

    def cancel_correction(self, kind: str) -> None:
        """Cancel the started correction."""
        self.talk.send(":ABORt")


def state_of(command: str, meaning: str) -> MeterProperty[str]:
    """Property that is ON or OFF."""
    return MeterProperty(f"{command}?", StateFormat(), meaning)


def reading_of(R: float, X: float, status: ReadingStatus = ReadingStatus.NORMAL) -> MeterReading:
    """Reading of R and X in ohm. Raises ValueError for numbers that are none."""
    if not all(abs(value) < NO_VALUE for value in (R, X)) or R == X == 0:
        raise ValueError(f"{R:g},{X:g}")
    return MeterReading(complex(R, X), status)


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

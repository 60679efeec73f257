"""Settings of a meter as declared properties: command, allowed values and meaning."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Generic, Protocol, Self, TypeVar, overload

from ...simulator.sweeps import InputError
from .setting_formats import ValueFormat

if TYPE_CHECKING:
    from .link.conversation import Conversation

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


class MeterProperty(Generic[T]):
    """A property that the meter reports. Each access queries the meter."""

    def __init__(self, query: str, allowed: ValueFormat[T], meaning: str) -> None:
        """query: text of the query; `{range}` in it stands for the present range."""
        self.query, self.allowed, self.__doc__ = query, allowed, f"{meaning}: {allowed}."

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
        at = {"range": meter.range} if "{range}" in self.query else {}
        return meter.talk.query(self.query.format(**at), self.read_answer)

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
        command: str,
        allowed: ValueFormat[T],
        meaning: str,
        *,
        each_range: Sequence[int] = (),
        moves: str = "",
    ) -> None:
        """each_range: numbers of the ranges, if the meter keeps one value per range; all are set to
        the same value.

        moves: another setting that changes with this one.
        """
        super().__init__(f"{command}? {{range}}" if each_range else f"{command}?", allowed, meaning)
        self.command_text = f"{command} ALL," if each_range else f"{command} "
        self._command, self._each_range, self._moves = command, each_range, moves

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
        """Present value, or one value per range."""
        if not self._each_range:
            return self.__get__(meter, type(meter))
        return tuple(
            meter.talk.query(f"{self._command}? {n}", self.read_answer) for n in self._each_range
        )

    def restore(self, meter: SettingsOwner, found: Any) -> None:
        """Set a value that `current_value` gave earlier. Raises as `__set__`."""
        if not self._each_range or len(set(found)) == 1:
            self.__set__(meter, found[0] if self._each_range else found)
            return
        for n, value in zip(self._each_range, found, strict=True):
            meter.talk.send(f"{self._command} {n},{self.allowed.write(value)}")

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
        super().__init__(whole.query, allowed, meaning)
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

"""Switch between interfaces: turned, read back, and returned to its original position."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Generic, Protocol, TypeVar

from ...simulator.sweeps import InputError
from ..meter.errors import MeterError


class SwitchError(MeterError):
    """The switch between meter and skin failed. The message is one line."""


class NoSwitchError(SwitchError):
    """The switch cannot be opened, or its connection is lost."""


class SilentSwitchError(SwitchError):
    """The switch gave no complete answer in time."""


class GarbledSwitchError(SwitchError):
    """The answer is not one that such a switch gives."""


class RefusedSwitchError(SwitchError):
    """The switch refused a command."""


class StuckSwitchError(SwitchError):
    """The switch reports another position than the requested one."""


Position = TypeVar("Position")
POLL_INTERVAL = 0.01
"""Seconds between two queries of a turning switch."""


class Switch(Protocol):
    """Connects the meter to one interface at a time."""

    @property
    def selected(self) -> str | None:
        """Connected interface, or None if unknown."""
        ...

    def select(self, name: str) -> None:
        """Connect an interface, and return when it may be measured. Raises SwitchError."""
        ...

    def check_stayed(self) -> None:
        """Raises SwitchError if the switch has turned away since `select`."""
        ...

    def close(self) -> None:
        """Return to the original position, if known, and close. Closing twice does no harm."""
        ...


class SwitchDevice(Protocol[Position]):
    """A device that turns. All methods raise SwitchError if they fail."""

    def put(self, position: Position, /) -> None:
        """Start to go to a position."""
        ...

    def reported_position(self) -> Position | None:
        """Position that the device reads back; None without a read-back."""
        ...

    def close(self) -> None:
        """Close the device."""
        ...


@dataclass
class DeviceSwitch(Generic[Position]):
    """A switch by a device, which is opened when needed and again after a failure.

    positions: by interface. settle: s from the end of a turn to the first reading. patience: s in
    which the read-back must report the new position.
    """

    open: Callable[[], SwitchDevice[Position]]
    positions: Mapping[str, Position]
    settle: float
    patience: float = 5.0
    selected: str | None = field(default=None, init=False)
    _device: SwitchDevice[Position] | None = field(default=None, init=False)
    _original: Position | None = field(default=None, init=False)

    def __post_init__(self) -> None:
        for name, value in (("settle", self.settle), ("timeout", self.patience)):
            if not 0 <= value <= 3600:
                raise InputError(f"`{name}` must be in [0, 3600] s, got {value:g}")

    def select(self, name: str) -> None:
        """Connect an interface. Raises InputError if it has no position, SwitchError."""
        if name not in self.positions:
            known = ", ".join(self.positions)
            raise InputError(f"the switch knows the interfaces {known}, got {name!r}")
        before, self.selected = self.selected, None
        try:
            turned = self._turn_if_needed(name, before)
        except SwitchError:
            self._drop()
            raise
        if turned:
            time.sleep(self.settle)
        self.selected = name

    def check_stayed(self) -> None:
        """Raises SwitchError if the read-back shows another position: turned late, or by others."""
        name, device = self.selected, self._device
        if name is None or device is None:
            return
        try:
            reported = device.reported_position()
            if reported is not None and reported != self.positions[name]:
                raise StuckSwitchError(
                    f"the switch turned to {_position_text(reported)} while interface {name}, "
                    f"position {_position_text(self.positions[name])}, was measured; check that "
                    "nothing else turns it"
                )
        except SwitchError:
            self.selected = None
            self._drop()
            raise

    def close(self) -> None:
        """Return the device to its original position, if it reported one, and close it."""
        self.selected = None
        with suppress(SwitchError):
            if (
                self._device
                and self._original is not None
                and self._device.reported_position() != self._original
            ):
                self._device.put(self._original)
        self._drop()

    def _turn_if_needed(self, name: str, before: str | None) -> bool:
        """Turn if necessary; True if it turned."""
        if self._device is None:
            self._device = self.open()
            self._original = (
                self._device.reported_position() if self._original is None else self._original
            )
        device, position = self._device, self.positions[name]
        reported = device.reported_position()
        if reported == position or (reported is None and before == name):
            return False
        device.put(position)
        if reported is not None:
            self._confirm(device, name)
        return True

    def _confirm(self, device: SwitchDevice[Position], name: str) -> None:
        end = time.monotonic() + self.patience
        while (reported := device.reported_position()) != self.positions[name]:
            if time.monotonic() > end:
                raise StuckSwitchError(
                    f"the switch reports position {_position_text(reported)} after "
                    f"{self.patience:g} s instead of interface {name}, position "
                    f"{_position_text(self.positions[name])}; check its power, its wiring, and "
                    "that nothing else turns it"
                )
            time.sleep(POLL_INTERVAL)

    def _drop(self) -> None:
        device, self._device = self._device, None
        if device:
            device.close()


def _position_text(position: object) -> str:
    if isinstance(position, frozenset):
        return f"({', '.join(map(str, sorted(position)))})"
    return str(position)

"""Switches of a command: a person, any command, or one by its name."""

from __future__ import annotations

import shlex
import subprocess
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from ...simulator.sweeps import InputError
from ..command_template import CommandTemplate
from ..control_client import checked_address, send_request
from ..meter.errors import PressError
from .switch import DeviceSwitch, NoSwitchError, RefusedSwitchError, SilentSwitchError, Switch

ASK = "ask"
SETTLE = 0.05
COMMAND_TIMEOUT = 60.0


def switch_from_options(
    name: str | None,
    command: str | None,
    settle: float | None,
    interfaces: Sequence[str],
    ask: Callable[[str], object] | None = None,
) -> Switch | None:
    """Switch for these interfaces; None for a single interface without options.

    ask: asks a person to connect an interface, with `--switch ask` or without options. Raises
    InputError.
    """
    if name and command:
        raise InputError("`switch` and `switch-with` cannot both connect the interface")
    if not (name or command) and len(interfaces) == 1:
        return None
    switch = _make_switch(name, command, settle, interfaces, ask)
    missing = set(interfaces) - set(switch.positions)
    if missing:
        raise InputError(
            f"{name}: lacks the interface {', '.join(sorted(missing))}; it has "
            f"{', '.join(switch.positions)}"
        )
    return switch


def _make_switch(
    name: str | None,
    command: str | None,
    settle: float | None,
    interfaces: Sequence[str],
    ask: Callable[[str], object] | None,
) -> DeviceSwitch:
    by_name = {each: each for each in interfaces}
    waiting = SETTLE if settle is None else settle
    if command:
        template = CommandTemplate(command, "switch-with", needed=True, interface="left")
        for interface in interfaces:  # refused before anything is measured
            template.filled(interface=interface)
        device = CommandSwitch(template, COMMAND_TIMEOUT)
        return DeviceSwitch(lambda: device, by_name, waiting)
    if name is not None and name != ASK:
        return _named_switch(name, settle, waiting, by_name)
    if ask is None:
        raise InputError(
            f"the interfaces {', '.join(interfaces)} need a switch that works without a person: "
            "--switch TABLE.toml, --switch HOST:PORT or --switch-with"
        )
    person = ManualSwitch(ask)
    return DeviceSwitch(lambda: person, by_name, waiting)


def _named_switch(
    name: str, settle: float | None, waiting: float, by_name: dict[str, str]
) -> DeviceSwitch:
    if name.endswith(".toml"):
        from .boards import read_switch

        return read_switch(Path(name), settle)
    checked_address(name, "`switch` must be TABLE.toml, HOST:PORT or ask")
    device = VirtualSwitch(name)
    return DeviceSwitch(lambda: device, by_name, waiting)


@dataclass(frozen=True)
class ManualSwitch:
    """A person who connects interfaces. ask: asks for one, returns when it is connected."""

    ask: Callable[[str], object]

    def put(self, position: str, /) -> None:
        """Ask the person to connect an interface."""
        self.ask(position)

    def reported_position(self) -> None:
        """None: the person is trusted."""

    def close(self) -> None:
        """Does nothing: no connection is open."""


@dataclass(frozen=True)
class CommandSwitch:
    """A command that switches, run without a shell.

    template: with the placeholder `{interface}`. timeout: longest time, s.
    """

    template: CommandTemplate
    timeout: float

    def put(self, position: str, /) -> None:
        """Run the command. Raises NoSwitchError, SilentSwitchError, RefusedSwitchError."""
        filled = self.template.filled(interface=position)
        action = f"switching to {position} by {shlex.join(filled)!r}"
        try:
            done = subprocess.run(
                filled, stdin=subprocess.DEVNULL, capture_output=True, timeout=self.timeout
            )
        except subprocess.TimeoutExpired as error:
            raise SilentSwitchError(
                f"{action} did not end within {self.timeout:g} s; check the switch that it turns"
            ) from error
        except OSError as error:
            raise NoSwitchError(f"{action} cannot be run ({error}); check its path") from error
        if done.returncode:
            said = done.stderr.decode(errors="replace").strip().splitlines()[-1:]
            raise RefusedSwitchError(
                f"{action} ended with code {done.returncode}{''.join(f' ({s})' for s in said)}; "
                "check the switch that it turns"
            )

    def reported_position(self) -> None:
        """None: the exit code is trusted."""

    def close(self) -> None:
        """Does nothing: no connection is open."""


@dataclass(frozen=True)
class VirtualSwitch:
    """Switch between a virtual meter and the interfaces of its skin. control: HOST:PORT."""

    control: str

    def put(self, position: str, /) -> None:
        """Turn to an interface. Raises InputError if the skin lacks it."""
        self._ask("select", interface=position)

    def reported_position(self) -> str:
        """The connected interface."""
        return str(self._ask("state")["interface"])

    def close(self) -> None:
        """Do nothing: there is no connection to close."""

    def _ask(self, do: str, **given: str):
        try:
            return send_request(self.control, do, **given)
        except PressError as error:
            raise NoSwitchError(str(error)) from error

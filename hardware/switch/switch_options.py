"""The switch of a command, from its options."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from ...simulator.sweeps import InputError
from .switch import DeviceSwitch, Switch

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
        from ..command_template import CommandTemplate
        from .manual_switch import CommandSwitch

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
    from .manual_switch import ManualSwitch

    person = ManualSwitch(ask)
    return DeviceSwitch(lambda: person, by_name, waiting)


def _named_switch(
    name: str, settle: float | None, waiting: float, by_name: dict[str, str]
) -> DeviceSwitch:
    if name.endswith(".toml"):
        from .switch_table import read_switch

        return read_switch(Path(name), settle)
    from ..control_client import checked_address
    from .virtual_switch import VirtualSwitch

    checked_address(name, "`switch` must be TABLE.toml, HOST:PORT or ask")
    device = VirtualSwitch(name)
    return DeviceSwitch(lambda: device, by_name, waiting)

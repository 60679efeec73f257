"""All commands of the virtual meter, found by their words."""

from __future__ import annotations

from functools import cache

from ....simulator.sweeps.meter_bands import VIRTUAL_MODEL
from .meter_command import MeterCommand, all_forms


def find_command(words: tuple[str, ...], model: str, compatible: bool) -> MeterCommand | None:
    """Command that these words write in long or short form, on this model; None if unknown."""
    command = _commands().get(words)
    if command and command.siblings_only and model == VIRTUAL_MODEL and not compatible:
        return None
    return command


@cache
def _commands() -> dict[tuple[str, ...], MeterCommand]:
    from .common_commands import COMMON_COMMANDS
    from .measuring_commands import MEASURING_COMMANDS
    from .setting_commands import SETTING_COMMANDS

    return {
        form: command
        for command in (*COMMON_COMMANDS, *SETTING_COMMANDS, *MEASURING_COMMANDS)
        for form in all_forms(command.header)
    }

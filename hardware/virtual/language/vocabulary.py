"""All commands of the virtual meter, found by their words."""

from __future__ import annotations

from functools import cache

from ....simulator.sweeps.meter_bands import VIRTUAL_MODEL
from .meter_command import MeterCommand, forms


def find(words: tuple[str, ...], model: str, compatible: bool) -> MeterCommand | None:
    """Command that these words write in long or short form, on this model; None if unknown."""
    command = _commands().get(words)
    if command and command.siblings_only and model == VIRTUAL_MODEL and not compatible:
        return None
    return command


@cache
def _commands() -> dict[tuple[str, ...], MeterCommand]:
    from .common_commands import COMMON
    from .measuring_commands import MEASURING
    from .setting_commands import STORED

    return {
        form: command
        for command in (*COMMON, *STORED, *MEASURING)
        for form in forms(command.header)
    }

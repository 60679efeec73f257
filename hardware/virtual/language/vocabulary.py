"""All commands, and the one that words write."""

from __future__ import annotations

from functools import cache

from .command import Command, forms

SIMPLE = "IM3523"


def find(words: tuple[str, ...], model: str, compatible: bool) -> Command | None:
    """The command that these words write in full or short form, on this model."""
    command = _commands().get(words)
    if command and command.siblings_only and model == SIMPLE and not compatible:
        return None
    return command


@cache
def _commands() -> dict[tuple[str, ...], Command]:
    from .common import COMMON
    from .measuring import MEASURING
    from .stored import STORED

    return {
        form: command
        for command in (*COMMON, *STORED, *MEASURING)
        for form in forms(command.header)
    }

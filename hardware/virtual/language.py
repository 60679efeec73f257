"""Commands: a header, what telling it does, what asking it answers, and how to find one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

from hardware.virtual.parser import Message
from hardware.virtual.words import forms

Act = Callable[..., Any]
SIMPLE = "IM3523"


@dataclass(frozen=True)
class Command:
    """A header in its documented form, whose capitals are the short form.

    tell, ask: called with the meter and the arguments; None where the form does not exist. takes:
    how many arguments to tell, asks: to ask. named: whether answers may carry a header.
    siblings_only: the IM3523 knows it in compatibility mode only.
    """

    header: str
    tell: Act | None = None
    ask: Act | None = None
    takes: int = 1
    asks: int = 0
    named: bool = True
    siblings_only: bool = False

    def fits(self, message: Message) -> bool:
        """Whether the message brings as many arguments as the form takes."""
        return len(message.arguments) == (self.asks if message.query else self.takes)


def find(words: tuple[str, ...], model: str, compatible: bool) -> Command | None:
    """The command that these words write in full or short form, on this model."""
    command = _commands().get(words)
    if command and command.siblings_only and model == SIMPLE and not compatible:
        return None
    return command


@cache
def _commands() -> dict[tuple[str, ...], Command]:
    from hardware.virtual.common import COMMON
    from hardware.virtual.measuring import MEASURING
    from hardware.virtual.stored import STORED

    return {
        form: command
        for command in (*COMMON, *STORED, *MEASURING)
        for form in forms(command.header)
    }

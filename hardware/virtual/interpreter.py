"""Interpreter of the virtual meters: executes the messages of a line and answers."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING

from .language import UNDEFINED_HEADER, CommandError, ExecutionError, Message, messages

if TYPE_CHECKING:
    from .instrument import Instrument


async def answer(meter: Instrument, line: str) -> str:
    """Answer of the meter to a line; empty if there is none."""
    answers: list[str] = []
    if meter.faults.take("forget"):
        meter.restart()
    try:
        for message in messages(line):
            meter.waiting = bool(answers)
            answers += await _execute(meter, message)
    except CommandError as error:
        meter.refuse(error)
    return ";".join(answers)


async def _execute(meter: Instrument, message: Message) -> list[str]:
    command, suffixes = meter.command(message.words) or (None, ())
    act = command and (command.on_query if message.query else command.on_set)
    if command is None or act is None:
        raise CommandError(message.words, UNDEFINED_HEADER)
    command.check_arguments(message)
    try:
        said = act(meter, *suffixes, *message.arguments)
        said = await said if inspect.isawaitable(said) else said
    except ExecutionError as error:
        meter.refuse(error)
        return []
    return [] if said is None else [meter.answer_text(command, str(said))]

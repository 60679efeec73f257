"""Interpreter of the virtual meter: executes the messages of a line and answers."""

from __future__ import annotations

import inspect

from .instrument import Instrument
from .language.meter_command import MeterCommand
from .language.parser import CommandError, ExecutionError, Message, messages
from .language.vocabulary import find_command
from .meter_state import Standard


async def answer(meter: Instrument, line: str) -> str:
    """Answer of the meter to a line; empty if there is none."""
    answers: list[str] = []
    if meter.faults.take("forget"):
        meter.restart()
    try:
        for message in messages(line):
            meter.waiting = bool(answers)
            answers += await _execute(meter, message)
    except CommandError:
        meter.registers.note(Standard.CME)
    return ";".join(answers)


async def _execute(meter: Instrument, message: Message) -> list[str]:
    command = find_command(message.words, meter.model, meter.settings.compatible)
    act = command and (command.on_query if message.query else command.on_set)
    if command is None or act is None:
        raise CommandError(message.words)
    if not command.fits(message):
        raise CommandError(message.arguments)
    try:
        said = act(meter, *message.arguments)
        said = await said if inspect.isawaitable(said) else said
    except ExecutionError:
        meter.registers.note(Standard.EXE)
        return []
    return [_with_header(meter, command, str(said))] if message.query else []


def _with_header(meter: Instrument, command: MeterCommand, said: str) -> str:
    named = meter.settings.header and command.has_header
    return f"{command.header.upper()} {said}" if named else said

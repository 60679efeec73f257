"""Automatic presses: from a script with times, or at random."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Coroutine, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...simulator.sweeps import UNPRESSED, InputError, ToleranceError, inputs
from .control import ControlPort

if TYPE_CHECKING:
    from .measurement import Skin

MAX_SECONDS = 1e6
"""Longest script: eleven days."""
Routine = Callable[[ControlPort], Coroutine[Any, Any, None]]


def read_script(path: Path, skin: Skin) -> list[tuple[float, str]]:
    """(seconds from the start, press) from lines `SECONDS PRESS`; `#` begins a comment.

    Raises InputError with the file and the line for another form, times that do not ascend or that
    exceed MAX_SECONDS, or a press that the skin does not have.
    """
    lines = inputs.text(path, inputs.SETTINGS).splitlines()
    steps: list[tuple[float, str]] = []
    for number, line in enumerate(lines, start=1):
        words = line.split("#")[0].split(maxsplit=1)
        if not words:
            continue
        try:
            seconds, press = float(words[0]), skin.check(words[1].strip())
        except InputError as error:
            raise InputError(f"{path}: line {number}: {error}") from error
        except (ValueError, IndexError) as error:
            raise InputError(f"{path}: line {number}: must be SECONDS PRESS") from error
        if not (steps[-1][0] if steps else 0) <= seconds <= MAX_SECONDS:
            raise InputError(
                f"{path}: line {number}: times must ascend from 0 to {MAX_SECONDS:g} s, got "
                f"{words[0]}"
            )
        steps.append((seconds, press))
    return steps


def press_by_script(steps: list[tuple[float, str]]) -> Routine:
    """Press at these times; the last press stays."""

    async def routine(control: ControlPort) -> None:
        begun = control.instrument.now
        for seconds, press in steps:
            await asyncio.sleep(begun + seconds - control.instrument.now)
            await _press(control, press)

    return routine


def press_at_random(pixels: Sequence[str], seconds: float, random: np.random.Generator) -> Routine:
    """Press a random one of these pixels, or none, every `seconds`."""
    if not 0 < seconds <= 3600:
        raise InputError(f"`random` must be in (0, 3600] s, got {seconds:g}")

    async def routine(control: ControlPort) -> None:
        while True:
            await _press(control, str(random.choice([UNPRESSED, *pixels])))
            await asyncio.sleep(seconds)

    return routine


async def _press(control: ControlPort, press: str) -> None:
    """Press the skin. An impossible press is reported, and the press before stays."""
    try:
        await control.press(press)
    except (InputError, ToleranceError) as error:
        control.instrument.report_failure(str(error))

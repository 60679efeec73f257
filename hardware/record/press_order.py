"""Order of the presses in a recording."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from itertools import product
from pathlib import Path

from ...simulator.sweeps import UNPRESSED, InputError, inputs
from ...simulator.sweeps.free_space import check_memory
from ...simulator.sweeps.press_text import parse_touches, written_pixel


@dataclass(frozen=True)
class PressStep:
    """One press. row, column: 0 for the unpressed skin, -1 if it is no single pixel."""

    press: str
    row: int
    column: int


UNPRESSED_STEP = PressStep(UNPRESSED, 0, 0)
FIRST_BASELINES = 3
BYTES_FOR_STEP = 300
"""Memory of one step, its text and its place in the order."""
UNKNOWN = "?"
"""Press of a sweep whose press is unknown."""


def parse_step(text: str, rows: int, columns: int) -> PressStep:
    """Step of a press, see `sweeps.press_text`.

    Raises InputError for other syntax, or a pixel outside rows x columns.
    """
    press = "".join(text.split())
    touches = parse_touches(press)
    for row, column in (touch.pixel for touch in touches if touch.kind == "pixel"):
        if not (1 <= row <= rows and 1 <= column <= columns):
            raise InputError(f"press {text!r}: pixels must be in 1,1 to {rows},{columns}")
    return PressStep(press, *written_pixel(press)) if touches else UNPRESSED_STEP


def standard_order(
    rows: int, columns: int, repetitions: int, without: Collection[tuple[int, int]] = ()
) -> list[PressStep]:
    """All pixels row by row, `repetitions` times, with the unpressed skin between and after.

    FIRST_BASELINES unpressed sweeps begin it. without: pixels that the skin lacks.
    """
    if not 1 <= repetitions <= 10_000:
        raise InputError(f"`repetitions` must be in 1..10000, got {repetitions}")
    check_memory(
        BYTES_FOR_STEP * rows * columns * repetitions,
        f"{repetitions} sweeps of each of {rows} x {columns} pixels",
        "ask for fewer --repetitions, or fewer `pixels`",
    )
    every = product(range(1, rows + 1), range(1, columns + 1))
    pixels = [PressStep(f"{i},{j}", i, j) for i, j in every if (i, j) not in without]
    return (
        [UNPRESSED_STEP] * (FIRST_BASELINES - 1)
        + [UNPRESSED_STEP, *pixels] * repetitions
        + [UNPRESSED_STEP]
    )


def read_order(path: Path, rows: int, columns: int) -> list[PressStep]:
    """Order in a file with one press per line; `#` begins a comment.

    Raises InputError with the file and the line.
    """
    lines = inputs.text(path, inputs.SETTINGS).splitlines()
    steps: list[PressStep] = []
    for number, line in enumerate(lines, start=1):
        text = line.split("#")[0].strip()
        if not text:
            continue
        try:
            steps.append(parse_step(text, rows, columns))
        except InputError as error:
            raise InputError(f"{path}: line {number}: {error}") from error
    if not steps:
        raise InputError(f"{path}: has no press; write one per line")
    return steps

"""The order of presses in a recording."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from ...simulator.sweeps import UNPRESSED, InputError

JOINT = re.compile(r"(?<!\de)\+", re.IGNORECASE)
TOUCH = re.compile(
    r"(?:(?P<row>\d+),(?P<column>\d+)|(?:rect|disc)\([\d.,eE+-]+\))(?::[\d.eE+-]+)?", re.ASCII
)


@dataclass(frozen=True)
class Step:
    """One press; row and column 0 where nothing is pressed, -1 where it is no single pixel."""

    press: str
    row: int
    column: int


REST = Step(UNPRESSED, 0, 0)


def parse_step(text: str, rows: int, columns: int) -> Step:
    """The step that presses `text`: ROW,COLUMN, rect(...), disc(...), several joined by '+', or
    `none`.

    Raises InputError on other syntax, or a pixel that is not among rows x columns.
    """
    press = "".join(text.split())
    if press == UNPRESSED:
        return REST
    labels = [_label(touch, text, rows, columns) for touch in JOINT.split(press)]
    return Step(press, *labels[0]) if len(labels) == 1 else Step(press, -1, -1)


def _label(touch: str, text: str, rows: int, columns: int) -> tuple[int, int]:
    """Row and column of one touch, -1 where it is no pixel."""
    match = TOUCH.fullmatch(touch)
    if match is None:
        raise InputError(
            f"press {text!r}: must be ROW,COLUMN, rect(X,Y,WIDTH,HEIGHT) or disc(X,Y,RADIUS), "
            "touches joined by '+', or 'none'"
        )
    if match["row"] is None:
        return -1, -1
    row, column = int(match["row"]), int(match["column"])
    if not (1 <= row <= rows and 1 <= column <= columns):
        raise InputError(f"press {text!r}: pixels are 1,1 to {rows},{columns}")
    return row, column


def standard_order(rows: int, columns: int, repetitions: int) -> list[Step]:
    """Every pixel row by row, so many times, with the skin at rest before, between and after."""
    if not 1 <= repetitions <= 10_000:
        raise InputError(f"`repetitions` must be in 1..10000, got {repetitions}")
    pixels = [Step(f"{i + 1},{j + 1}", i + 1, j + 1) for i in range(rows) for j in range(columns)]
    return [*[REST, *pixels] * repetitions, REST]


def read_order(path: Path, rows: int, columns: int) -> list[Step]:
    """The order in a file of one press a line; `#` begins a remark.

    Raises InputError naming the file and the line.
    """
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read: {error}") from error
    steps: list[Step] = []
    for number, line in enumerate(lines, start=1):
        text = line.split("#")[0].strip()
        if not text:
            continue
        try:
            steps.append(parse_step(text, rows, columns))
        except InputError as error:
            raise InputError(f"{path}: line {number}: {error}") from error
    if not steps:
        raise InputError(f"{path}: holds no press")
    return steps

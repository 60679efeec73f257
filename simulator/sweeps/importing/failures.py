"""Readings that failed, by a huge number, a status or the frequency 0, and how they are named."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...arrays import Real
from .tables.table import ImportedTable, LeftOut

GOOD = ("0", "ok", "normal", "valid", "good", "no error", "none", "")
"""Status of a good reading."""
MAX_NAMED = 12


def status_reasons(table: ImportedTable) -> list[str]:
    """A reason for each row whose status is bad while most are good; empty for the others.

    A status that is never good has another meaning.
    """
    reasons = [""] * len(table.rows)
    for column in table.holding("status"):
        texts = table.text(column)
        good = [_good(text) for text in texts]
        if 2 * sum(good) <= len(good):
            continue
        for place, text in enumerate(texts):
            if not good[place]:
                reasons[place] = reasons[place] or f"`{column.name}` is {text[:20]}"
    return reasons


def _good(text: str) -> bool:
    try:
        return float(text) == 0
    except ValueError:
        return text.casefold() in GOOD


def failure_reasons(table: ImportedTable, values: dict[str, Real]) -> list[str]:
    """A reason for each row in which a number of these columns says that there is no reading.

    values: by the name of the column.
    """
    reasons = [""] * len(table.rows)
    for name, numbers in values.items():
        for place in np.flatnonzero(~np.isfinite(numbers)):
            reasons[place] = reasons[place] or f"`{name}` is no reading"
    return reasons


def left_out_text(left_out: Sequence[LeftOut]) -> str:
    """The lines that were left out, by reason; empty if there are none."""
    by_reason: dict[str, list[int]] = {}
    for each in left_out:
        by_reason.setdefault(each.reason, []).append(each.line)
    listed = [f"{_lines_text(lines)} ({reason})" for reason, lines in by_reason.items()]
    more = f" and {len(listed) - MAX_NAMED} more kinds" if len(listed) > MAX_NAMED else ""
    return "; ".join(listed[:MAX_NAMED]) + more if listed else ""


def _lines_text(lines: Sequence[int]) -> str:
    """Line numbers with consecutive ones joined: `lines 3, 7-9`."""
    runs: list[list[int]] = []
    for line in sorted(lines):
        if runs and line == runs[-1][-1] + 1:
            runs[-1].append(line)
        else:
            runs.append([line])
    shown = [f"{run[0]}-{run[-1]}" if len(run) > 1 else str(run[0]) for run in runs[:MAX_NAMED]]
    more = ["..."] if len(runs) > MAX_NAMED else []
    return f"line{'s' if len(lines) > 1 else ''} {', '.join([*shown, *more])}"

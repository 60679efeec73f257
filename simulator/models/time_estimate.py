"""Estimates from the first results: cells that a tolerance needs, and the remaining time."""

from __future__ import annotations

import logging
from collections.abc import Callable
from time import perf_counter

import numpy as np

from ..arrays import Real
from ..progress import duration
from ..sweeps import ToleranceError

LOG = logging.getLogger(__name__)

MAX_CELL_PARTS = 64.0
"""Largest number of parts of one cell: if more are needed, the field is singular, and graded cells
need fewer."""
MIN_REPORTED = 60.0
"""Shortest remaining time that is reported, s."""
REPORT_AFTER = 5.0
"""Time before the first report, s; earlier times are mostly preparation."""
STEEPEST = 0.6
"""Largest power of the error by which the time of elements of order 3 grows."""


def cells_needed(parts: Real, order: int, rtol: float) -> float:
    """Minimum count of cells that may keep a tolerance; the final count is about twice as large.

    parts: share of each cell in the relative error, which is their sum, shape (cell,). A cell that
    is divided into n keeps n^-order of its share where the field is smooth. The minimum has n
    proportional to part^(1 / (order + 1)).
    """
    from scipy.optimize import brentq

    if parts.sum() <= rtol:
        return float(len(parts))

    def divided(raised: float) -> Real:
        return np.clip((np.exp(raised) * parts) ** (1 / (order + 1)), 1.0, MAX_CELL_PARTS)

    def excess(raised: float) -> float:
        n = divided(raised)
        return float((parts * n**-order)[n < MAX_CELL_PARTS].sum() - rtol)

    least, most = (-np.log(each) for each in (parts.max(), parts[parts > 0].min()))
    every = (
        most + (order + 1) * np.log(MAX_CELL_PARTS) + 1.0
    )  # beyond rounding, all have MAX_CELL_PARTS
    raised = brentq(excess, least, every)
    return float(divided(raised).sum())  # pyright: ignore[reportArgumentType]


def check_within_reach(needed: float, most: int, order: float, what: str) -> None:
    """Raise ToleranceError if a tolerance needs more than `most` cells.

    needed: lower bound. order: of the error in the number of cells. what: cells, in plural.
    """
    if needed > most:
        times = (2 * needed / most) ** order
        raise ToleranceError(f"the tolerance needs more than {most} {what}", times)


class RemainingTime:
    """Time until errors are within a tolerance, from the errors of the results so far.

    clock: s.
    """

    def __init__(self, rtol: float, clock: Callable[[], float] = perf_counter) -> None:
        self._rtol, self._clock = rtol, clock
        self._start = clock()
        self._known = list[tuple[float, float]]()

    def after(self, error: float) -> tuple[float, float]:
        """Elapsed and remaining time, s, after one more result with this largest error."""
        elapsed = self._clock() - self._start
        self._known.append((elapsed, error))
        return elapsed, self._left(self._known[-3:])

    def share(self, error: float) -> float:
        """Share of the work that is done after one more result; see `after`."""
        elapsed, left = self.after(error)
        return elapsed / (elapsed + left) if left > 0 else 1.0

    def _left(self, known: list[tuple[float, float]]) -> float:
        """Remaining time, s; it grows as a power of the error, fitted to the latest results."""
        (then, larger), (now, error) = known[0], known[-1]
        if not error > self._rtol:
            return 0.0
        if not (larger > error and now > then > 0):
            return now
        power = min(np.log(now / then) / np.log(larger / error), STEEPEST)
        return now * float((error / self._rtol) ** power - 1)


class TimeEstimate:
    """Logs once how long a press will still take, if that is a minute or more.

    clock: s.
    """

    def __init__(self, rtol: float, clock: Callable[[], float] = perf_counter) -> None:
        self._rtol, self._clock = rtol, clock
        self._reported = False

    def of(self, press: str) -> Callable[[float], None]:
        """Callback for a press, called with the largest error of each result from now on."""
        remaining = RemainingTime(self._rtol, self._clock)

        def on_error(error: float) -> None:
            elapsed, left = remaining.after(error)
            if not self._reported and elapsed >= REPORT_AFTER and left >= MIN_REPORTED:
                self._reported = True
                so_far = f"error {error:.0e} after {elapsed:.0f} s, tolerance {self._rtol:g}"
                LOG.info("press %s: %s; about %s remaining", press, so_far, duration(left))

        return on_error

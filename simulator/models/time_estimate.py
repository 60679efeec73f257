"""What a tolerance will need, told from the first answers: how many cells, and how long."""

from __future__ import annotations

import logging
from collections.abc import Callable
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from ..progress import duration
from ..sweeps import ToleranceError

LOG = logging.getLogger(__name__)

MOST_PARTS = 64.0
"""Of one cell: where more were needed, the answer is singular, and graded cells do with less."""
WORTH_A_WORD = 60.0
"""s."""
SURE_AFTER = 5.0
"""s: before, times are mostly of preparation."""
STEEPEST = 0.6
"""Power of the error that the time of elements of order 3 grows with, at the worst."""


def cells_needed(parts: NDArray[np.float64], order: int, rtol: float) -> float:
    """The fewest cells that may keep a tolerance; in the end there are about twice as many.

    parts: of each cell in the relative error, which is their sum, shape (cell,). Divided into n a
    cell keeps n^-order of its part, where all is smooth, and the fewest cells in all have n ~
    part^(1 / (order + 1)).
    """
    from scipy.optimize import brentq

    if parts.sum() <= rtol:
        return float(len(parts))

    def divided(raised: float) -> NDArray[np.float64]:
        return np.clip((np.exp(raised) * parts) ** (1 / (order + 1)), 1.0, MOST_PARTS)

    def excess(raised: float) -> float:
        n = divided(raised)
        return float((parts * n**-order)[n < MOST_PARTS].sum() - rtol)

    least, most = (-np.log(each) for each in (parts.max(), parts[parts > 0].min()))
    every = most + (order + 1) * np.log(MOST_PARTS) + 1.0  # beyond rounding, all have MOST_PARTS
    raised = brentq(excess, least, every)
    return float(divided(raised).sum())  # pyright: ignore[reportArgumentType]


def check_within_reach(needed: float, most: int, order: float, what: str) -> None:
    """Raises ToleranceError where a tolerance needs more than `most` cells.

    needed: at least. order: of the error in the number of cells. what: cells, in plural.
    """
    if needed > most:
        times = (2 * needed / most) ** order
        raise ToleranceError(f"the tolerance needs more than {most} {what}", times)


class RemainingTime:
    """How long it still takes until errors are within a tolerance, by those of the answers so far.

    clock: s.
    """

    def __init__(self, rtol: float, clock: Callable[[], float] = perf_counter) -> None:
        self._rtol, self._clock = rtol, clock
        self._start = clock()
        self._known = list[tuple[float, float]]()

    def after(self, error: float) -> tuple[float, float]:
        """Since the start and still to come, s, told the largest error of one more answer."""
        elapsed = self._clock() - self._start
        self._known.append((elapsed, error))
        return elapsed, self._left(self._known[-3:])

    def share(self, error: float) -> float:
        """Of all the work, what is done; told as `after`."""
        elapsed, left = self.after(error)
        return elapsed / (elapsed + left) if left > 0 else 1.0

    def _left(self, known: list[tuple[float, float]]) -> float:
        """By the power of the error that the time has grown with, s."""
        (then, larger), (now, error) = known[0], known[-1]
        if not error > self._rtol:
            return 0.0
        if not (larger > error and now > then > 0):
            return now
        power = min(np.log(now / then) / np.log(larger / error), STEEPEST)
        return now * float((error / self._rtol) ** power - 1)


class TimeEstimate:
    """Tells once how long a press will still take, where that is a minute or more.

    clock: s.
    """

    def __init__(self, rtol: float, clock: Callable[[], float] = perf_counter) -> None:
        self._rtol, self._clock = rtol, clock
        self._told = False

    def of(self, press: str) -> Callable[[float], None]:
        """A callback that takes the largest error of each answer to a press, from now on."""
        remaining = RemainingTime(self._rtol, self._clock)

        def on_error(error: float) -> None:
            elapsed, left = remaining.after(error)
            if not self._told and elapsed >= SURE_AFTER and left >= WORTH_A_WORD:
                self._told = True
                told = f"error {error:.0e} after {elapsed:.0f} s, asked {self._rtol:g}"
                LOG.info("press %s: %s: will take about %s more", press, told, duration(left))

        return on_error

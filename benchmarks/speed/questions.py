"""A question with the ways to answer it: how far off each is, and how long it takes.

A press on a scene whose true answer is known has this project's ways to it.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from rcskin.benchmarks.bench import Run, best_time, timed
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.models.reduced.reduced_model import Reduced
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.batch import PressBatch
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.scene import Scene


class Answer(NamedTuple):
    """Of a way at one setting. error: as the question means it. seconds: to the answer."""

    way: str
    setting: str
    error: float
    seconds: float


@dataclass(frozen=True)
class Question:
    """What is asked. error, time: what the axes mean. ours: ways of this project. wrong: an error
    that makes an answer useless. stalls: whether a way that gains little by more work is told to
    stall. pick: which way to take when, in a sentence."""

    title: str
    error: str
    time: str
    ours: tuple[str, ...]
    answers: Callable[[Run], Iterator[Answer]]
    pick: str
    wrong: float = 0.1
    stalls: bool = True

    def measured(self, run: Run) -> pd.DataFrame:
        """All answers, printed as they come."""
        found = []
        for answer in self.answers(run):
            print(f"{self.title}: {answer}", flush=True)
            found.append(answer)
        return pd.DataFrame(found, columns=list(Answer._fields))


FIRST = "rcskin"
BATCH = 500
"""Presses that a reduced model answers at once."""


@dataclass(frozen=True)
class Asked:
    """truth: Z in ohm of the scene's frequencies, shape (frequency,).

    others: asked afterwards, each once, for a press that is asked again may be known by then.
    """

    scene: Scene
    press: Press
    others: tuple[Press, ...]
    truth: NDArray[np.complex128]

    def off(self, Z: NDArray[np.complex128]) -> float:
        """Largest relative error of Rs and Cp."""
        return float(relative_difference(Z, self.truth).max())

    def by_solver(self, rtols: Sequence[float], again: str) -> Iterator[Answer]:
        """The first press at each tolerance; again: the way's name for each further one."""
        for rtol in rtols:
            seconds, Z = timed(
                lambda rtol=rtol: Solver(self.scene.parts, rtol).solve(self.press).Z[0]
            )
            yield Answer(FIRST, f"{rtol:g}", self.off(Z), seconds)
            solver = Solver(self.scene.parts, rtol)
            solver.solve(self.press)
            further = [_seconds(partial(solver.solve, other)) for other in self.others]
            yield Answer(again, f"{rtol:g}", self.off(Z), float(np.median(further)))

    def by_batch(
        self,
        way: str,
        setting: str,
        reduced: Reduced,
        cells: NDArray[np.int64],
        rises: NDArray[np.float64],
    ) -> Answer:
        """By a reduced model that was trained before, many at once; cells, rises: of the press."""
        skin = reduced.at(None)
        many = PressBatch.even(np.tile(cells, (BATCH, 1)), np.tile(rises, (BATCH, 1)))
        seconds = best_time(lambda: skin.sweeps(many)) / BATCH
        return Answer(way, setting, self.off(skin.sweeps(many)[0, 0]), seconds)


def _seconds(work: Callable[[], object]) -> float:
    start = time.perf_counter()
    work()
    return time.perf_counter() - start

"""A press on a scene whose true answer is known, and this project's ways to it."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.bench import best_time, timed
from rcskin.benchmarks.speed.answers_parts.question import Answer
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.models.reduced.reduced_model import Reduced
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.batch import PressBatch
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.scene import Scene

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
        skin = reduced.skin(None)
        many = PressBatch.even(np.tile(cells, (BATCH, 1)), np.tile(rises, (BATCH, 1)))
        seconds = best_time(lambda: skin.sweeps(many)) / BATCH
        return Answer(way, setting, self.off(skin.sweeps(many)[0, 0]), seconds)


def _seconds(work: Callable[[], object]) -> float:
    start = time.perf_counter()
    work()
    return time.perf_counter() - start

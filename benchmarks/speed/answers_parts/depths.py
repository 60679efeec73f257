"""A pixel pressed to a depth: what the electrode skins do beside the applicator counts."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.bench import Run, best_time, timed
from rcskin.benchmarks.rivals import membrane_grid
from rcskin.benchmarks.speed.answers_parts.question import Answer, Question
from rcskin.simulator.fem.estimate import relative_difference
from rcskin.simulator.models.reduced.greedy import reduce
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.capacitance import touched_cells
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.press.touch import Touch
from rcskin.simulator.scene.files import load_scene
from rcskin.simulator.scene.scene import Scene

FIRST, AGAIN, REDUCED = "rcskin", "rcskin, each further depth", "rcskin, reduced model"
EVEN, GRID = "one factor for the whole pixel", "differences, then scikit-fem Q1"
PRESS, OTHERS = "2,3:2e-3m", ("2,3:1.5e-3m", "2,3:1.8e-3m")
TRUE = 1e-6
RTOLS, OF_REDUCED = (1e-2, 1e-3, 1e-4, 1e-5), (1e-3, 1e-4)
CELLS = (2, 4, 8, 16)
"""Along the side of a pixel."""
BATCH = 500
Off = Callable[[NDArray[np.complex128]], float]
"""Largest relative error of Rs and Cp."""


def answers(run: Run) -> Iterator[Answer]:
    """By this project, by a grid of differences, and by a press that ends at its edges."""
    scene = load_scene("foam")
    press, f = parse_press(PRESS, np.nan), scene.frequencies
    truth = Solver(scene, run.sized(TRUE, 1e-4)).solve(press).Z[0]

    def off(Z: NDArray[np.complex128]) -> float:
        return float(relative_difference(Z, truth, 2 * np.pi * f).max())

    for rtol in run.sized(RTOLS, RTOLS[:1]):
        seconds, Z = timed(lambda rtol=rtol: Solver(scene, rtol).solve(press).Z[0])
        yield Answer(FIRST, f"{rtol:g}", off(Z), seconds)
        yield Answer(AGAIN, f"{rtol:g}", off(Z), _further(scene, rtol))
    for rtol in run.sized(OF_REDUCED, ()):
        yield _reduced(scene, press, rtol, off)
    even = Press((Touch(2, 3, scene.pressed_factor),))
    seconds, Z = timed(lambda: Solver(scene, 1e-5).solve(even).Z[0])
    yield Answer(EVEN, "1e-05", off(Z), seconds)
    for cells in run.sized(CELLS, CELLS[:1]):
        seconds, Z = timed(partial(membrane_grid.impedance, scene, (2, 3), f, cells))
        yield Answer(GRID, f"{cells} cells a pixel", off(Z), seconds)


def _further(scene: Scene, rtol: float) -> float:
    solver = Solver(scene, rtol)
    solver.solve(parse_press(PRESS, np.nan))
    pressed = [parse_press(text, np.nan) for text in OTHERS]
    return float(np.median([timed(partial(solver.solve, each))[0] for each in pressed]))


def _reduced(scene: Scene, press: Press, rtol: float, off: Off) -> Answer:
    cells, rises = touched_cells(scene, press)
    skin = reduce(scene, rtol).skin(None)
    many = np.tile(cells, BATCH), np.tile(rises, BATCH), np.arange(BATCH + 1) * len(cells)
    seconds = best_time(lambda: skin.sweeps(*many)) / BATCH
    return Answer(REDUCED, f"{rtol:g}", off(skin.sweeps(*many)[0, 0]), seconds)


DEPTHS = Question(
    title="Presses by depth: 2 mm into foam",
    error="Largest relative error of Rs and Cp",
    time="Time to 20 frequencies (ms)",
    ours=(FIRST, AGAIN, REDUCED),
    answers=answers,
    pick=(
        "Take the reduced model for more than a few thousand presses of pixels, "
        "the solver for all others; a press is never one factor alone."
    ),
)

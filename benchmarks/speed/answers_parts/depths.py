"""A pixel pressed to a depth: what the electrode skins do beside the applicator counts."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np
from rcskin.benchmarks.bench import Run, timed
from rcskin.benchmarks.rivals import membrane_grid
from rcskin.benchmarks.speed.answers_parts.question import Answer, Question
from rcskin.benchmarks.speed.answers_parts.solving import FIRST, Asked
from rcskin.simulator.models.reduced.greedy import reduce
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.press.rasterized import touched_cells
from rcskin.simulator.press.touch import Touch
from rcskin.simulator.scene.scene_files import load_scene

AGAIN, REDUCED = "rcskin, each further depth", "rcskin, reduced model"
EVEN, GRID = "one factor for the whole pixel", "differences, then scikit-fem Q1"
PRESS = "2,3:2e-3m"
OTHERS = tuple(f"2,3:{mm}e-3m" for mm in (1.5, 1.8, 0.9, 2.1, 1.2, 1.65, 0.75, 1.95, 1.35))
TRUE, EVEN_RTOL = 1e-6, 1e-5
RTOLS, OF_REDUCED = (1e-2, 1e-3, 1e-4, 1e-5), (1e-3, 1e-4)
CELLS = (2, 4, 8, 16)
"""Along the side of a pixel."""


def answers(run: Run) -> Iterator[Answer]:
    """By this project, by a grid of differences, and by a press that ends at its edges."""
    scene = load_scene("foam")
    press, *others = (parse_press(text, np.nan) for text in (PRESS, *OTHERS))
    truth = Solver(scene.parts, run.sized(TRUE, 1e-4)).solve(press).Z[0]
    asked = Asked(scene, press, tuple(others), truth)
    yield from asked.by_solver(run.sized(RTOLS, RTOLS[:1]), AGAIN)
    for rtol in run.sized(OF_REDUCED, ()):
        pressed = touched_cells(scene.parts.skin, press)
        yield asked.by_batch(REDUCED, f"{rtol:g}", reduce(scene.parts, rtol), *pressed)
    even = Press((Touch(2, 3, scene.press.factor(scene.parts.skin)),))
    seconds, Z = timed(lambda: Solver(scene.parts, EVEN_RTOL).solve(even).Z[0])
    yield Answer(EVEN, f"{EVEN_RTOL:g}", asked.off(Z), seconds)
    for cells in run.sized(CELLS, CELLS[:1]):
        work = partial(membrane_grid.impedance, scene, (2, 3), scene.frequencies, cells)
        seconds, Z = timed(work)
        yield Answer(GRID, f"{cells} cells a pixel", asked.off(Z), seconds)


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

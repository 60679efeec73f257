"""A rectangle anywhere on the 5x5 sheet: followed by the mesh, or laid on cells."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.bench import Run, best_time, timed
from rcskin.benchmarks.rivals import ngspice_grid, scikit_fem_script
from rcskin.benchmarks.rivals.cells import Cells
from rcskin.benchmarks.rivals.scikit_fem_script import Elements
from rcskin.benchmarks.speed.answers_parts.question import Answer, Question
from rcskin.simulator.fem.estimate import relative_difference
from rcskin.simulator.models.reduced.cases import Case
from rcskin.simulator.models.reduced.greedy import reduce
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.capacitance import touched_cells
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.press.touch import Touch
from rcskin.simulator.scene.files import load_scene
from rcskin.simulator.scene.scene import Pixels, Scene

FIRST, AGAIN, ON_CELLS = "rcskin", "rcskin, each further touch", "rcskin, data set on cells"
PRESS = "rect(0.0373,0.0611,0.021,0.017)"
OTHERS = ("rect(0.0813,0.0327,0.018,0.023)", "rect(0.0557,0.0911,0.016,0.019)")
FACTOR, TRUE = 2.0, 1e-9
RTOLS = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
RIVALS = {
    "scikit-fem Q1": (5, 10, 20, 40, 80),
    "scikit-fem Q2": (5, 10, 20, 40),
    "ngspice": (10, 20, 40),
}
"""And along how many cells a side each: an element is a cell."""
OF_DATA_SETS = (5, 10, 20)
BATCH, REDUCED_RTOL = 500, 1e-4
Off = Callable[[NDArray[np.complex128]], float]
"""Largest relative error of Rs and Cp."""


def laid(scene: Scene, press: Press, cells: int) -> tuple[Scene, Press]:
    """The same on so many cells along each side as pixels, pressed by the area that it covers."""
    finer = scene.model_copy(update={"pixels": Pixels(rows=cells, columns=cells)})
    numbers, rises = touched_cells(finer, press)
    each = zip(*divmod(numbers, cells), rises, strict=True)
    return finer, Press(tuple(Touch(int(i) + 1, int(j) + 1, 1 + float(r)) for i, j, r in each))


def answers(run: Run) -> Iterator[Answer]:
    """By this project, by elements of scikit-fem and by ngspice."""
    scene, press = load_scene("sheet-5x5"), parse_press(PRESS, FACTOR)
    f = scene.frequencies
    truth = Solver(scene, TRUE).solve(press).Z[0]

    def off(Z: NDArray[np.complex128]) -> float:
        return float(relative_difference(Z, truth, 2 * np.pi * f).max())

    others = [parse_press(text, FACTOR) for text in OTHERS]
    for rtol in run.sized(RTOLS, RTOLS[1:2]):
        seconds, Z = timed(lambda rtol=rtol: Solver(scene, rtol).solve(press).Z[0])
        yield Answer(FIRST, f"{rtol:g}", off(Z), seconds)
        solver = Solver(scene, rtol)
        again = np.median([timed(partial(solver.solve, other))[0] for other in others])
        yield Answer(AGAIN, f"{rtol:g}", off(Z), float(again))
    for cells in run.sized(OF_DATA_SETS, OF_DATA_SETS[:1]):
        yield _of_data_sets(scene, press, cells, off)
    for rival, sizes in RIVALS.items():
        if rival != "ngspice" or run.has(rival):
            yield from (
                _of_rival(rival, scene, press, cells, off) for cells in run.sized(sizes, sizes[:1])
            )


def _of_rival(rival: str, scene: Scene, press: Press, cells: int, off: Off) -> Answer:
    asked = *laid(scene, press, cells), scene.frequencies
    if rival == "ngspice":
        ngspice_grid.ensure_ngspice()
        work = partial(ngspice_grid.impedance, *asked, Cells(cells, cells))
    else:
        work = partial(scikit_fem_script.impedance, *asked, Elements(int(rival[-1]), 1))
    seconds, Z = timed(work)
    return Answer(rival, f"{cells} cells a side", off(Z), seconds)


def _of_data_sets(scene: Scene, press: Press, cells: int, off: Off) -> Answer:
    finer, pressed = laid(scene, press, cells)
    numbers, rises = touched_cells(finer, pressed)

    def anywhere(random: np.random.Generator) -> Case:
        x, y = random.uniform(0.02, 0.1, 2)
        width, height = random.uniform(0.012, 0.024, 2)
        touch = parse_press(f"rect({x},{y},{width},{height})", random.uniform(1.5, 2.5))
        return Case(None, *touched_cells(finer, touch))

    skin = reduce(finer, REDUCED_RTOL, anywhere).skin(None)
    many = np.tile(numbers, BATCH), np.tile(rises, BATCH), np.arange(BATCH + 1) * len(numbers)
    seconds = best_time(lambda: skin.sweeps(*many)) / BATCH
    return Answer(ON_CELLS, f"{cells} cells a side", off(skin.sweeps(*many)[0, 0]), seconds)


TOUCHES = Question(
    title="Touches anywhere: a rectangle on sheet-5x5",
    error="Largest relative error of Rs and Cp",
    time="Time to 20 frequencies (ms)",
    ours=(FIRST, AGAIN, ON_CELLS),
    answers=answers,
    pick=(
        "Take cells for training data, where the meter's noise hides their error; "
        "take the solver for everything that is compared with a measurement."
    ),
)

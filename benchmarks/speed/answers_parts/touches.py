"""A rectangle anywhere on the 5x5 sheet: followed by the mesh, or laid on cells."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np
from rcskin.benchmarks.bench import Run, timed
from rcskin.benchmarks.rivals import ngspice_grid, scikit_fem_script
from rcskin.benchmarks.rivals.cells import Cells
from rcskin.benchmarks.rivals.scikit_fem_script import Elements
from rcskin.benchmarks.speed.answers_parts.question import Answer, Question
from rcskin.benchmarks.speed.answers_parts.solving import FIRST, Asked
from rcskin.simulator.models.reduced.cases import Case
from rcskin.simulator.models.reduced.greedy import reduce
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.press.rasterized import touched_cells
from rcskin.simulator.press.touch import Touch
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene

AGAIN, ON_CELLS = "rcskin, each further touch", "rcskin, data set on cells"
PRESS = "rect(0.0373,0.0611,0.021,0.017)"
OTHERS = tuple(
    f"rect({0.0813 - 0.0053 * k:.4f},{0.0327 + 0.0061 * k:.4f},0.018,0.023)" for k in range(9)
)
FACTOR, TRUE = 2.0, 1e-9
RTOLS = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
RIVALS = {
    "scikit-fem Q1": (5, 10, 20, 40, 80),
    "scikit-fem Q2": (5, 10, 20, 40),
    "ngspice": (10, 20, 40),
}
"""And along how many cells a side each: an element is a cell."""
OF_DATA_SETS = (5, 10, 20)
REDUCED_RTOL = 1e-4


def laid(scene: Scene, press: Press, cells: int) -> tuple[Scene, Press]:
    """The same on so many cells along each side as pixels, pressed by the area that it covers."""
    finer = scene.with_({"pixels.rows": cells, "pixels.columns": cells})
    numbers, rises = touched_cells(finer.parts.skin, press)
    each = zip(*divmod(numbers, cells), rises, strict=True)
    return finer, Press(tuple(Touch(int(i) + 1, int(j) + 1, 1 + float(r)) for i, j, r in each))


def answers(run: Run) -> Iterator[Answer]:
    """By this project, by elements of scikit-fem and by ngspice."""
    scene = load_scene("sheet-5x5")
    press, *others = (parse_press(text, FACTOR) for text in (PRESS, *OTHERS))
    asked = Asked(scene, press, tuple(others), Solver(scene.parts, TRUE).solve(press).Z[0])
    yield from asked.by_solver(run.sized(RTOLS, RTOLS[1:2]), AGAIN)
    for cells in run.sized(OF_DATA_SETS, OF_DATA_SETS[:1]):
        yield _of_data_sets(asked, cells)
    for rival, sizes in RIVALS.items():
        if rival != "ngspice" or run.has(rival):
            yield from (_of_rival(rival, asked, cells) for cells in run.sized(sizes, sizes[:1]))


def _of_rival(rival: str, asked: Asked, cells: int) -> Answer:
    given = *laid(asked.scene, asked.press, cells), asked.scene.frequencies
    if rival == "ngspice":
        ngspice_grid.ensure_ngspice()
        work = partial(ngspice_grid.impedance, *given, Cells(cells, cells))
    else:
        work = partial(scikit_fem_script.impedance, *given, Elements(int(rival[-1]), 1))
    seconds, Z = timed(work)
    return Answer(rival, f"{cells} cells a side", asked.off(Z), seconds)


def _of_data_sets(asked: Asked, cells: int) -> Answer:
    finer, pressed = laid(asked.scene, asked.press, cells)

    def anywhere(random: np.random.Generator) -> Case:
        x, y = random.uniform(0.02, 0.1, 2)
        width, height = random.uniform(0.012, 0.024, 2)
        touch = parse_press(f"rect({x},{y},{width},{height})", random.uniform(1.5, 2.5))
        return Case(None, *touched_cells(finer.parts.skin, touch))

    reduced = reduce(finer.parts, REDUCED_RTOL, anywhere)
    return asked.by_batch(
        ON_CELLS,
        f"{cells} cells a side",
        reduced,
        *touched_cells(finer.parts.skin, pressed),
    )


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

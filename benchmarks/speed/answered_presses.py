"""Presses answered: a rectangle anywhere, a pixel pressed to a depth, skins of other outlines.

A rectangle on the 5x5 sheet is followed by the mesh or laid on cells. Beside an applicator the
electrode skin counts. Outlines are a disc, and an L with a pixel pressed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.bench import Run, timed
from rcskin.benchmarks.rivals import finite_elements, ngspice_grid
from rcskin.benchmarks.rivals.bilinear import Cells
from rcskin.benchmarks.rivals.finite_elements import Elements, Places
from rcskin.benchmarks.speed.questions import FIRST, Answer, Asked, Question
from rcskin.benchmarks.speed.skins import FREQUENCY, SHEETS, SIDE, C, Case, answered, cases
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.models.reduced import cases as drawn
from rcskin.simulator.models.reduced.greedy import reduce
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.press.rasterized import touched_cells
from rcskin.simulator.press.touch import Touch
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene
from skfem import MeshTri

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


def of_touches(run: Run) -> Iterator[Answer]:
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
        work = partial(finite_elements.script, *given, Elements(int(rival[-1]), 1))
    seconds, Z = timed(work)
    return Answer(rival, f"{cells} cells a side", asked.off(Z), seconds)


def _of_data_sets(asked: Asked, cells: int) -> Answer:
    finer, pressed = laid(asked.scene, asked.press, cells)

    def anywhere(random: np.random.Generator) -> drawn.Case:
        x, y = random.uniform(0.02, 0.1, 2)
        width, height = random.uniform(0.012, 0.024, 2)
        touch = parse_press(f"rect({x},{y},{width},{height})", random.uniform(1.5, 2.5))
        return drawn.Case(None, *touched_cells(finer.parts.skin, touch))

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
    answers=of_touches,
    pick=(
        "Take cells for training data, where the meter's noise hides their error; "
        "take the solver for everything that is compared with a measurement."
    ),
)


NEXT_DEPTH, ON_REDUCED = "rcskin, each further depth", "rcskin, reduced model"
EVEN, GRID = "one factor for the whole pixel", "differences, then scikit-fem Q1"
DEPTH = "2,3:2e-3m"
OTHER_DEPTHS = tuple(f"2,3:{mm}e-3m" for mm in (1.5, 1.8, 0.9, 2.1, 1.2, 1.65, 0.75, 1.95, 1.35))
TRUE_DEPTH, EVEN_RTOL = 1e-6, 1e-5
RTOLS_OF_DEPTHS, OF_REDUCED = (1e-2, 1e-3, 1e-4, 1e-5), (1e-3, 1e-4)
CELLS = (2, 4, 8, 16)
"""Along the side of a pixel."""


def of_depths(run: Run) -> Iterator[Answer]:
    """By this project, by a grid of differences, and by a press that ends at its edges."""
    scene = load_scene("foam")
    press, *others = (parse_press(text, np.nan) for text in (DEPTH, *OTHER_DEPTHS))
    truth = Solver(scene.parts, run.sized(TRUE_DEPTH, 1e-4)).solve(press).Z[0]
    asked = Asked(scene, press, tuple(others), truth)
    yield from asked.by_solver(run.sized(RTOLS_OF_DEPTHS, RTOLS_OF_DEPTHS[:1]), NEXT_DEPTH)
    for rtol in run.sized(OF_REDUCED, ()):
        pressed = touched_cells(scene.parts.skin, press)
        yield asked.by_batch(ON_REDUCED, f"{rtol:g}", reduce(scene.parts, rtol), *pressed)
    even = Press((Touch(2, 3, scene.press.factor(scene.parts.skin)),))
    seconds, Z = timed(lambda: Solver(scene.parts, EVEN_RTOL).solve(even).Z[0])
    yield Answer(EVEN, f"{EVEN_RTOL:g}", asked.off(Z), seconds)
    for cells in run.sized(CELLS, CELLS[:1]):
        work = partial(finite_elements.pressed_to_a_depth, scene, (2, 3), scene.frequencies, cells)
        seconds, Z = timed(work)
        yield Answer(GRID, f"{cells} cells a pixel", asked.off(Z), seconds)


DEPTHS = Question(
    title="Presses by depth: 2 mm into foam",
    error="Largest relative error of Rs and Cp",
    time="Time to 20 frequencies (ms)",
    ours=(FIRST, NEXT_DEPTH, ON_REDUCED),
    answers=of_depths,
    pick=(
        "Take the reduced model for more than a few thousand presses of pixels, "
        "the solver for all others; a press is never one factor alone."
    ),
)


RTOLS_OF_OUTLINES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
HALVED = {1: (2, 3, 4, 5), 2: (2, 3, 4)}
"""How often all triangles are halved, for each order of a rival's elements."""
DISC, ELL = "a disc", "an L"


@dataclass(frozen=True)
class Rival:
    """A skin as a plain script has it: triangles halved so often, its fed edge, and c in F/m²."""

    mesh: Callable[[int], MeshTri]
    fed: Places
    c: Places


def _disc() -> Rival:
    """Ever more sides, of corners on the circle."""

    def mesh(times: int) -> MeshTri:
        return MeshTri.init_circle(times).scaled(SIDE / 2)

    return Rival(mesh, lambda x: np.ones(x.shape[1], bool), lambda x: np.full(x.shape[1:], C))


def _ell() -> Rival:
    """With the pixel of row 2 and column 2 of 5 x 5 pressed by a factor of two."""
    low, high = SIDE / 5, 2 * SIDE / 5

    def mesh(times: int) -> MeshTri:
        return MeshTri.init_lshaped().translated((1, 1)).scaled(SIDE / 2).refined(times)

    def c(x: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.where(((low < x) & (x < high)).all(axis=0), 2 * C, C)

    return Rival(mesh, lambda x: x[0] < 1e-9, c)


def of_outlines(run: Run) -> Iterator[Answer]:
    """By this project, and by triangles halved everywhere alike."""
    rtols = run.sized(RTOLS_OF_OUTLINES, RTOLS_OF_OUTLINES[:1])
    by_name = {case.name: case for case in cases(min(rtols))}
    for name, title, rival in (
        (DISC, "disc fed at its rim", _disc()),
        (ELL, "L, pixel pressed", _ell()),
    ):
        yield from _compared(name, by_name[title], rival, run, rtols)


def _compared(
    name: str, case: Case, rival: Rival, run: Run, rtols: tuple[float, ...]
) -> Iterator[Answer]:
    truth = case.truth()

    def off(Z: NDArray[np.complex128]) -> float:
        return float(relative_difference(Z, truth).max())

    for rtol in rtols:
        seconds, found = timed(partial(answered, case, rtol))
        yield Answer(f"rcskin, {name}", f"{rtol:g}", off(found[0]), seconds)
    for order, halved in HALVED.items():
        for times in run.sized(halved, halved[:1]):
            asked = rival.mesh(times), order, rival.fed, rival.c, SHEETS, FREQUENCY
            seconds, Z = timed(partial(finite_elements.on_triangles, *asked))
            way = f"scikit-fem P{order}, {name}"
            yield Answer(way, f"{asked[0].t.shape[1]} triangles", off(Z), seconds)


OUTLINES = Question(
    title="Outlines: a disc, and an L with a pixel pressed",
    error="Largest relative error of Rs and Cp",
    time="Time to 9 frequencies (ms)",
    ours=(f"rcskin, {DISC}", f"rcskin, {ELL}"),
    answers=of_outlines,
    pick=(
        "Take the solver: straight triangles of one size stall at round rims, "
        "at re-entrant corners and at edges of pixels that they do not follow."
    ),
)

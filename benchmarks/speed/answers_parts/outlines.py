"""Skins of other outlines than a rectangle: a disc, and an L with a pixel pressed."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.bench import Run, timed
from rcskin.benchmarks.rivals import scikit_fem_triangles
from rcskin.benchmarks.rivals.scikit_fem_triangles import Places
from rcskin.benchmarks.speed.answers_parts.question import Answer, Question
from rcskin.benchmarks.speed.skins_scenes import FREQUENCY, SHEETS, SIDE, C, Case, answered, cases
from rcskin.simulator.fem.error_estimate import relative_difference
from skfem import MeshTri

RTOLS = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
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


def answers(run: Run) -> Iterator[Answer]:
    """By this project, and by triangles halved everywhere alike."""
    rtols = run.sized(RTOLS, RTOLS[:1])
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
            seconds, Z = timed(partial(scikit_fem_triangles.impedance, *asked))
            way = f"scikit-fem P{order}, {name}"
            yield Answer(way, f"{asked[0].t.shape[1]} triangles", off(Z), seconds)


OUTLINES = Question(
    title="Outlines: a disc, and an L with a pixel pressed",
    error="Largest relative error of Rs and Cp",
    time="Time to 9 frequencies (ms)",
    ours=(f"rcskin, {DISC}", f"rcskin, {ELL}"),
    answers=answers,
    pick=(
        "Take the solver: straight triangles of one size stall at round rims, "
        "at re-entrant corners and at edges of pixels that they do not follow."
    ),
)

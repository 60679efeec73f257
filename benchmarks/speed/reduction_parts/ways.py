"""One sheet by five ways in one run: time of a sweep, error, and what has to be prepared."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from rcskin.benchmarks.bench import Run, best_time
from rcskin.benchmarks.rivals import ngspice_grid, scikit_fem_script
from rcskin.benchmarks.rivals.cells import Cells
from rcskin.benchmarks.rivals.scikit_fem_script import Elements
from rcskin.benchmarks.speed.reduction_parts.cases import (
    FACTORS,
    FREQUENCIES,
    RTOL,
    Impedance,
    Presses,
    Skin,
    microseconds,
    prepared,
    true_impedance,
    unreduced,
    worst,
)
from rcskin.simulator.models.reduced.cases import pixel_touches
from rcskin.simulator.models.reduced.greedy import MESH_DRAWS
from rcskin.simulator.models.reduced.reduced_model import Reduced
from rcskin.simulator.models.solver import Solver

PRESSES, FEW_PRESSES, SPICE_PRESSES = 30, 4, 1
TRAINED_BY, FEW_TRAINED_BY = 100, 4
SHIFTS = (40.0, 2.8e3, 200e3)
"""Hz: every press that is trained on at each of them."""
GREEDY_RTOL = 2e-4
"""Of the field: about the coarsest that keeps 1e-5 of Rs and Cp on presses it is not trained on."""
TURNS = {"real shifts": 2 * np.pi, "imaginary shifts": 2j * np.pi}
"""From frequencies to s in rad/s."""


@dataclass(frozen=True)
class Found:
    """Z in ohm of the first presses, shape (press, frequency), and times.

    preparation: s, of what serves all presses. sweep: µs. of_same: whether of the same matrices.
    """

    way: str
    setting: str
    preparation: float
    sweep: float
    Z: Impedance
    of_same: bool = False


def table(run: Run) -> pd.DataFrame:
    """One row for each way: the true error, and that against the matrices that were reduced."""
    reduced = prepared(Skin("sheet-5x5")).reduced
    presses = Presses.drawn(reduced.parts.scene, run.sized(PRESSES, FEW_PRESSES), seed=6)
    truth = true_impedance(presses)[:, 0]
    skin = reduced.skin(None)
    exact = np.stack([unreduced(skin, *press)[0] for press in presses])
    rows = []
    for found in _ways(reduced, presses, run):
        count = len(found.Z)
        rows.append(
            {
                "way": found.way,
                "setting": found.setting,
                "preparation (s)": found.preparation,
                "a sweep (µs)": found.sweep,
                "presses": count,
                "true error": worst(found.Z, truth[:count]),
                "of the same matrices": worst(found.Z, exact) if found.of_same else np.nan,
            }
        )
    return pd.DataFrame(rows)


def _ways(reduced: Reduced, presses: Presses, run: Run) -> Iterator[Found]:
    yield _reduced(reduced, presses)
    yield _full(presses)
    for order in (3, 4):
        way = partial(scikit_fem_script.impedance, elements=Elements(order, 1))
        yield _script(f"scikit-fem Q{order}", "1x1 a pixel", way, presses)
    if not run.quick:
        ngspice_grid.ensure_ngspice()
    if run.has("ngspice"):
        way = partial(ngspice_grid.impedance, cells=Cells(40, 40))
        yield _script("ngspice", "40x40", way, presses, SPICE_PRESSES)
    for setting in run.sized(list(TURNS), ["real shifts"]) if run.has("pymor") else ():
        yield _pymor(setting, reduced, presses, run.sized(TRAINED_BY, FEW_TRAINED_BY))


def _reduced(reduced: Reduced, presses: Presses) -> Found:
    skin = reduced.skin(None)
    return Found(
        "reduced model",
        f"{reduced.rtol:g}, {reduced.size} vectors",
        prepared(Skin("sheet-5x5")).seconds,
        microseconds(skin, reduced.parts.scene),
        presses.solved(skin)[:, 0],
        of_same=True,
    )


def _full(presses: Presses) -> Found:
    """The shipped solver: its preparation is a first press."""
    named = presses.named()
    start = time.perf_counter()
    solver = Solver(presses.scene.parts, RTOL)
    solver.solve(named[0])
    first = time.perf_counter() - start
    Z = np.stack([solver.solve(press).Z[0] for press in named])
    again = best_time(lambda: [solver.solve(press) for press in named], 3)
    return Found("full model", f"{RTOL:g}", first, 1e6 * again / len(named), Z)


def _script(
    name: str,
    setting: str,
    way: Callable[..., Impedance],
    presses: Presses,
    count: int | None = None,
) -> Found:
    """A way that starts anew with every press."""
    given = [(presses.scene, press, FREQUENCIES) for press in presses.named()[:count]]
    Z = np.stack([way(*each) for each in given])
    return Found(name, setting, 0.0, 1e6 * best_time(lambda: way(*given[0]), 2), Z)


def _pymor(setting: str, reduced: Reduced, presses: Presses, trained_by: int) -> Found:
    """pyMOR's basis of the same matrices, from the presses that our training begins with."""
    from rcskin.benchmarks.rivals import pymor_basis

    start = time.perf_counter()
    training = [(TURNS[setting] * f, c) for c in _training(reduced, trained_by) for f in SHIFTS]
    matrices = pymor_basis.Matrices.of_family(reduced.family)
    basis = pymor_basis.Basis(matrices, training, GREEDY_RTOL)
    preparation = time.perf_counter() - start
    maps = [reduced.skin(None).map_of(*press).ravel() for press in presses]
    Z = np.stack([basis.impedance(c, FREQUENCIES) for c in maps])
    again = best_time(lambda: [basis.impedance(c, FREQUENCIES) for c in maps], 3)
    told = f"{setting}, {basis.size} vectors"
    return Found("pyMOR", told, preparation, 1e6 * again / len(maps), Z, of_same=True)


def _training(reduced: Reduced, count: int) -> list[NDArray[np.float64]]:
    """c of each pixel over that at rest, of the presses that `reduction.reduce` draws first."""
    random, draw = (
        np.random.default_rng(0),
        pixel_touches(reduced.parts.skin, reduced.parts.plan, FACTORS),
    )
    cases = [draw(random) for _ in range(MESH_DRAWS + count)][MESH_DRAWS:]
    skin = reduced.skin(None)
    return [skin.map_of(case.cells, case.rises).ravel() for case in cases]

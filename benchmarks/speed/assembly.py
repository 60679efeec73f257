"""Filling M(c) for a new capacitance map: numba into a fixed pattern against scikit-fem.

The answer is checked first: both must agree to 1e-13 of the largest entry.

Run: python benchmarks/speed/assembly.py [--quick]
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from rcskin.benchmarks.bench import Run, best_time, launch
from rcskin.simulator.chart_style import COLOURS, chart
from rcskin.simulator.fem.assembly import (
    Pattern,
    element_pairs,
    fill_readable,
    groups,
    pattern_of_pairs,
    quadrilateral,
)
from rcskin.simulator.fem.kernels import fill
from rcskin.simulator.mesh.quadrilaterals import Resolution, pixel_mesh
from rcskin.simulator.scene.scene_files import load_scene
from skfem import BilinearForm
from skfem.assembly import Basis

CASES = [(1, 4), (1, 16), (2, 2), (2, 8), (3, 1), (3, 4), (4, 1), (4, 4)]
AGREEMENT = 1e-13


def measure(order: int, cells: int) -> dict[str, object]:
    """Times of one mesh, after the check that all ways give the same matrix."""
    scene = load_scene("sheet-5x5")
    pixels = pixel_mesh(scene.parts.skin, scene.contacts, Resolution(order, cells))
    mesh, (group,) = pixels.mesh, groups(pixels.cells, order)
    basis = Basis(mesh, quadrilateral(order), intorder=2 * order)
    c = np.random.default_rng(1).uniform(4e-9, 1e-8, mesh.nelements)
    at_points = np.repeat(c[:, None], basis.dx.shape[1], axis=1)
    mass = BilinearForm(lambda u, v, w: w["c"] * u * v)
    reference = group.mass.reshape(1, -1)
    weights = (group.mass_weights * c)[:, None]

    def pattern() -> tuple[Pattern, NDArray[np.int64]]:
        return pattern_of_pairs(*element_pairs(basis.element_dofs), basis.N)

    built, slots = pattern()

    def with_numba():
        values = np.zeros(len(built.indices))
        fill(values, slots, weights, reference)
        return built.matrix(values)

    def with_numpy():
        values = np.zeros(len(built.indices))
        fill_readable(values, slots, weights, reference)
        return built.matrix(values)

    def with_skfem():
        return mass.assemble(basis, c=at_points).tocsc()

    truth = with_skfem()
    for name, way in (("numba", with_numba), ("numpy", with_numpy)):
        error = abs(way() - truth).max() / abs(truth).max()
        if not error < AGREEMENT:
            raise AssertionError(f"Q{order}, {cells} cells: {name} is {error:.1e} off scikit-fem")
    once, numba, numpy, skfem = map(best_time, (pattern, with_numba, with_numpy, with_skfem))
    return {
        "element": f"Q{order}",
        "cells a pixel": f"{cells}x{cells}",
        "unknowns": basis.N,
        "scikit-fem (ms)": f"{1e3 * skfem:.2f}",
        "numpy twin (ms)": f"{1e3 * numpy:.3f}",
        "numba (ms)": f"{1e3 * numba:.3f}",
        "pattern, once (ms)": f"{1e3 * once:.2f}",
        "scikit-fem / numba": f"{skfem / numba:.0f}",
    }


def main(run: Run) -> None:
    """Measure, publish and draw."""
    cases = run.sized(CASES, CASES[::4])
    table = pd.DataFrame([measure(order, cells) for order, cells in cases])
    run.publish("assembly", "Time to assemble M(c) anew on the 5x5 sheet", table)
    with chart(run.results / "assembly.png", 6, 3.6) as figure:
        axes = figure.subplots()
        ways = ("scikit-fem (ms)", "numpy twin (ms)", "numba (ms)")
        places = np.arange(len(table))
        for index, way in enumerate(ways):
            label = way.removesuffix(" (ms)")
            times = table[way].astype(float)
            axes.bar(places + 0.27 * (index - 1), times, 0.25, color=COLOURS[index], label=label)
        labels = table["element"] + "\n" + table["cells a pixel"]
        axes.set_xticks(places, list(labels))
        axes.set_yscale("log")
        axes.yaxis.set_major_formatter("{x:g}")
        axes.set_axisbelow(True)
        axes.grid(False, axis="x")
        axes.set_ylabel("Time to a new M(c) (ms)")
        axes.legend()


if __name__ == "__main__":
    launch(main)

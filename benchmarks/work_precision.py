"""Error of Rs and Cp against the time of a 20-frequency sweep of the 5x5 sheet.

Element orders on uniform meshes, warm; set-up (mesh, pattern, K) and sweep are timed apart. The
reference is two orders tighter than anything charted, and checked against a second one.

Run: python benchmarks/work_precision.py
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from bench import RESULTS, best_time, publish
from numpy.typing import NDArray

from simulator.circuit import one_field
from simulator.mesh import Resolution
from simulator.plot import COLOURS, chart
from simulator.press import Press, Touch
from simulator.scene_file import load_scene
from simulator.sheet import Sheet
from simulator.sweeps import parallel_capacitance

SCENE = load_scene("sheet-5x5")
PRESS = Press((Touch(2, 3, 2.0),))
CELLS = {1: (1, 2, 4, 8, 16, 32), 2: (1, 2, 4, 8, 16), 3: (1, 2, 4, 8), 4: (1, 2, 4), 6: (1, 2)}
REFERENCES = (Resolution(10, 3), Resolution(12, 3))


def sheet(resolution: Resolution) -> Sheet:
    circuit = one_field(SCENE)
    assert circuit is not None
    return Sheet(SCENE, circuit, resolution)


def error(Z: NDArray, truth: NDArray) -> float:
    """Largest relative error over Rs and Cp and all frequencies."""
    Cp, true_Cp = (parallel_capacitance(z, SCENE.frequencies) for z in (Z, truth))
    return float(max(np.abs(Z.real / truth.real - 1).max(), np.abs(Cp / true_Cp - 1).max()))


def measure(order: int, cells: int, truth: NDArray) -> dict[str, object]:
    resolution = Resolution(order, cells)
    ready = sheet(resolution)
    off = error(ready.impedance(PRESS, SCENE.frequencies), truth)
    set_up = best_time(lambda: sheet(resolution), 3)
    sweep = best_time(lambda: ready.impedance(PRESS, SCENE.frequencies), 5)
    return {
        "element": f"Q{order}",
        "cells a pixel": f"{cells}x{cells}",
        "unknowns": ready.unknowns,
        "error": f"{off:.1e}",
        "sweep (ms)": f"{1e3 * sweep:.1f}",
        "set-up, once (ms)": f"{1e3 * set_up:.1f}",
    }


def main() -> None:
    truth, other = (sheet(r).impedance(PRESS, SCENE.frequencies) for r in REFERENCES)
    table = pd.DataFrame(
        [measure(order, cells, truth) for order, meshes in CELLS.items() for cells in meshes]
    )
    tightest = table["error"].astype(float).min()
    doubt = error(other, truth)
    if not doubt < tightest / 3:
        raise AssertionError(f"the reference is known to {doubt:.1e}, charted is {tightest:.1e}")
    publish(
        "work_precision",
        f"20 frequencies on the 5x5 sheet, pixel 2,3 pressed (reference known to {doubt:.0e})",
        table,
    )
    with chart(RESULTS / "work_precision.png", 6, 4) as figure:
        axes = figure.subplots()
        for colour, (element, rows) in zip(COLOURS, table.groupby("element"), strict=False):
            time, off = (rows[name].astype(float) for name in ("sweep (ms)", "error"))
            axes.loglog(time, off, marker="o", color=colour, label=element)
        axes.xaxis.set_major_formatter("{x:g}")
        axes.set_xlabel("Time of a 20-frequency sweep (ms)")
        axes.set_ylabel("Largest relative error of Rs and Cp")
        axes.legend(title="element")


if __name__ == "__main__":
    main()

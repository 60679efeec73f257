"""Reduced models of non-uniform skins: what they take to prepare, and what a press costs.

Each is held against the full system of its own mesh on random presses: what the reduction leaves
out must stay below its certificate, else the run ends.

Run: OMP_NUM_THREADS=1 python benchmarks/speed/skins_reduced.py [--quick]
"""

from __future__ import annotations

import time

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from rcskin.benchmarks.bench import Run, best_time, launch
from rcskin.benchmarks.speed.skins import SIDE, mapped, scene_of
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.models.reduced.cases import Case, pixel_touches
from rcskin.simulator.models.reduced.greedy import reduce
from rcskin.simulator.models.reduced.reduced_model import Reduced
from rcskin.simulator.models.reduced.reduced_skin import KRYLOV_SHARE
from rcskin.simulator.press.batch import PressBatch
from rcskin.simulator.scene.scene import Scene

FREQUENCIES = np.geomspace(1e3, 2e5, 20)


def _random(seed: int) -> dict[str, object]:
    return {"kind": "random", "deviation": 0.2, "correlation_length": 0.03, "seed": seed}


def scenes() -> dict[str, Scene]:
    """One of each kind, with the foils of its top and bottom sheet on one edge."""
    half, hole = SIDE / 2, {"circle": (0.03, 0.03, 0.012)}
    bent = [(0, 0), (SIDE, 0), (SIDE, half), (half, half), (half, SIDE), (0, SIDE)]
    corners = [(0.03, 0), (0.09, 0), (SIDE, half), (0.09, SIDE), (0.03, SIDE), (0, half)]
    uneven = mapped(_random(3))
    return {
        "hexagon": scene_of({"outline": {"points": corners}}, {}, {}, "outline.2"),
        "L with a round hole": scene_of(
            {"outline": {"points": bent, "holes": [hole]}}, {}, {}, "outline.6"
        ),
        "uneven sheet and foam": scene_of({}, {"map": _random(1)}, uneven, "left"),
        "draped over a sphere": scene_of(
            {"shape": {"kind": "sphere", "radius": 0.1}}, {}, {}, "left"
        ),
        "piezoresistive, stretched": scene_of(
            {"stretch": {"x": 1.2}, "width": SIDE / 4}, {"piezoresistance": 2.0}, {}, "left"
        ),
    }


def _resized(scene: Scene, pixels: int, frequencies: NDArray[np.float64]) -> Scene:
    narrow = scene.skin.width < scene.skin.length / 2
    return scene.with_(
        {
            "pixels.rows": 1 if narrow else pixels,
            "pixels.columns": pixels,
            "sweep": {"frequencies": frequencies.tolist()},
        }
    )


def _row(name: str, scene: Scene, rtol: float, presses: int) -> dict[str, object]:
    start = time.perf_counter()
    reduced = reduce(scene.parts, rtol)
    prepared = time.perf_counter() - start
    draw, random = pixel_touches(scene.parts.skin, scene.parts.plan), np.random.default_rng(1)
    cases = [draw(random) for _ in range(presses)]
    batch = PressBatch.of((case.cells, case.rises) for case in cases)
    skin = reduced.at(None)
    spent = best_time(lambda: skin.sweeps(batch)) / presses
    off, told = _checked(reduced, cases)
    rows, columns = scene.pixels.shape
    return {
        "skin": name,
        "pixels": f"{rows} x {columns}",
        "tolerance": f"{rtol:g}",
        "prepared in s": f"{prepared:.2g}",
        "vectors": reduced.size,
        "unknowns": reduced.family.space.inner,
        "a press, us": f"{1e6 * spent:.3g}",
        "left out": f"{off:.1e}",
        "certified": f"{told:.1e}",
        "by the mesh": f"{reduced.mesh_error:.1e}",
    }


def _checked(reduced: Reduced, cases: list[Case]) -> tuple[float, float]:
    """The most that is left out of Rs or Cp, and the largest certificate."""
    skin = reduced.at(None)
    rounding, worst = KRYLOV_SHARE * reduced.rtol, (0.0, 0.0)
    for case in cases:
        Z = skin.sweep(case.cells, case.rises)
        off = relative_difference(Z, skin.exact(case.cells, case.rises))
        told = skin.certificate(case.cells, case.rises)
        if (off > told + rounding).any():
            raise AssertionError(f"{case}: off by {off.max():.1e}, certified {told.max():.1e}")
        worst = max(worst[0], float(off.max())), max(worst[1], float(told.max()))
    return worst


def main(run: Run) -> None:
    """Measure, print, write the table."""
    rtol, pixels, presses = run.sized(1e-4, 1e-3), run.sized(6, 2), run.sized(100, 4)
    frequencies = run.sized(FREQUENCIES, FREQUENCIES[::9])
    every = scenes()
    names = run.sized(list(every), list(every)[2:4])
    rows = []
    for name in names:
        rows.append(_row(name, _resized(every[name], pixels, frequencies), rtol, presses))
        print(rows[-1], flush=True)
    run.publish(
        "skins_reduced",
        "Reduced models of non-uniform skins",
        pd.DataFrame(rows),
    )


if __name__ == "__main__":
    launch(main)

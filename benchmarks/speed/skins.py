"""Skins that vary or are of any outline: error against time, and what plain skins pay for them.

Answers are held against closed forms where there are any, and against triangles refined to a
hundredth of the error asked elsewhere; an answer off by more than was asked ends the run.

Run: OMP_NUM_THREADS=1 python benchmarks/speed/skins.py [--quick]
"""

from __future__ import annotations

import itertools
from functools import partial
from pathlib import Path

import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator
from rcskin.benchmarks.bench import Run, best_time, launch, publish, timed
from rcskin.benchmarks.speed.skins_scenes import Case, answered, cases
from rcskin.simulator.chart_style import COLOURS, LINE_STYLES, chart
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.models.heterogeneous.elements_model import circuit_of
from rcskin.simulator.models.heterogeneous.square_meshes import Squares
from rcskin.simulator.models.model import GivenPress
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.scene_files import load_scene

PREDICTION = (
    "Triangles of order 3 that are halved where the next order changes most gain h^6 of their own "
    "size, whatever corner there is: ten times less error for about twice the unknowns. A plain "
    "skin takes the path it took; to find out that it is plain must cost less than 5 % of a press."
)
RTOLS = (1e-2, 1e-3, 1e-4, 1e-5)


def measured(cases: list[Case], rtols: tuple[float, ...]) -> pd.DataFrame:
    """Error asked, told and true, and time in ms from the scene to the answer, after one that
    is not counted."""
    rows = []
    for case in cases:
        truth = case.truth()
        for rtol in rtols:
            answered(case, rtol)
            spent, (Z, told, model, unknowns) = timed(partial(answered, case, rtol))
            true = float(relative_difference(Z, truth).max())
            if true > rtol:
                raise AssertionError(f"{case.name}: asked {rtol:g}, off by {true:.1e}")
            rows.append(
                {
                    "skin": case.name,
                    "against": "closed form" if case.closed else "finer triangles",
                    "tolerance": f"{rtol:g}",
                    "estimate": f"{told:.1e}",
                    "true": f"{true:.1e}",
                    "ms": f"{1e3 * spent:.3g}",
                    "unknowns": unknowns,
                    "by": model,
                }
            )
    return pd.DataFrame(rows)


def plain_path() -> pd.DataFrame:
    """What a plain press costs: in all, to be found plain, and by the elements of varied skins."""
    scene, press, rtol = load_scene("sheet-5x5"), parse_press("2,3", 2.0), 1e-4
    solver = Solver(scene.parts, rtol)
    alone = best_time(lambda: solver.solve(press), 200)

    def found_plain() -> None:
        assert GivenPress(scene.parts.skin, press, rtol).uniform is not None

    def varied() -> None:
        mesh = Squares(
            scene.parts.skin,
            circuit_of(scene.parts.skin, scene.parts.setup),
            press,
            rtol,
        )
        assert mesh.finer(scene.frequencies).result(scene.frequencies, rtol).error.max() <= rtol

    times = {
        "a further press of sheet-5x5, 1e-4": alone,
        "of it: finding out that it is uniform": best_time(found_plain, 200),
        "the same press by the elements of varied skins": best_time(varied, 20),
    }
    return pd.DataFrame([{"what": k, "us": f"{1e6 * t:.3g}"} for k, t in times.items()])


def draw(path: Path, table: pd.DataFrame) -> None:
    """True error against time."""
    with chart(path, 8.0, 4.0) as figure:
        _drawn(figure, table)


def _drawn(figure: Figure, table: pd.DataFrame) -> None:
    """Without those that a formula answers."""
    axes = figure.subplots()
    solved = table[table["unknowns"] > 0].groupby("skin", sort=False)
    looks = itertools.cycle(zip(COLOURS, LINE_STYLES + LINE_STYLES[:1], "osD^vP", strict=True))
    for (name, rows), (colour, style, mark) in zip(solved, looks, strict=False):
        by_time = rows.assign(ms=rows["ms"].astype(float)).sort_values("ms")
        true = by_time["true"].astype(float)
        axes.loglog(by_time["ms"], true, mark, ls=style, color=colour, label=name)
    axes.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter("")
    axes.set_xlabel("Time from scene to nine frequencies (ms)")
    axes.set_ylabel("Largest relative error of Rs and Cp")
    figure.legend(loc="outside right upper")


def main(run: Run) -> None:
    """Measure, print, write the tables and the chart."""
    print(PREDICTION)
    rtols = run.sized(RTOLS, RTOLS[:1])
    table = measured(cases(min(rtols)), rtols)
    publish(run.results, "skins", "Non-uniform skins, outlines and stretched skins", table)
    title = "Cost of heterogeneous models for a uniform skin"
    publish(run.results, "skins_plain", title, plain_path())
    draw(run.results / "skins.png", table)


if __name__ == "__main__":
    launch(main)

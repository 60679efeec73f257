"""Skins that vary or are of any outline: error against time, and what plain skins pay for them.

Answers are held against closed forms where there are any, and against triangles refined to a
hundredth of the error asked elsewhere; an answer off by more than was asked ends the run.

Run: OMP_NUM_THREADS=1 python benchmarks/speed/skins.py [--quick]
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator
from numpy.typing import NDArray
from rcskin.benchmarks.bench import Run, best_time, launch, timed
from rcskin.simulator.chart_style import COLOURS, LINE_STYLES, chart
from rcskin.simulator.fem.error_estimate import relative_difference
from rcskin.simulator.models.heterogeneous.elements_model import circuit_of
from rcskin.simulator.models.heterogeneous.square_meshes import Squares
from rcskin.simulator.models.heterogeneous.triangle_meshes import Triangles
from rcskin.simulator.models.model import GivenPress
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.press import Press, parse_press
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene
from scipy.special import iv, ive, kv

SHEETS, C, SIDE = 1e5, 4.861e-9, 0.12
FREQUENCY = np.geomspace(1e2, 1e6, 9)
CLOSER = 100
"""How many times less than the error asked that of finer triangles is."""
Impedance = NDArray[np.complex128]


@dataclass(frozen=True)
class Case:
    """A scene, a press, and Z in ohm: in closed form, or by triangles of a much smaller error."""

    name: str
    scene: Scene
    press: Press
    truth: Callable[[], Impedance]
    closed: bool


def scene_of(skin: dict[str, object], top: dict[str, object], foam: dict[str, object], edge: str):
    sheet = {"sheet_resistance": SHEETS / 2}
    contacts = [{"name": name, "electrode": name, "edge": edge} for name in ("top", "bottom")]
    return Scene.model_validate(
        {
            "name": "skin",
            "skin": {
                "length": SIDE,
                "width": SIDE,
                "top": {**sheet, **top},
                "bottom": sheet,
                "foam": foam or {"capacitance_per_area": C},
                **skin,
            },
            "contact": contacts,
            "interface": [{"name": "meter", "high": ["top"], "low": ["bottom"]}],
            "pixels": {"rows": 5, "columns": 5},
            "sweep": {"frequencies": FREQUENCY.tolist()},
        }
    )


def _disc() -> Impedance:
    """physics of a disc fed at its rim: R / (2 pi k a) I0(ka) / I1(ka), k² = s c R."""
    ka = np.sqrt(2j * np.pi * FREQUENCY * C * SHEETS) * SIDE / 2
    return SHEETS / (2 * np.pi * ka) * ive(0, ka) / ive(1, ka)


def _annulus() -> Impedance:
    """Fed at its hole of a third of the radius, open at its rim."""
    k = np.sqrt(2j * np.pi * FREQUENCY * C * SHEETS)
    fed, rim = k * SIDE / 6, k * SIDE / 2
    near = iv(0, fed) * kv(1, rim) + kv(0, fed) * iv(1, rim)
    return SHEETS / (2 * np.pi * fed) * near / (iv(1, rim) * kv(1, fed) - iv(1, fed) * kv(1, rim))


def _stretched_strip() -> Impedance:
    """20 % along x, y as of rubber: R coth(q) / q of the longer, narrower, thinner line."""
    along, across = 1.2, 1.2**-0.5
    area = along * across
    R = SHEETS * area * along / across
    capacitance = C * SIDE**2 * area * area ** (0.3 / 0.7)
    q = np.sqrt(2j * np.pi * FREQUENCY * R * capacitance)
    return R / (q * np.tanh(q))


def _closely(scene: Scene, press: Press, rtol: float) -> Callable[[], Impedance]:
    """By triangles alone, refined until they tell no larger an error."""

    def truth() -> Impedance:
        finer = Triangles(
            scene.parts.skin, circuit_of(scene.parts.skin, scene.parts.setup), press, rtol
        )
        while True:
            rung = finer.finer(FREQUENCY).result(FREQUENCY, rtol)
            if rung.error.max() <= rtol:
                return rung.Z[0]

    return truth


def cases(rtol: float) -> list[Case]:
    """All of them, fit to judge answers of that error."""
    circle = {"circle": (SIDE / 2, SIDE / 2, SIDE / 2)}
    hole = {"circle": (SIDE / 2, SIDE / 2, SIDE / 6)}
    half = SIDE / 2
    bent = [(0, 0), (SIDE, 0), (SIDE, half), (half, half), (half, SIDE), (0, SIDE)]
    random = {"kind": "random", "deviation": 0.2, "correlation_length": 0.03, "seed": 1}
    directed = {"piezoresistance": 2.0, "anisotropy": {"ratio": 3.0, "angle": 0.5}}
    at_rest, pixel = Press(), parse_press("2,2", 2.0)
    polygon = parse_press("poly(0.03,0.03,0.08,0.04,0.05,0.09)", 2.0)
    strip = scene_of({"stretch": {"x": 1.2}}, {}, {}, "left")
    closed = [
        ("disc fed at its rim", scene_of({"outline": circle}, {}, {}, "outline"), _disc),
        (
            "annulus fed at its hole",
            scene_of({"outline": {**circle, "holes": [hole]}}, {}, {}, "hole1"),
            _annulus,
        ),
        ("rectangle stretched by 20 %", strip, _stretched_strip),
    ]
    varied = [
        ("L, pixel pressed", scene_of({"outline": {"points": bent}}, {}, {}, "outline.6"), pixel),
        ("random sheet and foam", scene_of({}, {"map": random}, mapped(random), "left"), pixel),
        ("directed, piezoresistive sheet", scene_of({}, directed, {}, "left"), pixel),
        ("flat sheet, triangle pressed", scene_of({}, {}, {}, "left"), polygon),
    ]
    return [
        *(Case(name, scene, at_rest, truth, True) for name, scene, truth in closed),
        *(
            Case(name, scene, press, _closely(scene, press, rtol / CLOSER), False)
            for name, scene, press in varied
        ),
    ]


def mapped(of_place: dict[str, object]) -> dict[str, object]:
    return {"capacitance_per_area": C, "map": of_place}


def answered(case: Case, rtol: float) -> tuple[Impedance, float, str, int]:
    """Z in ohm, the error told, what answered, and of how many unknowns."""
    answer = Solver(case.scene.parts, rtol).solve(case.press)
    told = max(float(error.max()) for error in answer.relative_errors)
    return answer.Z[0], told, answer.models[-1], max(answer.unknowns)


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
    rtols = run.sized(RTOLS, RTOLS[:1])
    table = measured(cases(min(rtols)), rtols)
    run.publish("skins", "Non-uniform skins, outlines and stretched skins", table)
    title = "Cost of heterogeneous models for a uniform skin"
    run.publish("skins_plain", title, plain_path())
    draw(run.results / "skins.png", table)


if __name__ == "__main__":
    launch(main)

"""How many pixels can a skin with 2, 4, 6 or 8 wires tell? The bound, whoever reads it.

Square sheets of 120 mm with pairs of foils on one to four edges, of a known skin: Bayes'
accuracy of one pressed pixel, against six sweeps at rest, by the pairs of each edge alone and by
every two wires; for sheets of some resistances and meters of some errors. One model is trained for
each number of pixels and of wires, and answers everything else. No number here is of a real skin.

Run: python benchmarks/localization/design.py [--quick] [--sides N,N] [--wires N,N] [--found FOLDER]
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
from joblib import Parallel, delayed
from matplotlib.axes import Axes
from rcskin.benchmarks.bench import FOUND_OPTION, PROCESSES_OPTION, Run, launch
from rcskin.simulator.bounds.bayes import Draws
from rcskin.simulator.bounds.likelihood import Likelihood
from rcskin.simulator.bounds.touch_readings import hypotheses
from rcskin.simulator.chart_style import COLOURS, chart
from rcskin.simulator.design.goals import PressedPixels
from rcskin.simulator.design.layout import Material
from rcskin.simulator.design.trained_skins import TrainedSkins
from rcskin.simulator.measure.experiment import own_presses
from rcskin.simulator.scene.contacts import Interface
from rcskin.simulator.scene.design_goals import Design
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene

BASE = "sheet-5x5-two-interfaces"
EDGES = ("left", "bottom", "right", "top")
PIXELS, WIRES = (3, 4, 6, 8, 12), (2, 4, 6, 8)
SHEETS, USUAL = (50e3, 100e3, 200e3, 400e3), 200e3
"""ohm/sq of both sheets."""
ERRORS = (1 / 3, 1.0, 3.0)
"""Of the meter, times 0.3 % and 0.15°."""
RESTS, SEED, DRAWS = 6, 1, 1000
EVEN = {"unevenness": 0.0, "sheet_mismatch": 1.0, "foam_spread": 0.0}
PAIRS, ALL = "pairs of edges", "every two wires"
ENOUGH = 90.0
PUBLISHED = (
    ("resistive, 6x6, trained in simulation, real", "82 % of touches, 78.5 % of two", "ICRA 2020"),
    ("hydrogel, EIT, real", "5.4 ± 2.2 mm", "arXiv 2503.13048"),
)
"""Lee et al. 2020, doi 10.1109/ICRA40945.2020.9196732; Chen et al. 2025: as their abstracts say,
which do not tell the number of electrodes."""


def skin(pixels: int, wires: int) -> Scene:
    """A sheet with pairs of foils on as many edges as there are wires for."""
    foils = [
        {"name": f"{sheet}-{edge}", "electrode": sheet, "edge": edge, "span": [0.005, 0.995]}
        for edge in EDGES[: wires // 2]
        for sheet in ("top", "bottom")
    ]
    pairs = [
        {"name": edge, "high": [f"top-{edge}"], "low": [f"bottom-{edge}"]}
        for edge in EDGES[: wires // 2]
    ]
    changes = {
        "contact": foils,
        "interface": pairs,
        "pixels": {"rows": pixels, "columns": pixels},
        "dataset.session": EVEN,
    }
    return load_scene(BASE).with_(changes)


def readings(scene: Scene, kind: str) -> tuple[Interface, ...]:
    """Those of the scene, or between every two of its foils."""
    if kind == PAIRS:
        return scene.interfaces
    foils = [contact.name for contact in scene.contacts]
    return tuple(
        Interface(name=f"{one} to {other}", high=(one,), low=(other,))
        for one, other in itertools.combinations(foils, 2)
    )


def erring(scene: Scene, error: float) -> Scene:
    """With a meter whose noise is so many times that of the scene."""
    readout = scene.readout
    noise = {
        "readout.magnitude_noise": error * readout.magnitude_noise,
        "readout.phase_noise": error * readout.phase_noise,
    }
    return scene.with_(noise)


def cases() -> Iterator[tuple[str, float, float]]:
    """Readings, sheets in ohm/sq, error of the meter."""
    for kind in (PAIRS, ALL):
        yield from ((kind, sheet, 1.0) for sheet in SHEETS)
    yield from ((ALL, USUAL, error) for error in ERRORS if error != 1)


def bounds(pixels: int, wires: int, draws: int) -> Iterator[dict[str, object]]:
    """A row for each case."""
    scene = skin(pixels, wires)
    own = float(scene.frequencies[0]), float(scene.frequencies[-1])
    asked = Design(sheet_resistance=(min(SHEETS), max(SHEETS)), sheet_ratio=1.0, casts=1)
    goal = PressedPixels(scene.parts, asked, draws, SEED)
    trained = TrainedSkins(scene.parts, asked, own, SEED, goal)
    among = hypotheses(scene.parts.skin, scene.parts.plan, "pixel")
    judge = Draws(among, own_presses(scene.parts.skin, scene.parts.plan.press), SEED, draws)
    meters = {error: erring(scene, error).parts.meter for error in ERRORS}
    for kind, sheet, error in cases():
        read = readings(scene, kind)
        on = trained.readout(None, Material(sheet, sheet), read)
        frequency = scene.frequencies
        known = Likelihood(
            on.parts.skin,
            partial(on.skin.sweeps, frequency=frequency),
            on.reading(frequency),
            meters[error],
            RESTS,
        )
        share, deviation = judge.score(known).accuracy
        yield {
            "pixels": pixels,
            "wires": wires,
            "read": kind,
            "readings": len(read),
            "kohm/sq": round(1e-3 * sheet),
            "meter's error (%)": round(0.3 * error, 2),
            "right at most (%)": round(100 * share, 1),
            "standard error": round(100 * deviation, 1),
        }


def kept(folder: Path | None, pixels: int, wires: int, draws: int) -> pd.DataFrame:
    """The rows of one skin; from the folder, if it has them already."""
    path = None if folder is None else folder / f"{pixels}x{pixels}-{wires}-{draws}.csv"
    if path is not None and path.exists():
        return pd.read_csv(path)
    found = pd.DataFrame(bounds(pixels, wires, draws))
    if path is not None:
        found.to_csv(path, index=False)
    return found


def most_pixels(table: pd.DataFrame) -> pd.DataFrame:
    """The most pixels along a side that are told well enough, of those that were looked at."""
    by = ["wires", "read", "readings", "kohm/sq", "meter's error (%)"]
    enough = table["right at most (%)"] >= ENOUGH
    told = table.assign(side=table["pixels"].where(enough, 0)).groupby(by, sort=False)["side"].max()
    wide = told.map(lambda side: f"{side}x{side}" if side else "-").rename(f"{ENOUGH:g} % of")
    return wide.reset_index()


def by_sides(table: pd.DataFrame) -> pd.DataFrame:
    """A row for each number of wires, a column for each number of pixels: %, by every two wires."""
    usual = table[(table["read"] == ALL) & (table["kohm/sq"] == round(1e-3 * USUAL))]
    usual = usual[usual["meter's error (%)"] == 0.3].sort_values(["wires", "pixels"])
    told = usual.assign(side=[f"{side}x{side} (%)" for side in usual["pixels"]])
    index = ["wires", "readings"]
    wide = told.pivot(index=index, columns="side", values="right at most (%)")
    return wide[told["side"].unique()].reset_index()


def draw(table: pd.DataFrame, path: Path) -> None:
    """The bound against pixels by wires, against sheets, and against the meter's error."""
    usual, exact = table["kohm/sq"] == round(1e-3 * USUAL), table["meter's error (%)"] == 0.3
    every = table["read"] == ALL
    with chart(path, 13, 4.6) as figure:
        first, second, third = figure.subplots(1, 3, sharey=True)
        for k, (wires, own) in enumerate(table[usual & exact].groupby("wires")):
            for kind, line in ((ALL, "o-"), (PAIRS, "o:")):
                part = own[own["read"] == kind]
                label = f"{wires} wires" if kind == ALL else None
                _plot(first, part["pixels"], part, line, COLOURS[k], label)
        first.plot([6], [82], "k*", ms=11)
        first.annotate("resistive, real\n(ICRA 2020)", (6, 82), (5.6, 70), ha="right", fontsize=7)
        first.set_xticks(np.unique(table["pixels"]))
        first.set_xlabel("pixels along a side (dotted: by the pairs of edges alone)")
        first.set_ylabel("pixels right at most (%)")
        first.set_title(f"sheets of {1e-3 * USUAL:g} kohm/sq", fontsize=9)
        for k, (wires, own) in enumerate(table[exact & every].groupby("wires")):
            middle = own[own["pixels"] == _middle(table)]
            _plot(second, middle["kohm/sq"], middle, "o-", COLOURS[k], None)
            erring = table[usual & every & (table["wires"] == wires)]
            middle = erring[erring["pixels"] == _middle(table)].sort_values("meter's error (%)")
            _plot(third, middle["meter's error (%)"], middle, "o-", COLOURS[k], None)
        for axes, name in ((second, "sheets (kohm/sq)"), (third, "error of the meter (%)")):
            axes.set_xscale("log")
            axes.set_xlabel(name)
            axes.set_title(f"{_middle(table)}x{_middle(table)} pixels, {ALL}", fontsize=9)
        second.set_xticks([1e-3 * sheet for sheet in SHEETS], [f"{1e-3 * s:g}" for s in SHEETS])
        third.set_xticks([0.3 * error for error in ERRORS], [f"{0.3 * e:.1f}" for e in ERRORS])
        for axes in (first, second, third):
            axes.minorticks_off()
            axes.axhline(ENOUGH, color="0.5", lw=0.8, ls="--")
        figure.legend(loc="outside upper right", ncols=len(WIRES))


def _middle(table: pd.DataFrame) -> int:
    sides = np.unique(table["pixels"])
    return 6 if 6 in sides else int(sides[-1])


def _plot(
    axes: Axes, x: pd.Series, part: pd.DataFrame, line: str, colour: str, label: str | None
) -> None:
    axes.plot(x, part["right at most (%)"], line, color=colour, label=label, ms=4)


def main(run: Run) -> None:
    """Compute, and publish."""
    draws, asked = run.sized(DRAWS, 50), run.asked
    sides, wires = asked.sides or run.sized(PIXELS, (2,)), asked.wires or run.sized(WIRES, (2,))
    work = (delayed(kept)(asked.found, *each, draws) for each in itertools.product(sides, wires))
    table = pd.concat(Parallel(n_jobs=asked.processes)(work), ignore_index=True)
    run.publish("design", "Upper bound on the accuracy of pixels, skin known", table)
    title = f"The most pixels found {ENOUGH:g} % of the time at most"
    run.publish("design_pixels", title, most_pixels(table))
    title = f"Upper bound on the accuracy of pixels, by pairs of wires; {1e-3 * USUAL:g} kohm/sq"
    run.publish("design_sides", title, by_sides(table))
    others = pd.DataFrame(PUBLISHED, columns=["skin", "reached", "published"])
    run.publish("design_published", "Published results, measured on real skins", others)
    draw(table, run.results / "design.png")


def _numbers(text: str) -> tuple[int, ...]:
    return tuple(map(int, text.split(",")))


if __name__ == "__main__":
    launch(
        main,
        PROCESSES_OPTION
        | FOUND_OPTION
        | {
            "--sides": {"type": _numbers, "help": "Pixels along a side, N,N,..."},
            "--wires": {"type": _numbers, "help": "2, 4, 6 or 8, N,N,..."},
        },
    )

"""Localizers trained on rcskin's model, tested on skins that it did not make.

A three-dimensional solve of foam, air, sheets and earth makes the twins, see
`benchmarks/accuracy/three_dimensions.py`. The low terminal of the meter is at earth's potential,
fingers have 0 to 10 pF, presses have edges, the foam creeps, a body is near. Sheets and foam are
non-uniform, presses miss and differ in strength, skins drift, all as in `twin.py`. The virtual
meter reads the twins over TCP. Localizers are trained on the model without earth, with the terms of
`[surroundings]`, or with these and wider distributions.

There are three tables: columns of the paper's sheet; pixels of the skin designed for 6x6 pixels;
positions of touches of 24 mm on the skin designed for them. The designs are those of
`twin_design.py`. None of this is a measurement.

With a kept folder, a run that was stopped goes on.

Run: python benchmarks/localization/foreign_twin.py [--only columns|pixels|positions] [--skins 5]
     [--found FOLDER] [--searches FOLDER] [--quick]
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from rcskin.benchmarks.accuracy.static_elements import Grid
from rcskin.benchmarks.bench import (
    FOUND_OPTION,
    SEARCHES_OPTION,
    SKINS_OPTION,
    Run,
    launch,
)
from rcskin.benchmarks.localization.designs import GOALS, searched
from rcskin.benchmarks.localization.foreign_twins import (
    ALL,
    ALL_FEATURES,
    EFFECTS,
    OWN,
    TERMS,
    WAS,
    WIDER,
    WITH_BODY,
    Effect,
    Experiment,
    Way,
)
from rcskin.benchmarks.localization.twins import (
    CHANGE,
    ONE,
    SINGLE,
    WHOLE,
    Trial,
    anywhere,
    believed,
    every_pixel,
)
from rcskin.simulator.chart_style import COLOURS, chart
from rcskin.simulator.scene.scene_files import load_scene

COLUMNS_GOAL = 0.97
PIXELS_GOAL = 0.83
"""Three points below the mean of own twins, see `results/twin_design.md`."""
POSITIONS_GOAL = 3.5
"""Median distance, mm."""
SIDE, FEW = 5, 2
"""Pixels along a side."""
SWEEPS, MORE_SWEEPS, FEW_SWEEPS = 6000, 12_000, 600
"""Numbers of training sweeps: for columns, for designed skins, and for a quick pass."""
COARSE = Grid(finest=0.5, order=2, far=5.0)
"""Three-dimensional solve of a quick pass."""
COLUMN_WAYS = (
    Way("as it was", WAS),
    Way("with terms", TERMS),
    Way("drawn wider", WIDER),
    Way("adapted", TERMS, touches=2),
    Way("by the curve", TERMS, quantities=WHOLE),
    Way("gaussian", TERMS, "gaussian", ALL_FEATURES),
    Way("gaussian, drawn wider", WIDER, "gaussian", ALL_FEATURES),
)
PIXEL_WAYS = (
    Way("gaussian, as it was", WAS, "gaussian", ALL_FEATURES),
    Way("gaussian, with terms", TERMS, "gaussian", ALL_FEATURES),
)
POSITION_WAYS = (
    Way("network, as it was", WAS, "network", WHOLE),
    Way("network, with terms", TERMS, "network", WHOLE),
    Way("kernel-ridge, as it was", WAS, "kernel-ridge", CHANGE),
    Way("kernel-ridge, with terms", TERMS, "kernel-ridge", CHANGE),
)


def columns(quick: bool, searches: Path) -> Experiment:
    """Columns of the paper's sheet by the paper's localizer; no skin is searched for."""
    side, order = (FEW, every_pixel(3)) if quick else (SIDE, every_pixel(1))
    scene = believed(ONE, side, SINGLE)
    trial = Trial("column", scene, "column", order, ("ksvm-ovo",), COLUMNS_GOAL, training=SWEEPS)
    title = "Columns found on {skins} skins of a three-dimensional solve, % (answered)"
    cases = tuple((effect, COLUMN_WAYS) for effect in EFFECTS)
    found = Experiment("foreign_twin", title, trial, cases, SWEEPS)
    few = tuple((effect, COLUMN_WAYS[:2]) for effect in (OWN, WITH_BODY))
    return replace(found, cases=few, sweeps=FEW_SWEEPS, grid=COARSE) if quick else found


def pixels(quick: bool, searches: Path) -> Experiment:
    """Pixels of the designed skin with 6x6 of them."""
    trial = replace(_designed("pixel", quick, searches), goal=PIXELS_GOAL)
    title = "Pixels found on {skins} skins of a three-dimensional solve, as designed, % (answered)"
    found = Experiment("foreign_twin_pixels", title, trial, _cases(PIXEL_WAYS, ALL), MORE_SWEEPS)
    return _quick(found, PIXEL_WAYS) if quick else found


def positions(quick: bool, searches: Path) -> Experiment:
    """Positions of touches of 24 mm on the skin designed for them."""
    trial = replace(_designed("position", quick, searches), goal=POSITIONS_GOAL)
    title = (
        "Median distance of answers from touches on {skins} skins of a three-dimensional solve, "
        "as designed, mm (answered)"
    )
    cases = _cases(POSITION_WAYS, WITH_BODY)
    found = Experiment("foreign_twin_positions", title, trial, cases, MORE_SWEEPS)
    return _quick(found, POSITION_WAYS[2:]) if quick else found


EXPERIMENTS: dict[str, Callable[[bool, Path], Experiment]] = {
    "columns": columns,
    "pixels": pixels,
    "positions": positions,
}


def _designed(goal: str, quick: bool, searches: Path) -> Trial:
    """The trial of a goal on the skin that `rcskin design` finds; a quick pass searches none."""
    if quick:
        small = GOALS[goal].quick().trial
        return replace(small, order=anywhere(5) if small.placed else small.order)
    wanted = GOALS[goal]
    found = searched(wanted.trial.believed, wanted.asked, searches) / "design.toml"
    return replace(wanted.trial, believed=load_scene(found))


def _cases(ways: tuple[Way, ...], effect: Effect) -> tuple[tuple[Effect, tuple[Way, ...]], ...]:
    """Twins of the training model for localizers without surroundings, and an effect for all."""
    return (OWN, tuple(way for way in ways if way.training == WAS)), (effect, ways)


def _quick(experiment: Experiment, ways: tuple[Way, ...]) -> Experiment:
    """The same with few sweeps, on a coarse grid."""
    cases = _cases(ways, experiment.cases[-1][0])
    return replace(experiment, cases=cases, sweeps=FEW_SWEEPS, grid=COARSE)


NARROW = 0.8
"""Share of the height of an effect that its bars take."""


def write_report(experiment: Experiment, answers: pd.DataFrame, run: Run) -> None:
    """Write the table and the chart."""
    placed, skins = experiment.trial.placed, answers["skin"].nunique()
    found = summary(answers, placed)
    run.publish(experiment.table, experiment.title.format(skins=skins), table(found, placed))
    draw(found, experiment, run.results / f"{experiment.table}.png")


def summary(answers: pd.DataFrame, placed: bool) -> pd.DataFrame:
    """A row for each effect and way, over the skins.

    Shares in %: mean, and from one standard error below it to one above. placed: distances in mm:
    median, smallest and largest.
    """
    groups = answers.groupby(["effect", "way"], sort=False)
    scores = groups["score"]
    if placed:
        found = scores.agg(middle="median", low="min", high="max")
    else:
        middle, error = 100 * scores.mean(), 100 * scores.sem().fillna(0.0)
        found = pd.DataFrame({"middle": middle, "low": middle - error, "high": middle + error})
    return found.assign(answered=100 * groups["answered"].mean()).reset_index()


def table(found: pd.DataFrame, placed: bool) -> pd.DataFrame:
    """A row for each effect, a column for each localizer."""
    cells = [_cell(each, placed) for each in found.itertuples()]
    wide = found.assign(cell=cells).pivot(index="effect", columns="way", values="cell")
    ways, effects = found["way"].unique(), found["effect"].unique()
    return wide.loc[effects, ways].fillna("-").reset_index()


def draw(found: pd.DataFrame, experiment: Experiment, path: Path) -> None:
    """A group of bars for each effect; an infinite distance has no bar."""
    effects, ways = found["effect"].unique(), found["way"].unique()
    with chart(path, 8.5, 1.6 + 0.8 * len(effects)) as figure:
        axes, width = figure.subplots(), NARROW / len(ways)
        place, colours = np.arange(len(effects)), [*COLOURS, "0.5"]
        for k, way in enumerate(ways):
            own = found[found["way"] == way].set_index("effect").reindex(effects)
            own = own.replace(np.inf, np.nan)
            at = place + (k - (len(ways) - 1) / 2) * width
            errors = [own["middle"] - own["low"], own["high"] - own["middle"]]
            axes.barh(at, own["middle"], width, xerr=errors, color=colours[k], label=way)
        placed, goal = experiment.trial.placed, experiment.trial.goal
        axes.axvline(goal if placed else 100 * goal, color="0.3", linestyle="--", linewidth=1)
        axes.set_yticks(place, effects)
        axes.invert_yaxis()
        axes.set_xlabel(
            "median distance (mm), from the best skin to the worst\nno bar: half of the touches "
            "are unanswered; dashed: goal"
            if placed
            else "right answers (%); an unanswered touch is not right; dashed: goal"
        )
        figure.legend(loc="outside upper center", ncols=4, frameon=False)


def _cell(row: Any, placed: bool) -> str:
    if placed:
        return f"{row.middle:.2f} ({row.low:.2f} to {row.high:.2f}) ({row.answered:.0f})"
    return f"{row.middle:.1f} ± {row.high - row.middle:.1f} ({row.answered:.0f})"


SKINS = 5


def main(run: Run) -> None:
    """Make the tables and charts."""
    options = run.asked
    with run.kept(options.found) as folder:
        searches = options.searches or folder / "searches"
        skins = options.skins or run.sized(SKINS, 1)
        for name in [options.only] if options.only else EXPERIMENTS:
            experiment = EXPERIMENTS[name](run.quick, searches)
            answers = experiment.answers(folder / name, skins, options.processes)
            write_report(experiment, answers, run)


if __name__ == "__main__":
    launch(
        main,
        SKINS_OPTION
        | FOUND_OPTION
        | SEARCHES_OPTION
        | {
            "--only": {"choices": EXPERIMENTS, "help": "One of the three tables."},
            "--processes": {"type": int, "default": 1},
        },
    )

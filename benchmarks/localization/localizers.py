"""Localizers beside each other, on the same simulated sweeps: what each tells of skins never seen.

Every data set is of skins drawn at random, session by session, read by the meter with noise. The
last sessions are held back: nothing is trained, tuned or calibrated on them. No real skin is here.

Run: python benchmarks/localization/localizers.py [--quick] [FOLDER]    data sets are kept in FOLDER
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import pandas as pd
import xarray as xr
from rcskin.benchmarks.bench import Run, launch
from rcskin.localization.evaluation.evaluation import RIGHT_OF_ALL, ClassScore, score
from rcskin.localization.inputs.baselines import read_first
from rcskin.localization.inputs.samples import samples_of
from rcskin.localization.inversion.estimators import MODEL_BASED, chosen
from rcskin.localization.trust.fitting import learn_classes, learn_positions
from rcskin.simulator.chart_style import COLOURS, chart
from rcskin.simulator.dataset.dataset_plan import DatasetPlan
from rcskin.simulator.dataset.generation import generate
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import load_scene

AGAINST_REST = ("dlnZ", "dphase")
RTOL = 1e-3
"""Of the simulated sweeps; the meter's noise is three times that."""
HELD_BACK, REST_EVERY = 0.25, 10
FEW = {"scene": "sheet-5x5", "sweeps": 320, "session": 80}


@dataclass(frozen=True)
class Case:
    """What is asked of which sweeps. touches: chances of 0, 1, 2. session: sweeps in each."""

    title: str
    scene: str
    pixels: int
    touches: tuple[float, ...]
    target: str
    estimators: tuple[str, ...]
    sweeps: int
    place: str = "pixel"
    session: int = 200


CLASSIFIERS = ("ksvm-ovo", "ksvm-components", MODEL_BASED)
CASES = (
    Case("column, 5x5", "sheet-5x5", 5, (0.1, 0.9), "column", CLASSIFIERS, 4000),
    Case(
        "pixel, 6x6, two interfaces",
        "sheet-5x5-two-interfaces",
        6,
        (0.05, 0.95),
        "pixel",
        CLASSIFIERS,
        8000,
    ),
    Case(
        "touches, 4x4, two interfaces",
        "sheet-5x5-two-interfaces",
        4,
        (0.1, 0.3, 0.6),
        "touches",
        CLASSIFIERS,
        8000,
    ),
    Case(
        "pair, 4x4, two interfaces",
        "sheet-5x5-two-interfaces",
        4,
        (0.1, 0.3, 0.6),
        "pair",
        ("ksvm-components", MODEL_BASED),
        16_000,
    ),
    Case(
        "position of rectangles, two interfaces",
        "sheet-5x5-two-interfaces",
        4,
        (0.05, 0.95),
        "position",
        ("kernel-ridge",),
        4000,
        "anywhere",
    ),
)


def few_cases() -> tuple[Case, ...]:
    """A few labels, both of two touches, and places; by one interface and of few sweeps."""
    return tuple(replace(case, **FEW) for case in (CASES[0], *CASES[3:]))


def drawn_scene(case: Case) -> Scene:
    """The scene with the case's pixels and touches."""
    scene = load_scene(case.scene)
    drawn = scene.dataset
    press = drawn.press.model_copy(
        update={
            "touches": case.touches,
            "place": case.place,
            "shape": ("rectangle",),
            "cells_per_pixel": 2,
        }
    )
    session = drawn.session.model_copy(
        update={"sweeps_per_session": case.session, "rest_every": REST_EVERY}
    )
    return scene.model_copy(
        update={
            "pixels": scene.pixels.model_copy(update={"rows": case.pixels, "columns": case.pixels}),
            "dataset": drawn.model_copy(update={"press": press, "session": session}),
        }
    )


def sweeps_of(case: Case, cases: tuple[Case, ...], folder: Path) -> xr.Dataset:
    """The case's data set, made where it is not in the folder; cases may share one."""
    kind = f"{case.scene}-{case.pixels}-{len(case.touches)}-{case.place}"
    most = max(each.sweeps for each in cases if same_data(each, case))
    path = folder / f"{kind}-{most}.zarr"
    if not path.exists():
        generate(DatasetPlan(drawn_scene(case).parts, most, 1, RTOL), path, processes=1)
    return read_first(path, case.sweeps)


def same_data(one: Case, other: Case) -> bool:
    """Whether two cases ask of the same sweeps."""
    return (one.scene, one.pixels, one.touches, one.place) == (
        other.scene,
        other.pixels,
        other.touches,
        other.place,
    )


def judged(case: Case, sweeps: xr.Dataset, name: str, quantities: tuple[str, ...]) -> dict:
    """A row: the estimator trained on the first sessions and scored on the last."""
    samples = samples_of(sweeps, case.target, quantities)
    known = samples.sessions < (1 - HELD_BACK) * (samples.sessions.max() + 1)
    train, test = samples.part(known.nonzero()[0]), samples.part((~known).nonzero()[0])
    estimator = chosen(name, case.target)
    learn = learn_positions if case.target == "position" else learn_classes
    found = score(learn(train, estimator), test)
    row = {"case": case.title, "localizer": name, "features": ", ".join(quantities)}
    row |= {"trained on": min(len(train.X), estimator.max_sweeps), "tested on": len(test.X)}
    figures = found.figures()
    if isinstance(found, ClassScore):
        two = [str(label).count("+") > 0 for label in found.truth]
        told = f"{100 * figures[RIGHT_OF_ALL]:.1f} % right"
        if any(two):
            both = (found.right & found.answers.answered)[two]
            told += f", of two touches both {100 * both.mean():.1f} %"
        return row | {
            "found": told,
            "calibration": f"off by {100 * figures['calibration error']:.1f} %",
            "value": 100 * figures[RIGHT_OF_ALL],
        }
    return row | {
        "found": f"median {figures['median error, mm']:.1f} mm, "
        f"90 % within {figures['90 % error, mm']:.1f} mm",
        "calibration": f"{100 * figures['within 1 deviation']:.0f} % within one deviation",
        "value": figures["median error, mm"],
    }


def compared(case: Case, sweeps: xr.Dataset) -> list[dict]:
    """Every estimator against rest, and the reference on the paper's features."""
    rows = [judged(case, sweeps, name, AGAINST_REST) for name in case.estimators]
    if case.estimators[0] == "ksvm-ovo":
        rows.append(judged(case, sweeps, "ksvm-ovo", ("Rs", "Cp")))
    for row in rows:
        print(
            row["case"], "|", row["localizer"], "|", row["features"], "|", row["found"], flush=True
        )
    return rows


def draw(table: pd.DataFrame, path: Path) -> None:
    """A panel for each case: a bar for each localizer."""
    cases = list(dict.fromkeys(table["case"]))
    heights = [int((table["case"] == case).sum()) + 1 for case in cases]
    with chart(path, 9, 9) as figure:
        panels = figure.subplots(len(cases), 1, height_ratios=heights)
        for axes, case in zip(panels, cases, strict=True):
            of = table[table["case"] == case][::-1]
            paper = of["features"] == "Rs, Cp"
            names = of["localizer"] + paper.map({True: " (Rs, Cp)", False: ""})
            bars = axes.barh(names, of["value"], color=[COLOURS[4 if k else 0] for k in paper])
            millimetres = case.startswith("position")
            axes.bar_label(bars, fmt="%.1f mm" if millimetres else "%.1f %%", padding=3)
            axes.set_xlim(0, 1.25 * of["value"].max() if millimetres else 110)
            axes.set_xlabel("Median error (mm)" if millimetres else "Found (%)")
            axes.set_title(case, loc="left")


def main(run: Run) -> None:
    """Compare, and publish."""
    cases = run.sized(CASES, few_cases())
    with run.kept(run.asked.data) as folder:
        given = [(case, sweeps_of(case, cases, folder)) for case in cases]
        table = pd.DataFrame([row for each in given for row in compared(*each)])
    run.publish(
        "localizers",
        "Localizers on simulated skins never seen in training",
        table.drop(columns="value"),
    )
    draw(table, run.results / "localizers.png")


if __name__ == "__main__":
    launch(main, {"data": {"nargs": "?", "type": Path, "metavar": "FOLDER"}})

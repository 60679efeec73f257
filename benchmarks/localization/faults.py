"""Faults in service: what does a localizer answer on a skin that has one, and is it noticed?

Skins are drawn with faults in a half of the sessions. One localizer of columns learns from sound
skins alone, another also from skins with faults. Both answer to the same further skins, of the
meter's noise. A column that is wrong is worse than no answer.

Run: python benchmarks/localization/faults.py [--quick]
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr
from rcskin.benchmarks.bench import Run, launch
from rcskin.localization.evaluation.result import evaluated
from rcskin.localization.model.localizer_model import Model
from rcskin.localization.model.training import train
from rcskin.localization.trust.diagnosis import NO_FAULT, faults_of
from rcskin.simulator.chart_style import COLOURS, chart
from rcskin.simulator.dataset.dataset_plan import DatasetPlan
from rcskin.simulator.dataset.memory_dataset import in_memory
from rcskin.simulator.measure.skin_faults import kind_of_fault
from rcskin.simulator.scene.scene_files import load_scene

SCENES, FEW_SCENES = ("strip-1x5", "sheet-5x5"), ("strip-1x3",)
ODDS = {"dead_foil": 0.1, "half_foil": 0.1, "stuck_spot": 0.1, "aged_gain": 0.1, "tear": 0.1}
TEARS = 2
"""Different tears: each has a reduced model of its own."""
SESSIONS, FEW_SESSIONS = 160, 60
TRAINED_SHARE = 0.75
SWEEPS, RTOL = 50, 1e-3
"""Sweeps of a session. Tolerance before the noise."""
SOUND = 0.9
"""Columns of sound skins that both localizers must find, or the table compares nothing."""
OUTCOMES = ("right", "no answer, fault named", "no answer", "wrong")


def drawn(name: str, odds: dict[str, float], run: Run) -> xr.Dataset:
    """Sessions of a built-in scene with faults by these odds."""
    session = {"sweeps_per_session": SWEEPS, "rest_every": 10}
    if odds:
        session["faults"] = {**odds, "tears": TEARS}
    changes = {f"dataset.session.{key}": value for key, value in session.items()}
    sessions = run.sized(SESSIONS, FEW_SESSIONS)
    return in_memory(DatasetPlan(load_scene(name).with_(changes).parts, sessions * SWEEPS, 1, RTOL))


def outcomes(model: Model, sweeps: xr.Dataset) -> pd.DataFrame:
    """Share of each outcome in %, a row for each kind of fault."""
    answers, samples = model.answers(sweeps), model.samples(sweeps)
    right = evaluated(model.learned, samples, answers).score.right
    named = model.faults(sweeps, answers)[samples.rows]
    answered = answers.answered[samples.rows]
    kinds = [kind_of_fault(text) or NO_FAULT for text in faults_of(sweeps)[samples.rows]]
    named_right = named == np.array(kinds)
    each = pd.DataFrame(
        {
            "fault": kinds,
            "sweeps": 1,
            "right": answered & right,
            "no answer, fault named": ~answered & named_right,
            "no answer": ~answered & ~named_right,
            "wrong": answered & ~right,
        }
    )
    table = each.groupby("fault").sum()
    table[[*OUTCOMES]] = (100 * table[[*OUTCOMES]].div(table["sweeps"], axis=0)).round(1)
    return table.reset_index()


def compared(name: str, run: Run) -> list[pd.DataFrame]:
    """Both localizers of a scene on the same skins."""
    sound, faulty = drawn(name, {}, run), drawn(name, ODDS, run)
    last = TRAINED_SHARE * run.sized(SESSIONS, FEW_SESSIONS)
    learned = {"sound skins": sound, "skins with faults": faulty}
    found = []
    for trained_with, sweeps in learned.items():
        model = train(sweeps.isel(sweep=sweeps.session.values < last), "column")
        table = outcomes(model, faulty.isel(sweep=faulty.session.values >= last))
        table.insert(0, "trained with", trained_with)
        table.insert(0, "skin", name)
        found.append(table)
        print(table.to_string(), flush=True)
    return found


def check(table: pd.DataFrame) -> None:
    """Raise unless both localizers find the columns of sound skins."""
    sound = table.loc[table["fault"] == NO_FAULT, "right"]
    assert (sound >= 100 * SOUND).all(), f"of sound skins only {sound.min()} % are found"


def draw(table: pd.DataFrame, path: Path) -> None:
    """A panel for each skin and training, a bar for each fault."""
    panels = list(table.groupby(["skin", "trained with"], sort=False))
    with chart(path, 8.0, 1.9 * (len(panels) + 1) // 2 + 0.8) as figure:
        axes = figure.subplots((len(panels) + 1) // 2, 2, sharex=True, sharey=True).ravel()
        for own, ((skin, trained_with), rows) in zip(axes, panels, strict=True):
            left = np.zeros(len(rows))
            colours = COLOURS[2], COLOURS[0], COLOURS[5], COLOURS[1]
            for outcome, colour in zip(OUTCOMES, colours, strict=True):
                own.barh(rows["fault"], rows[outcome], left=left, color=colour, label=outcome)
                left += rows[outcome].to_numpy()
            own.set_title(f"{skin}, trained with {trained_with}")
            own.set_xlim(0, 100)
            own.set_axisbelow(True)
        for own in axes[-2:]:
            own.set_xlabel("sweeps (%)")
        axes[0].invert_yaxis()
        handles, labels = axes[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(OUTCOMES))


def main(run: Run) -> None:
    """All skins."""
    tables = [each for name in run.sized(SCENES, FEW_SCENES) for each in compared(name, run)]
    table = pd.concat(tables, ignore_index=True)
    check(table)
    title = "Faults in service: columns of skins that have one, in % of the sweeps"
    run.publish("faults", title, table)
    draw(table, run.results / "faults.png")


if __name__ == "__main__":
    launch(main)

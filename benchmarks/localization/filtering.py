"""Touches over time: what a user feels of live localization, with and without the filter.

Twins are pressed by hands that come and go, and left at rest. They are read through the virtual
meter on TCP, at the times that a meter takes, by the session of `rcskin live`. Whole sweeps are
recorded once, and every way to answer them is asked the same ones; sweeps by `--adaptive`, which
choose their frequencies, are read anew. None of this is a measurement of a skin.

Two questions are asked: for columns by one interface, and for pixels by two and a switch.

Run: python benchmarks/localization/filtering.py [--quick] [--skins N] [--touches N]
     [--rest SECONDS] [--only columns|pixels]
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd
from joblib import Parallel, delayed
from rcskin.benchmarks.bench import PROCESSES_OPTION, SKINS_OPTION, Run, launch
from rcskin.benchmarks.localization.twin_meters import Replay, Stage, Told, Touch, visits
from rcskin.benchmarks.localization.twins import (
    ONE,
    RTOL,
    SEED,
    SINGLE,
    TWO,
    Twin,
    believed,
    built,
    simulated,
)
from rcskin.hardware.live.live_baseline import LiveBaseline
from rcskin.hardware.live.live_localizer import LiveLocalizer
from rcskin.hardware.live.live_meter import LiveMeter
from rcskin.hardware.live.live_session import LiveSession
from rcskin.hardware.live.session_log import SessionLog
from rcskin.hardware.live.touch_answer import NOTHING_PRESSED
from rcskin.localization.filtering.adaptive import AdaptivePolicy
from rcskin.localization.filtering.follower import Follower
from rcskin.localization.model.localizer_model import Model
from rcskin.localization.model.training import train
from rcskin.simulator.dataset.skin_model import reduced
from rcskin.simulator.scene.scene import Scene

PIXELS, TRAINING = 5, 2000
SKINS, TOUCHES, REST = 2, 12, 120.0
"""Twins; touches of each; s at rest after them."""
OF_ADAPTED = (
    ("model-adapted", False, False),
    ("model-adapted", True, False),
    ("model-adapted", False, True),
    ("model-adapted", True, True),
)
"""Localizer, whether it filters, whether it chooses readings."""
WAYS = (*OF_ADAPTED[:2], ("ksvm-ovo", False, False), ("ksvm-ovo", True, False), *OF_ADAPTED[2:])


@dataclass(frozen=True)
class Question:
    """What is told of which skin, and the ways to answer. table: its name. title: of the table."""

    target: str
    base: str
    ways: tuple[tuple[str, bool, bool], ...]
    table: str
    title: str

    @property
    def scene(self) -> Scene:
        """What localizers believe."""
        return believed(self.base, PIXELS, SINGLE)

    def label(self, touch: Touch) -> str:
        """The right answer."""
        if self.target == "column":
            return f"column {touch.column}"
        return f"pixel {touch.row},{touch.column}"


QUESTIONS = {
    "columns": Question("column", ONE, WAYS, "filtering", "Touches over time, simulated skins"),
    "pixels": Question(
        "pixel",
        TWO,
        OF_ADAPTED,
        "filtering_two",
        "Touches over time: pixels by two interfaces and a switch, simulated skins",
    ),
}
WHOLE = ("dlnZ", "dphase", "lnZ0", "phase0")
LATE = 0.6
"""s after a release, within which an answer of the touch is not false."""
CERTAIN = 0.95


def localizer(model: Model, filters: bool, asks: bool) -> LiveLocalizer:
    """As `rcskin live` makes it."""
    certain = CERTAIN if asks else None
    follower = Follower(model, certain=certain) if filters else None
    asker = AdaptivePolicy(model, certain, follower) if asks else None
    return LiveLocalizer(model, model.known_scene.parts, follower, asker)


def session(way: LiveLocalizer, link: Any, stage: Any) -> LiveSession:
    """Of live localization, in the meter's own time."""
    return LiveSession(
        way, link, LiveBaseline(3), Told(stage), SessionLog(), clock=lambda: stage.now
    )


def answers(model: Model, filters: bool, asks: bool, stage: Stage, whole: Any) -> list:
    """(s, label) of every answer."""
    way = localizer(model, filters, asks)
    if not asks:
        link, sweeps = whole
        replay = Replay(link, sweeps)
        live = session(way, replay, replay)
        live.run(1)
        while replay.left:
            live.step()
        return live.display.answers
    ends = stage.touches[-1].ended + 2
    with stage.link(way) as link:
        live = session(way, link, stage)
        live.run(1)
        while stage.now < ends:
            live.step()
    return live.display.answers


def recorded(stage: Stage, model: Model, seconds: float) -> tuple[LiveMeter, list]:
    """Whole sweeps one after the other for so long: (begun, ended, sweep)."""
    found = []
    with stage.link(localizer(model, False, False)) as link:
        link.ready()
        while stage.now < seconds:
            begun = stage.now
            sweep = link.sweep(lambda frequency, reading: None)
            found.append((begun, stage.now, sweep))
    return link, found


def felt(
    told: list[tuple[float, str]], touches: list[Touch], ends: float, question: Question
) -> dict[str, Any]:
    """What a user feels: see the columns of the table. ends: s until which it is judged."""
    times, labels = np.array([t for t, _ in told]), np.array([label for _, label in told])
    waits, changes, wrong, held = [], 0, 0, 0
    free = times < ends
    for touch in touches:
        right = question.label(touch)
        during = (times >= touch.begun) & (times < touch.ended + LATE)
        free &= ~during
        first = np.flatnonzero(during & (labels == right))
        waits.append(times[first[0]] - touch.begun if first.size else np.nan)
        inside = labels[during & (times < touch.ended)]
        pressing = inside[(inside != "cannot tell") & (inside != NOTHING_PRESSED)]
        wrong, held = wrong + int((pressing != right).sum()), held + pressing.size
        if first.size:
            after = labels[first[0] :][times[first[0] :] < touch.ended]
            said = after[after != "cannot tell"]
            changes += int((said[1:] != said[:-1]).sum())
    resting = labels[free]
    pressed = (resting != NOTHING_PRESSED) & (resting != "cannot tell")
    begun = pressed & ~np.append(False, pressed[:-1])
    hours = (np.diff(times, prepend=0)[free]).sum() / 3600
    return {
        "false": int(begun.sum()),
        "hours": hours,
        "waits": waits,
        "changes": changes,
        "wrong": wrong,
        "held": held,
        "answers": len(told),
        "span": times[-1] - times[0],
    }


def of_skin(
    question: Question, number: int, models: dict[str, Model], family: Any, sizes: tuple
) -> list[dict]:
    """Rows of every way to answer one twin."""
    (touches, rest), scene = sizes, question.scene
    hands = visits(np.random.default_rng([SEED, number, 77]), PIXELS, touches)
    names = tuple(each.name for each in scene.interfaces)
    stage = Stage(Twin(built(scene), family, SEED, number), hands, names)
    ends = hands[-1].ended + rest
    whole = recorded(stage, models["model-adapted"], ends)
    rows = []
    for name, filters, asks in question.ways:
        stage = replace(stage, now=0.0)
        told = answers(models[name], filters, asks, stage, whole)
        until = told[-1][0] if asks else ends
        rows.append({"way": (name, filters, asks), **felt(told, hands, until, question)})
    return rows


def table(rows: list[dict]) -> pd.DataFrame:
    """A line for each way, of all twins together."""
    lines = []
    for way in dict.fromkeys(row["way"] for row in rows):
        some = [row for row in rows if row["way"] == way]
        added = ("false", "hours", "changes", "wrong", "held", "answers", "span")
        total = {key: sum(row[key] for row in some) for key in added}
        waits = np.concatenate([row["waits"] for row in some])
        name, filters, asks = way
        lines.append(
            {
                "localizer": name + (", --adaptive" if asks else ""),
                "--filter": "yes" if filters else "no",
                "s per answer": f"{total['span'] / total['answers']:.2f}",
                "false touches an hour": f"{total['false'] / total['hours']:.0f}"
                f" ({total['false']} in {60 * total['hours']:.0f} min)",
                "touches missed": f"{np.isnan(waits).sum()} of {waits.size}",
                "s to the right answer, median": f"{np.nanmedian(waits):.2f}",
                "s, 95 %": f"{np.nanquantile(waits, 0.95):.2f}",
                "changes a touch after it": f"{total['changes'] / waits.size:.2f}",
                "wrong while touched": f"{100 * total['wrong'] / max(1, total['held']):.1f} %",
            }
        )
    return pd.DataFrame(lines)


def main(run: Run) -> None:
    """Train, let hands come and go, and publish."""
    for name, question in QUESTIONS.items():
        if run.asked.only in (None, name):
            asked(run, question if not run.quick else replace(question, ways=question.ways[-2:]))


def asked(run: Run, question: Question) -> None:
    """One question, on all twins."""
    scene = question.scene
    family, plain = reduced(built(scene).parts, RTOL), reduced(scene.parts, RTOL)
    sweeps = simulated(scene, plain, run.sized(TRAINING, 400))
    models = {
        name: train(sweeps, question.target, name, quantities=WHOLE)
        for name in dict.fromkeys(name for name, *_ in question.ways)
    }
    sizes = run.sized((run.asked.touches, run.asked.rest), (2, 3.0))
    skins = run.asked.skins or run.sized(SKINS, 1)
    work = (delayed(of_skin)(question, k, models, family, sizes) for k in range(skins))
    rows = [row for found in Parallel(n_jobs=run.asked.processes)(work) for row in found]
    if not all(np.isfinite(row["waits"]).any() for row in rows):
        raise AssertionError("a way to answer finds no touch at all")
    run.publish(question.table, question.title, table(rows))


if __name__ == "__main__":
    launch(
        main,
        SKINS_OPTION
        | PROCESSES_OPTION
        | {
            "--touches": {"type": int, "default": TOUCHES},
            "--rest": {"type": float, "default": REST},
            "--only": {"choices": tuple(QUESTIONS)},
        },
    )

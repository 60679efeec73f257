"""Which pixel of 6x6 is pressed: share of wrong answers on skins never seen, and time for one."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
from rcskin.benchmarks.bench import Run, best_time
from rcskin.benchmarks.localization.localizers import AGAINST_REST, CASES, sweeps_of
from rcskin.benchmarks.speed.answers_parts.question import Answer, Question
from rcskin.localization.evaluation.evaluation import score
from rcskin.localization.inputs.samples import Samples, samples_of
from rcskin.localization.inversion.estimators import MODEL_BASED, chosen
from rcskin.localization.learners.networks import SHORT_STAGES
from rcskin.localization.trust.fitting import learn_classes

CASE = replace(CASES[1], sweeps=8000, session=100)
FEW = replace(CASE, sweeps=900)
"""Of the quick pass."""
SESSIONS, OF_PAPER = (10, 20, 60), (10, 60)
"""That localizers are trained on, and those of the paper's features."""
LEARNED = {
    "ksvm-ovo": "ksvm-ovo",
    "ksvm-components": "ksvm-components",
    "network, short course": "network",
}
"""Ways, and the localizers that they are."""
SET = {"network": {"stages": SHORT_STAGES}}
"""Parameters of localizers, as `--tune` finds them from 1940 sweeps on; others are as they are."""
HELD_BACK = 0.25
"""Of all sessions, the last."""
PAPER = "ksvm-ovo on Rs, Cp"
MODEL = f"{MODEL_BASED}, nothing learned"


def answers(run: Run) -> Iterator[Answer]:
    """Every localizer, trained on ever more sessions; what inverts the simulator, once."""
    case = run.sized(CASE, FEW)
    with tempfile.TemporaryDirectory() as folder:
        sweeps = sweeps_of(case, (case,), Path(folder))
        against_rest = samples_of(sweeps, case.target, AGAINST_REST)
        as_read = samples_of(sweeps, case.target, ("Rs", "Cp"))
    sessions = run.sized(SESSIONS, (5,))
    for way, name in LEARNED.items():
        yield from (_answered(way, name, against_rest, count) for count in sessions)
    for count in run.sized(OF_PAPER, (5,)):
        yield _answered(PAPER, "ksvm-ovo", as_read, count)
    yield _answered(MODEL, MODEL_BASED, against_rest, sessions[0])


def _answered(way: str, name: str, samples: Samples, sessions: int) -> Answer:
    held_back = samples.sessions >= (1 - HELD_BACK) * (samples.sessions.max() + 1)
    train = samples.part(np.flatnonzero(samples.sessions < sessions))
    test = samples.part(np.flatnonzero(held_back))
    estimator = chosen(name, "pixel")
    learned = learn_classes(
        train, replace(estimator, fit=partial(estimator.fit, **SET.get(name, {})))
    )
    wrong = 1 - float(score(learned, test).right.mean())
    one = test.part(np.array([0]))
    seconds = best_time(lambda: score(learned, one))
    return Answer(way, f"{len(train.X)} sweeps", wrong, seconds)


LOCALIZERS = Question(
    title="Localizers: pixel of 6x6, two interfaces, trained on more sweeps",
    error="Share of wrong answers",
    time="Time to one answer (ms)",
    ours=(MODEL,),
    answers=answers,
    pick=(
        "Take model-based where the scene is known: it finds most, in a millisecond; "
        "ksvm-components where there is nothing but sweeps."
    ),
    wrong=0.7,
    stalls=False,
)

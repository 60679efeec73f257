"""What no localizer can exceed, the best share of pixels found: how far off each way is."""

from __future__ import annotations

import time
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.bench import Run
from rcskin.benchmarks.speed.questions import Answer, Question
from rcskin.simulator.bounds.bayes import bayes
from rcskin.simulator.bounds.touch_readings import TouchReadings, hypotheses
from rcskin.simulator.limits.touch_identity import upper_bound
from rcskin.simulator.measure.experiment import own_presses
from rcskin.simulator.models.solver import Solver
from rcskin.simulator.press.batch import PressBatch
from rcskin.simulator.press.press import Press
from rcskin.simulator.press.touch import Touch
from rcskin.simulator.scene.scene_files import load_scene
from sklearn.neighbors import KNeighborsClassifier
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.svm import SVC

OURS, AGAIN = "rcskin", "rcskin, trained before"
FULL, PAIRS = "the same draws by the full solver", "bound by pairs"
CLASSIFIERS = {
    "accuracy of a kernel SVM": lambda: make_pipeline(StandardScaler(), SVC(C=100.0)),
    "accuracy of nearest neighbours": lambda: KNeighborsClassifier(5),
}
TARGET = "pixel"
DRAWS, OF_FULL = (250, 1000, 4000, 16000), (250,)
SWEEPS = (500, 2000, 8000)
"""That a classifier is trained on; as many judge it."""
TRUE_DRAWS, REPEATED = 200_000, 4


def of_limits(run: Run) -> Iterator[Answer]:
    """Root mean square of what is off over some seeds; a classifier's share right as a bound."""
    scene = load_scene("sheet-5x5")
    presses, among = (
        own_presses(scene.parts.skin, scene.press),
        hypotheses(scene.parts.skin, scene.parts.plan, TARGET),
    )
    known = TouchReadings(scene.parts, presses)
    truth = bayes(known, among, presses, 99, run.sized(TRUE_DRAWS, 1000)).share
    for draws in run.sized(DRAWS, DRAWS[:1]):
        start = time.perf_counter()
        bayes(TouchReadings(scene.parts, presses), among, presses, 1, draws)
        whole, start = time.perf_counter() - start, time.perf_counter()
        found = [bayes(known, among, presses, seed, draws).share for seed in range(REPEATED)]
        again = (time.perf_counter() - start) / REPEATED
        yield Answer(OURS, f"{draws} draws", _rms(found, truth), whole)
        yield Answer(AGAIN, f"{draws} draws", _rms(found, truth), again)
    for draws in run.sized(OF_FULL, ()):
        start = time.perf_counter()
        found = bayes(_InFull(scene.parts, presses), among, presses, 1, draws).share
        yield Answer(FULL, f"{draws} draws", abs(found - truth), time.perf_counter() - start)
    start = time.perf_counter()
    bound = upper_bound(known, among, presses)
    yield Answer(PAIRS, "", abs(bound - truth), time.perf_counter() - start)
    for way, classifier in CLASSIFIERS.items():
        for sweeps in run.sized(SWEEPS, SWEEPS[:1]):
            start = time.perf_counter()
            right = _judged(classifier(), known, sweeps)
            yield Answer(way, f"{sweeps} sweeps", abs(right - truth), time.perf_counter() - start)


def _rms(found: list[float], truth: float) -> float:
    return float(np.sqrt(np.mean(np.square(np.array(found) - truth))))


def _judged(classifier, known: TouchReadings, sweeps: int) -> float:
    """Trained on drawn sweeps of the known skin, and judged on as many others."""
    skin, plan, random = known.parts.skin, known.parts.plan, np.random.default_rng(1)
    among = [each.pixels for each in hypotheses(skin, plan, TARGET)]
    which = random.integers(0, len(among), 2 * sweeps)
    cells = [np.array([i * skin.pixels.columns + j for i, j in own], dtype=int) for own in among]
    starts = np.cumsum([0, *(len(cells[k]) for k in which)])
    rises = own_presses(skin, plan.press).at(random.random(starts[-1])) - 1
    clean = known.whitened(PressBatch(np.concatenate([cells[k] for k in which]), rises, starts))
    read = clean + random.standard_normal(clean.shape)
    classifier.fit(read[:sweeps], which[:sweeps])
    return float(classifier.score(read[sweeps:], which[sweeps:]))


class _InFull(TouchReadings):
    """Readings without a reduced model: one solve for each press."""

    def train(self, progress=None) -> None:
        """Nothing to train."""

    def _solved(self, batch: PressBatch) -> NDArray[np.complex128]:
        columns, solver = self.parts.skin.pixels.columns, Solver(self.parts, 1e-4)
        Z = []
        for cells, rises in batch.each():
            each = zip(*divmod(cells, columns), rises, strict=True)
            touches = tuple(Touch(int(i) + 1, int(j) + 1, 1 + float(r)) for i, j, r in each)
            Z.append(solver.solve(Press(touches)).Z)
        return np.stack(Z)


LIMITS = Question(
    title="Limits: bound on the accuracy of 25 pixels",
    error="Error of the share",
    time="Time to the share (ms)",
    ours=(OURS, AGAIN),
    answers=of_limits,
    pick=(
        "Take Bayes' decision over a reduced model; a classifier stays below the limit "
        "however much it is trained, and a bound by pairs above it."
    ),
)

"""What the twin experiment could reach at most: the best answers to sweeps of skins that are known.

The hand is that of the twins, its offsets and strengths summed over; the skin is the scene's own,
known exactly, and read against the mean of as many sweeps at rest as a localizer takes. Twins are
unknown, uneven, and drift besides, so that this bounds every localizer from above.

Where a touch is, is told of twins that are drawn (see twin_places).

Run: python benchmarks/localization/twin_limits.py [--quick] [--only answers|places]
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np
import pandas as pd
from joblib import Parallel, delayed
from rcskin.benchmarks.bench import Run, launch
from rcskin.benchmarks.localization.twin_meters import read_at_once
from rcskin.benchmarks.localization.twins import TRIALS, WHOLE, Trial, Twin, built, few_trials
from rcskin.localization.inputs.baselines import RECENT
from rcskin.localization.inputs.samples import samples_of
from rcskin.localization.inversion.adapted import AdaptedPosition
from rcskin.localization.inversion.classifier import InversionPlan, simulated
from rcskin.simulator.bounds.touch_readings import hypotheses
from rcskin.simulator.dataset.skin_model import reduced
from rcskin.simulator.limits.random_press_limits import RandomPresses, accuracy_of_presses
from rcskin.simulator.models.reduced.reduced_model import Reduced
from rcskin.simulator.scene.randomisation import Normal
from rcskin.simulator.scene.scene import Scene
from rcskin.simulator.scene.scene_files import scene_text

SEED, RTOL = 777, 1e-3
DRIFT = 6e-4
"""Of foam and sheets since the latest sweeps at rest."""


def place_limits(trial: Trial, skins: int, processes: int = 2) -> list[dict[str, object]]:
    """A row, over all touches of all skins."""
    family = reduced(built(trial.believed).parts, RTOL)
    work = (delayed(_of_skin)(trial, family, number) for number in range(skins))
    found = pd.concat(Parallel(n_jobs=processes)(work))
    share, off = found["share"], found["off"]
    return [
        {
            "trial": trial.name,
            "touches": len(found),
            f"within {trial.goal:g} mm at most (%)": round(100 * share.mean(), 1),
            "standard error": round(100 * share.std() / math.sqrt(len(found)), 1),
            "of the answers (%)": round(100 * (off < trial.goal).mean(), 1),
            "median of the answers (mm)": round(off.median(), 2),
        }
    ]


def _of_skin(trial: Trial, family: Reduced, number: int) -> pd.DataFrame:
    twin = Twin(built(trial.believed), family, SEED, number, trial.hand)
    sweeps = read_at_once(twin, trial.recording(np.random.default_rng([SEED, number])))
    samples = samples_of(sweeps, "position", WHOLE)
    X, truth = samples.X, samples.y
    plan = InversionPlan(
        scene_text(_with_the_hand_of(trial)),
        "position",
        rest_sweeps=RECENT,
        builder=partial(simulated, drift=DRIFT),
    )
    localizer = AdaptedPosition.fitted(plan)
    off = np.hypot(*(localizer.predict(X) - truth)[:, :2].T)
    return pd.DataFrame({"share": localizer.share_within(X, trial.goal), "off": off})


def _with_the_hand_of(trial: Trial) -> Scene:
    """The localizer's scene, told how strongly the twins' hand presses."""
    drawn = trial.believed.dataset
    press = drawn.press.model_copy(
        update={"factor": Normal(mean=2.0, deviation=trial.hand.strength)}
    )
    return trial.believed.model_copy(update={"dataset": drawn.model_copy(update={"press": press})})


SAMPLES, FEW_SAMPLES = (1000, 4000), (50, 100)
"""Presses of each hypothesis that are summed over: how they close in on the limit."""
DRAWS, FEW_DRAWS = 2000, 100
SKINS = 20


def limits(trial: Trial, counts: tuple[int, ...], draws: int) -> list[dict[str, object]]:
    """The limit of a trial's question: pixels hit whole, then by more and more samples."""
    presses = Normal(mean=2.0, deviation=trial.hand.strength)
    whole = RandomPresses.of_pixels(trial.believed.parts, presses, against_rest=RECENT)
    beside = whole.with_offset(trial.hand.offset)
    return [
        _accuracy(trial, whole, 0.0, counts[-1], draws),
        *(_accuracy(trial, beside, trial.hand.offset, count, draws) for count in counts),
    ]


def _accuracy(
    trial: Trial, hand: RandomPresses, offset: float, samples: int, draws: int
) -> dict[str, object]:
    among = hypotheses(trial.believed.parts.skin, trial.believed.parts.plan, trial.target)
    found = accuracy_of_presses(hand, among, draws=draws, samples=samples)
    least, most, error = (100 * value for value in found)
    return _row(trial, offset, samples, least, most, error, "% right")


def _row(
    trial: Trial, offset: float, samples: int, least: float, most: float, error: float, unit: str
) -> dict[str, object]:
    return {
        "trial": trial.name,
        "offset of the hand": offset,
        "samples": samples,
        "from": round(least, 2),
        "to": round(most, 2),
        "standard error": round(error, 2),
        "unit": unit,
    }


def main(run: Run) -> None:
    """Compute, and publish."""
    trials = run.sized(TRIALS, few_trials())
    placed = [trial for trial in trials if trial.placed]
    labelled = {trial.name: trial for trial in trials if not trial.placed}.values()
    if run.asked.only != "places":
        sizes = run.sized((SAMPLES, DRAWS), (FEW_SAMPLES, FEW_DRAWS))
        rows = [row for trial in labelled for row in limits(trial, *sizes)]
        run.publish("twin_limits", "Upper bounds, skin known", rows)
    if run.asked.only != "answers":
        skins = run.sized(SKINS, 1)
        rows = [row for trial in placed for row in place_limits(trial, skins)]
        title = "Upper bound on the fraction of answers within the goal of a touch"
        run.publish("twin_places", title, rows)


if __name__ == "__main__":
    launch(main, {"--only": {"choices": ("answers", "places")}})

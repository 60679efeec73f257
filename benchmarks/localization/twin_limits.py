"""What the twin experiment could reach at most: the best answers to sweeps of skins that are known.

The hand is that of the twins, its offsets and strengths summed over; the skin is the scene's own,
known exactly, and read against the mean of as many sweeps at rest as a localizer takes. Twins are
unknown, uneven, and drift besides, so that this bounds every localizer from above.

Where a touch is, is told of twins that are drawn (see twin_places).

Run: python benchmarks/localization/twin_limits.py [--quick] [--only answers|places]
"""

from __future__ import annotations

import argparse

import pandas as pd
from rcskin.benchmarks.bench import Run, launch, publish
from rcskin.benchmarks.localization.twin_parts.places import place_limits
from rcskin.benchmarks.localization.twin_parts.trials import TRIALS, Trial, few_trials
from rcskin.localization.inputs.baselines import RECENT
from rcskin.simulator.bounds.touch_readings import hypotheses
from rcskin.simulator.limits.random_press_limits import RandomPresses, accuracy_of_presses
from rcskin.simulator.scene.randomisation import Normal

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
        publish(run.results, "twin_limits", "Upper bounds, skin known", pd.DataFrame(rows))
    if run.asked.only != "answers":
        skins = run.sized(SKINS, 1)
        rows = [row for trial in placed for row in place_limits(trial, skins)]
        title = "Upper bound on the fraction of answers within the goal of a touch"
        publish(run.results, "twin_places", title, pd.DataFrame(rows))


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--only", choices=("answers", "places"))
    launch(main, parser)

"""What the twin experiment could reach at most: the best answers to sweeps of skins that are known.

The hand is that of the twins, its offsets and strengths summed over; the skin is the scene's own,
known exactly, and read against the mean of as many sweeps at rest as a localizer takes. Twins are
unknown, uneven, and drift besides, so that this bounds every localizer from above.

Where a touch is, is told of twins that are drawn (see twin_places).

Run: python benchmarks/twin_limits.py [--only places]
"""

from __future__ import annotations

import argparse

import pandas as pd
from bench import publish
from twin_places import place_limits
from twin_trials import TRIALS, Trial

from localization.rest import NEAREST
from simulator.distribution import Normal
from simulator.limits import hand_accuracy

SAMPLES = (1000, 4000, 12_000)
"""Presses of each hypothesis that are summed over: how they close in on the limit."""


def limits(trial: Trial) -> list[dict[str, object]]:
    """The limit of a trial's question, by more and more samples."""
    whole = _accuracy(trial, 0.0, SAMPLES[-1])
    return [whole, *(_accuracy(trial, trial.hand.offset, samples) for samples in SAMPLES)]


def _accuracy(trial: Trial, offset: float, samples: int) -> dict[str, object]:
    presses = Normal(mean=2.0, deviation=trial.hand.strength)
    found = hand_accuracy(
        trial.believed,
        trial.target,
        presses,
        offset=offset,
        samples=samples,
        draws=2000,
        against_rest=NEAREST,
    )
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


def main() -> None:
    """Compute, and publish."""
    parser = argparse.ArgumentParser(description="Limits of the twin experiment.")
    parser.add_argument("--only", choices=("answers", "places"))
    asked = parser.parse_args()
    if asked.only != "places":
        rows = [row for trial in TRIALS if not trial.placed for row in limits(trial)]
        publish("twin_limits", "At most, on a skin that is known", pd.DataFrame(rows))
    if asked.only != "answers":
        rows = [row for trial in TRIALS if trial.placed for row in place_limits(trial)]
        publish("twin_places", "At most, within the goal of a touch", pd.DataFrame(rows))


if __name__ == "__main__":
    main()

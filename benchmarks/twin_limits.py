"""What the twin experiment could reach at most: the best answers to sweeps of skins that are known.

The hand is that of the twins, its offsets and strengths summed over; the skin is the scene's own,
known exactly, and read against the mean of as many sweeps at rest as a localizer takes. Twins are
unknown, uneven, and drift besides, so that this bounds every localizer from above.

Run: python benchmarks/twin_limits.py
"""

from __future__ import annotations

import pandas as pd
from bench import publish
from twin_scenes import PLACED_SIZE
from twin_trials import TRIALS, Trial

from localization.rest import NEAREST
from simulator.distribution import Normal
from simulator.limits import hand_accuracy, hand_distance

SAMPLES, PLACED_SAMPLES = (1000, 4000, 12_000), (10_000, 40_000)
"""Presses that are summed over, of each hypothesis and anywhere: how they close in on the limit."""


def limits(trial: Trial) -> list[dict[str, object]]:
    """The limit of a trial's question, by more and more samples."""
    if trial.placed:
        return [_distance(trial, samples) for samples in PLACED_SAMPLES]
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


def _distance(trial: Trial, samples: int) -> dict[str, object]:
    presses = Normal(mean=2.0, deviation=trial.hand.strength)
    found, error = hand_distance(
        trial.believed, presses, size=PLACED_SIZE.value, samples=samples, against_rest=NEAREST
    )
    return _row(trial, 0.0, samples, 1e3 * found, 1e3 * found, 1e3 * error, "mm, median")


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
    rows = [row for trial in TRIALS for row in limits(trial)]
    publish("twin_limits", "At most, on a skin that is known", pd.DataFrame(rows))


if __name__ == "__main__":
    main()

"""What whoever knows a skin could tell of it at most, under the hand of the twins."""

from __future__ import annotations

from rcskin.benchmarks.localization.design_parts.asking import still
from rcskin.benchmarks.localization.design_parts.goals import Goal
from rcskin.benchmarks.localization.design_parts.kept import Kept
from rcskin.benchmarks.localization.twin_parts.known import known_accuracy, known_distance
from rcskin.benchmarks.localization.twin_parts.scenes import PLACED_SIZE
from rcskin.benchmarks.localization.twin_parts.trials import Trial
from rcskin.localization.inputs.baselines import RECENT
from rcskin.simulator.design.goals import TouchPositions
from rcskin.simulator.limits import off_centre_accuracy, posterior_distance
from rcskin.simulator.models.reduced.reduced_model import Reduced


def whole(kept: Kept) -> dict[str, object]:
    """Of the skin as it was meant, as the search tells: pixels hit whole, or by Cramér and Rao."""
    merit, trial = kept.as_meant(), kept.goal.trial
    if trial.placed:
        guess = TouchPositions(trial.believed.parts).merit.guess
        told = {"skins": "a known skin, no bias", "median": f"{1e3 * guess * (1 - merit):.2f}"}
    else:
        told = {"skins": "a known skin, pixels hit whole", "mean": f"{100 * merit:.1f}"}
    return {"who": "bound"} | told


def nominal(kept: Kept, trial: Trial) -> dict[str, object]:
    """Of the skin as it was meant, against as many rests as localizers take."""
    draws, samples = kept.goal.bound
    asked = {"draws": draws, "samples": samples, "against_rest": RECENT}
    scene = trial.believed
    if trial.placed:
        size = PLACED_SIZE.value
        found = kept.once("bound", lambda: posterior_distance(scene.parts, size=size, **asked))
        middle, error = (1e3 * each for each in found)
        told = {"skins": "a known skin, any answers", "median": f"{middle:.2f} ± {error:.2f}"}
    else:
        offset, target = trial.hand.offset, trial.target
        asked["offset"] = offset
        least, most, error = kept.once(
            "bound", lambda: off_centre_accuracy(scene.parts, target, **asked)
        )
        mean = f"{50 * (least + most):.1f} ± {100 * error:.1f}"
        told = {"skins": "a known skin, the twins' hand", "mean": mean}
    return {"who": "bound"} | told


def of_twin(goal: Goal, trial: Trial, family: Reduced, number: int) -> float:
    """Of one twin, pressed by its hand, for whoever knows its skin and meets no drift."""
    assert goal.known is not None
    draws, samples = goal.known
    twin, asked = still(trial, family, number), {"draws": draws, "samples": samples}
    asked["against_rest"] = RECENT
    if trial.placed:
        size = PLACED_SIZE.value
        return known_distance(trial.believed, twin, size=size, **asked)
    bound = known_accuracy(trial.believed, twin, trial.target, **asked)
    return (bound.lower + bound.upper) / 2

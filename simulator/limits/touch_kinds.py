"""Limits for other kinds of touch, where a scene is pressed by fingers."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ..bounds.bayes import BayesAccuracy
from ..bounds.touch_readings import Hypothesis, by_rod, hypotheses, kinds, touched_alone
from ..scene.parts import Plan, Skin

OTHER_KINDS = {"pressed by a rod": by_rod, "touched by a finger without a press": touched_alone}


@dataclass(frozen=True)
class KindAccuracies:
    """Accuracies for other kinds of touch.

    accuracy: by kind of touch, then by target. kinds: accuracy of the kind itself, among a rod, a
    finger that presses, and a finger that only touches.
    """

    accuracy: Mapping[str, Mapping[str, BayesAccuracy]]
    kinds: BayesAccuracy

    def summary(self) -> dict[str, Any]:
        """Content of the file."""
        others = {
            kind: {target: numbers(found) for target, found in own.items()}
            for kind, own in self.accuracy.items()
        }
        return {**others, "kind_of_touch": numbers(self.kinds)}

    def lines(self) -> list[str]:
        """Lines for the terminal."""
        each = [
            f"  {kind}: at most " + ", ".join(f"{percent(a)} of {t}s" for t, a in own.items())
            for kind, own in self.accuracy.items()
        ]
        names = "a rod, a finger that presses, a finger that only touches"
        return [*each, f"  accuracy of the kind ({names}): at most {percent(self.kinds)}"]


def kind_accuracies(
    skin: Skin,
    plan: Plan,
    among: Mapping[str, Sequence[Hypothesis]],
    size: float | None,
    accuracy: Callable[[Sequence[Hypothesis]], BayesAccuracy],
) -> KindAccuracies | None:
    """Accuracies of other kinds of touch; None for a scene pressed by a rod or not pressed.

    among: hypotheses by target. size: see `TouchReadings`. accuracy: function of hypotheses.
    """
    if not plan.press.finger or plan.press.factor(skin) == 1:
        return None
    others = {
        name: {target: accuracy([*map(changed, own)]) for target, own in among.items()}
        for name, changed in OTHER_KINDS.items()
    }
    return KindAccuracies(others, accuracy(kinds(skin, plan, size)))


def by_finger(skin: Skin, plan: Plan, size: float | None) -> str:
    """Text of the finger of the scene's `press`, empty for a rod."""
    own = [each.fingers[0] for each in hypotheses(skin, plan, "pixel", size) if each.fingers]
    return f", by a finger of {1e12 * max(own):.3g} pF" if own else ""


def percent(found: BayesAccuracy) -> str:
    """Text of an accuracy and its standard error."""
    return f"{100 * found.share:.1f} ± {100 * found.error:.1f} %"


def digits(value: float, count: int) -> float:
    """A value rounded to `count` significant digits."""
    return float(f"{value:.{count}g}")


def numbers(found: BayesAccuracy) -> dict[str, float]:
    """An accuracy as content of a file."""
    return {
        "best_possible": digits(found.share, 6),
        "standard_error": digits(found.error, 2),
    }

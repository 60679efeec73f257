"""Of a scene that is pressed by fingers: what can be told of pixels that are touched otherwise."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ..bounds.bayes import Accuracy
from ..bounds.readings import Hypothesis, by_rod, hypotheses, kinds, touched_alone
from ..scene.scene import Scene

OTHERS = {"pressed by a rod": by_rod, "touched by a finger without a press": touched_alone}


@dataclass(frozen=True)
class Ways:
    """accuracy: by target, of every other way in words. kinds: of telling a rod, a finger that
    presses, and one that only touches apart."""

    accuracy: Mapping[str, Mapping[str, Accuracy]]
    kinds: Accuracy

    def summary(self) -> dict[str, Any]:
        """As it is written to a file."""
        others = {
            way: {target: numbers(found) for target, found in own.items()}
            for way, own in self.accuracy.items()
        }
        return {**others, "kind_of_touch": numbers(self.kinds)}

    def lines(self) -> list[str]:
        """As it is printed."""
        each = [
            f"  {way}: " + ", ".join(f"{t}s right at most {percent(a)}" for t, a in own.items())
            for way, own in self.accuracy.items()
        ]
        told = "a rod, a finger that presses or one that only touches"
        return [*each, f"  {told}: told apart in {percent(self.kinds)} at most"]


def ways(
    scene: Scene,
    among: Mapping[str, Sequence[Hypothesis]],
    size: float | None,
    accuracy: Callable[[Sequence[Hypothesis]], Accuracy],
) -> Ways | None:
    """None of a scene that is pressed by a rod, or not pressed at all.

    among: hypotheses by target. size: as of `Readings`. accuracy: of hypotheses.
    """
    if not scene.press.finger or scene.pressed_factor == 1:
        return None
    others = {
        name: {target: accuracy([*map(way, own)]) for target, own in among.items()}
        for name, way in OTHERS.items()
    }
    return Ways(others, accuracy(kinds(scene, size)))


def by_finger(scene: Scene, size: float | None) -> str:
    """The finger of the scene's `press` in words, nothing of a rod."""
    own = [each.fingers[0] for each in hypotheses(scene, "pixel", size) if each.fingers]
    return f", by a finger of {1e12 * max(own):.3g} pF" if own else ""


def percent(found: Accuracy) -> str:
    """An accuracy and its standard error."""
    return f"{100 * found.share:.1f} ± {100 * found.error:.1f} %"


def digits(value: float, count: int) -> float:
    """Rounded to so many significant ones."""
    return float(f"{value:.{count}g}")


def numbers(found: Accuracy) -> dict[str, float]:
    """An accuracy as it is written to a file."""
    return {
        "best_possible": digits(found.share, 6),
        "standard_error": digits(found.error, 2),
    }

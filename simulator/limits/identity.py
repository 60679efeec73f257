"""How well columns, rows and pixels of a scene can be told apart, in numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simulator.limits.bayes import Accuracy, bayes
from simulator.limits.hypotheses import hypotheses
from simulator.limits.pairwise import distances, upper_bound
from simulator.limits.readings import Readings
from simulator.limits.strengths import own_presses
from simulator.progress import Track, silent
from simulator.scene import Scene

TARGETS = ("column", "row", "pixel")


@dataclass(frozen=True)
class Identity:
    """Bayes' accuracy and the pairwise bound on it by target; distances between pixels' sweeps.

    apart: in the meter's errors, strengths unknown, shape (pixel, pixel); names: of the pixels.
    """

    accuracy: dict[str, Accuracy]
    bound: dict[str, float]
    apart: NDArray[np.float64]
    names: list[str]

    def summary(self) -> dict[str, Any]:
        """As it is written to a file."""
        return {
            target: {
                "best_possible": float(f"{found.share:.6g}"),
                "standard_error": float(f"{found.error:.2g}"),
                "pairwise_upper_bound": float(f"{self.bound[target]:.6g}"),
            }
            for target, found in self.accuracy.items()
        }

    def lines(self) -> list[str]:
        """As it is printed."""
        return [
            f"{target}s right: at most {100 * found.share:.1f} ± {100 * found.error:.1f} % "
            f"by any classifier (pairwise bound {100 * self.bound[target]:.1f} %)"
            for target, found in self.accuracy.items()
        ]


def identity(
    scene: Scene, seed: int, draws: int, against_rest: int = 0, track: Track = silent
) -> Identity:
    """Of a known skin, pressed as the scene's experiment does."""
    presses = own_presses(scene)
    readings = Readings(scene, presses, against_rest)
    among = {target: hypotheses(scene, target) for target in TARGETS}
    pixels = [each for each in among["pixel"] if each.pixels]
    return Identity(
        {t: bayes(readings, each, presses, seed, draws, track) for t, each in among.items()},
        {t: upper_bound(readings, each, presses) for t, each in among.items()},
        distances(readings, pixels, presses),
        [",".join(map(str, each.answer)) for each in pixels],
    )

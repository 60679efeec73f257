"""What can be told of a twin by whoever knows its skin: Bayes' decision, averaged over its hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.localization.twin_parts.skin import Twin
from rcskin.simulator.bounds.touch_readings import Hypothesis, hypotheses
from rcskin.simulator.limits.random_press_limits import (
    LimitInterval,
    RandomPresses,
    accuracy_of_presses,
    distance_of_presses,
)
from rcskin.simulator.measure.experiment import own_presses
from rcskin.simulator.press.batch import PressBatch
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.randomisation import CUT, truncated_normal
from rcskin.simulator.scene.scene import Scene


class TwinsHand(RandomPresses):
    """The hand of a twin on the twin's own skin, as it was before it drifted."""

    def __init__(self, twin: Twin, against_rest: int, size: float = 0.0) -> None:
        """against_rest: sweeps of the skin at rest, averaged, that a touch is told against. size:
        m, of a side of touches anywhere."""
        scene = twin.scene
        super().__init__(
            scene.parts,
            own_presses(scene.parts.skin, scene.press),
            size=(size, size),
            offset=twin.hand.offset,
            against_rest=against_rest,
        )
        self._twin, self.setup = twin, self.setup.behind(twin.drawn.leads)
        self._own = twin.family.skin(twin.drawn.variation)

    def pressed(self, meant: Hypothesis, random: np.random.Generator, count: int) -> NDArray:
        """Whitened readings, without noise, of pixels pressed so many times; (press, number)."""
        twin = self._twin
        asked = parse_press(_text(meant), twin.scene.press.capacitance_factor)
        events = random.integers(2**31, size=count).tolist()
        made = np.array(
            [
                [(each.x, each.y, each.width, each.height, each.factor) for each in press.touches]
                for press in (twin.pressed(asked, event) for event in events)
            ]
        )
        return self.whitened(self._rasterized(made[..., :2], made[..., 4], made[..., 2:4]))

    def anywhere(self, random: np.random.Generator, count: int) -> tuple[NDArray, NDArray]:
        """Where touches were meant, m, shape (press, 2), and readings of where the hand put them;
        their sides are as they were meant."""
        room = self._extent - self._sides
        meant = self._sides / 2 + random.random((count, 2)) * room
        aside = truncated_normal(random.random((count, 2)), CUT)
        return meant, self.read((meant + self._offset * self._sides * aside)[:, None], random)

    def _solved(self, batch: PressBatch) -> NDArray:
        return self._own.sweeps(batch, self.setup.frequency)


def known_accuracy(
    scene: Scene, twin: Twin, target: str, *, draws: int, samples: int, against_rest: int
) -> LimitInterval:
    """Of a target of pixels that are pressed, each as often, on the twin's own skin. Arguments as
    of `accuracy_of_presses`."""
    pixels = [
        each for each in hypotheses(scene.parts.skin, scene.parts.plan, target) if each.pixels
    ]
    even = [replace(each, chance=1 / len(pixels)) for each in pixels]
    hand = TwinsHand(twin, against_rest)
    return accuracy_of_presses(hand, even, seed=1 + twin.number, draws=draws, samples=samples)


def known_distance(
    scene: Scene, twin: Twin, *, size: float, draws: int, samples: int, against_rest: int
) -> float:
    """Median distance in mm of touches of this side in m, anywhere on the twin's own skin, from the
    middle of their posterior. Arguments as of `distance_of_hand`."""
    hand = TwinsHand(twin, against_rest, size)
    return 1e3 * distance_of_presses(hand, seed=1 + twin.number, draws=draws, samples=samples)[0]


def _text(meant: Hypothesis) -> str:
    return "+".join(f"{i + 1},{j + 1}" for i, j in meant.pixels)

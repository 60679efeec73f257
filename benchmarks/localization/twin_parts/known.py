"""What can be told of a twin by whoever knows its skin: Bayes' decision, averaged over its hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from rcskin.benchmarks.localization.twin_parts.skin import Twin
from rcskin.simulator.bounds.readings import Hypothesis, hypotheses
from rcskin.simulator.limits.hand import Between, Hand, accuracy_of_hand
from rcskin.simulator.measure.experiment import own_presses
from rcskin.simulator.measure.readout import errors_of, observed
from rcskin.simulator.press.batch import PressBatch
from rcskin.simulator.press.capacitance import touched_cells
from rcskin.simulator.press.press import parse_press
from rcskin.simulator.scene.frequency import laplace_variable
from rcskin.simulator.scene.scene import Scene


class TwinsHand(Hand):
    """The hand of a twin on the twin's own skin, as it was before it drifted."""

    def __init__(self, twin: Twin, against_rest: int) -> None:
        """against_rest: sweeps of the skin at rest, averaged, that a touch is told against."""
        scene = twin.scene
        super().__init__(scene, own_presses(scene), size=(0.0, 0.0), against_rest=against_rest)
        self._twin, self._errors = twin, errors_of(scene, against_rest)

    def pressed(self, meant: Hypothesis, random: np.random.Generator, count: int) -> NDArray:
        """Whitened readings, without noise, of pixels pressed so many times; (press, number)."""
        twin, frequencies = self._twin, self.scene.frequencies
        asked = parse_press(_text(meant), self.scene.press.capacitance_factor)
        events = random.integers(2**31, size=count).tolist()
        family = twin.family.scene
        batch = PressBatch.of(touched_cells(family, twin.pressed(asked, e)) for e in events)
        s = laplace_variable(frequencies, twin.drawn.variation.loss)
        Z = twin.family.skin(twin.drawn.variation).sweeps(batch, s)
        seen = twin.drawn.leads.seen_through(Z, frequencies)
        return self._errors.whitened(observed(seen))


def known_accuracy(
    scene: Scene, twin: Twin, *, draws: int, samples: int, against_rest: int
) -> Between:
    """Of pixels that are pressed, each as often, on the twin's own skin. Arguments as of
    `accuracy_of_hand`."""
    pixels = [each for each in hypotheses(scene, "pixel") if each.pixels]
    even = [replace(each, chance=1 / len(pixels)) for each in pixels]
    hand = TwinsHand(twin, against_rest)
    return accuracy_of_hand(hand, even, seed=1 + twin.number, draws=draws, samples=samples)


def _text(meant: Hypothesis) -> str:
    return "+".join(f"{i + 1},{j + 1}" for i, j in meant.pixels)

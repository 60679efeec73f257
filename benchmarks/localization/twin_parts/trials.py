"""What is asked of the localizers in the twin experiment, and how a skin's answers are scored."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from rcskin.benchmarks.localization.twin_parts.scenes import BETWEEN_RESTS, PLACED_SIZE, believed
from rcskin.benchmarks.localization.twin_parts.skin import Hand
from rcskin.localization.inputs.targets import labels, positions
from rcskin.localization.model.localizer_model import Model
from rcskin.localization.trust.answers import CANNOT_TELL
from rcskin.simulator.dataset.drawn_presses import FIRST_BASELINES
from rcskin.simulator.scene.scene import Scene

ONE, TWO = "sheet-5x5", "sheet-5x5-two-interfaces"
FEW_SWEEPS = 600
SINGLE, DOUBLE = (0.15, 0.85, 0.0), (0.15, 0.15, 0.7)
Order = Callable[[Scene, np.random.Generator], list[str]]


@dataclass(frozen=True)
class Trial:
    """One question.

    believed: the localizer's scene. order: presses of a recording, apart from the skin at rest.
    estimators: those that are compared, the reference first. goal: median over skins, of the share
    of right answers, or of the distance in mm where `target` is a position. training: simulated
    sweeps. touches: of known place that the skin is calibrated with, for a second answer. hand: a
    person's, or a stage that places touches to half a millimetre.
    """

    name: str
    believed: Scene
    target: str
    order: Order
    estimators: tuple[str, ...]
    goal: float
    training: int
    touches: int = 0
    hand: Hand = Hand()

    @property
    def placed(self) -> bool:
        """Whether a distance is scored."""
        return self.target == "position"

    @property
    def unit(self) -> str:
        """Of scores."""
        return "mm" if self.placed else "right"

    def recording(self, random: np.random.Generator) -> list[str]:
        """Presses with the skin at rest in between and at both ends, as `live` has it at first."""
        presses = self.order(self.believed, random)
        parts = [presses[k : k + BETWEEN_RESTS] for k in range(0, len(presses), BETWEEN_RESTS)]
        return ["none"] * FIRST_BASELINES + [
            *itertools.chain.from_iterable([*part, "none"] for part in parts)
        ]

    def score(self, model: Model, sweeps: xr.Dataset) -> tuple[float, float]:
        """Of one skin: the share of right answers, or the median distance in mm; share answered.

        Through the guard, as a user's sweeps go: a touch that "cannot be told" is none that is
        told right, and is infinitely far.
        """
        touched = np.flatnonzero(sweeps["press"].values != "none")
        asked = sweeps.isel(sweep=touched)
        told = model.answers(sweeps).labels[touched]
        answered = float((told != CANNOT_TELL).mean())
        if self.placed:
            found, _ = model.positions(sweeps)
            off = np.hypot(*(found[touched] - positions(asked))[:, :2].T)
            return float(np.median(np.where(told == "1", off, np.inf))), answered
        return float((told == labels(asked, self.target).astype(str)).mean()), answered


def every_pixel(repetitions: int) -> Order:
    """Every pixel so many times, in an order of its own each time."""

    def order(scene: Scene, random: np.random.Generator) -> list[str]:
        pixels = [
            f"{i + 1},{j + 1}" for i, j in np.ndindex(scene.pixels.rows, scene.pixels.columns)
        ]
        return [press for _ in range(repetitions) for press in random.permutation(pixels)]

    return order


def every_pair(scene: Scene, random: np.random.Generator) -> list[str]:
    """Every two pixels once, in an order of its own."""
    pixels = [f"{i + 1},{j + 1}" for i, j in np.ndindex(scene.pixels.rows, scene.pixels.columns)]
    pairs = ["+".join(pair) for pair in itertools.combinations(pixels, 2)]
    return list(random.permutation(pairs))


def anywhere(count: int) -> Order:
    """Squares anywhere on the skin."""

    def order(scene: Scene, random: np.random.Generator) -> list[str]:
        side = PLACED_SIZE.value
        places = side / 2 + random.uniform(size=(count, 2)) * (
            np.array([scene.skin.length, scene.skin.width]) - side
        )
        return [f"rect({x:.4f},{y:.4f},{side:g},{side:g})" for x, y in places]

    return order


def _columns(pixels: int, goal: float) -> Trial:
    return Trial(
        f"column of {pixels}x{pixels}",
        believed(ONE, pixels, SINGLE),
        "column",
        every_pixel(4),
        ("ksvm-ovo", "model-based", "model-adapted"),
        goal,
        training=20_000,
    )


TRIALS = (
    _columns(3, 1.0),
    _columns(4, 1.0),
    _columns(5, 0.97),
    Trial(
        "pixel of 6x6, two interfaces",
        believed(TWO, 6, SINGLE),
        "pixel",
        every_pixel(2),
        ("ksvm-ovo", "model-based", "model-adapted"),
        0.90,
        training=12_000,
        touches=5,
    ),
    Trial(
        "pixel of 6x6, two interfaces",
        believed(TWO, 6, SINGLE),
        "pixel",
        every_pixel(2),
        ("network",),
        0.90,
        training=240_000,
    ),
    Trial(
        "both of two touches on 4x4, two interfaces",
        believed(TWO, 4, DOUBLE),
        "pair",
        every_pair,
        ("network", "ksvm-components", "model-based", "model-adapted"),
        0.80,
        training=480_000,
    ),
    Trial(
        "position of a touch, two interfaces",
        believed(TWO, 5, SINGLE, anywhere=True),
        "position",
        anywhere(60),
        ("network", "kernel-ridge", "model-based", "model-adapted"),
        4.0,
        training=150_000,
        hand=Hand(offset=0.02, size=0.02),
    ),
)


def few_trials() -> tuple[Trial, ...]:
    """Touches that calibrate, two touches, and a place, all by one interface.

    Without networks, which take their time of however few sweeps, and without the inverted
    simulator, which tells places in the benchmark of limits.
    """
    calibrated, _, two, place = TRIALS[3:]
    few = (
        replace(calibrated, believed=believed(ONE, 3, SINGLE), order=every_pixel(1)),
        replace(two, believed=believed(ONE, 2, DOUBLE), estimators=two.estimators[1:]),
        replace(
            place,
            believed=believed(ONE, 3, SINGLE, anywhere=True),
            order=anywhere(5),
            estimators=place.estimators[1:3],
        ),
    )
    return tuple(replace(trial, training=FEW_SWEEPS) for trial in few)


def quantile(scores: NDArray[np.float64], part: float) -> float:
    """Of the scores of all skins."""
    return float(np.quantile(scores, part))

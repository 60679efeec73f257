"""How many pixels a sheet can have for an accuracy: at most, whatever the classifier."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from simulator.limits.bayes import Accuracy, bayes
from simulator.limits.hypotheses import hypotheses
from simulator.limits.pairwise import upper_bound
from simulator.limits.readings import Readings
from simulator.limits.strengths import own_presses
from simulator.progress import Track, silent
from simulator.scene import Pixels, Scene
from simulator.sweeps import InputError

FEWEST, MOST = 2, 12
DEVIATIONS = 2
"""Standard errors that an accuracy may lie below what is asked."""


@dataclass(frozen=True)
class Count:
    """Pixels along each side (of a strip: along it), the best accuracy, and the pairwise bound."""

    n: int
    accuracy: Accuracy
    bound: float

    def reaches(self, asked: float) -> bool:
        """Whether that accuracy cannot be excluded."""
        return self.accuracy.share + DEVIATIONS * self.accuracy.error >= asked


def counts(
    scene: Scene,
    target: str,
    asked: float,
    seed: int,
    draws: int,
    against_rest: int = 0,
    track: Track = silent,
) -> Iterator[Count]:
    """From FEWEST pixels on, up to the first number that does not reach what is asked.

    Raises InputError where that is no accuracy between 0 and 1.
    """
    if not 0 < asked < 1:
        raise InputError(f"--accuracy must be > 0 and < 1, got {asked:g}")
    for n in range(FEWEST, MOST + 1):
        found = counted(scene, target, n, seed, draws, against_rest, track)
        yield found
        if not found.reaches(asked):
            return


def counted(
    scene: Scene,
    target: str,
    n: int,
    seed: int,
    draws: int,
    against_rest: int = 0,
    track: Track = silent,
) -> Count:
    """The best accuracy with n pixels along each side."""
    divided = with_pixels(scene, n)
    presses, among = own_presses(divided), hypotheses(divided, target)
    readings = Readings(divided, presses, against_rest)
    readings.train(track)
    bound = upper_bound(readings, among, presses)
    return Count(n, bayes(readings, among, presses, seed, draws, track), bound)


def with_pixels(scene: Scene, n: int) -> Scene:
    """The same skin with n x n pixels; a strip of one row keeps its one row, or its one column."""
    rows = 1 if scene.pixels.rows == 1 else n
    columns = 1 if scene.pixels.columns == 1 and rows > 1 else n
    return scene.model_copy(update={"pixels": Pixels(rows=rows, columns=columns)})


def shape_of(scene: Scene, n: int) -> str:
    """n pixels along each side as rows x columns."""
    pixels = with_pixels(scene, n).pixels
    return f"{pixels.rows}x{pixels.columns}"

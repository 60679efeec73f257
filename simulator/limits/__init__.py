"""What one sweep can tell at most, whoever reads it: bounds on position, strength and pixel."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..bounds.position import Bounds
    from ..scene.randomisation import AnyDistribution
    from ..scene.scene import Scene
    from .hand import Between
from ..progress import ProgressCallback, silent


def bayes_accuracy(
    scene: Scene,
    target: str = "column",
    presses: AnyDistribution | None = None,
    *,
    seed: int = 1,
    draws: int = 2000,
    against_rest: int = 0,
    progress: ProgressCallback = silent,
) -> tuple[float, float]:
    """Share of sweeps that the best classifier of a known skin gets right, and its standard error.

    No classifier gets more of them right but for the standard error. target: column, row, pixel,
    pair (two touches, both right) or touches (how many, 0 to 2). presses: distribution of factors,
    by default the scene's. against_rest: sweeps of the skin at rest, in the same session, whose
    mean each sweep is read as the difference to; 0: as it is. A very large number bounds all uses
    of the skin at rest, for then nothing is left of the meter's errors of the session. Raises
    InputError for another target, a meter without noise, or one with too little of it.
    """
    from ..bounds.bayes import bayes
    from ..bounds.readings import Readings, hypotheses
    from ..measure.experiment import own_presses

    among = hypotheses(scene, target)
    factors = presses or own_presses(scene)
    readings = Readings(scene, factors, against_rest)
    return bayes(readings, among, factors, seed, draws, progress)


def hand_accuracy(
    scene: Scene,
    target: str = "column",
    presses: AnyDistribution | None = None,
    *,
    offset: float = 0.1,
    seed: int = 1,
    draws: int = 1000,
    samples: int = 4000,
    against_rest: int = 0,
    progress: ProgressCallback = silent,
) -> Between:
    """As `bayes_accuracy`, for a hand that presses beside the pixels that it means.

    offset: standard deviation along each side of a pixel, over that side. samples: presses that
    each hypothesis is marginalised over; the limit lies between `least` and `most`, which close in
    on it with more of them, but for `error`. Raises InputError as `bayes_accuracy` does, and for an
    offset out of range.
    """
    from ..bounds.readings import hypotheses
    from ..measure.experiment import own_presses
    from ..sweeps import InputError
    from .hand import Hand, accuracy_of_hand

    if not 0 <= offset <= 0.5:
        raise InputError(f"`offset` must be in 0..0.5 of a pixel's side, got {offset:g}")
    hand = Hand.of_pixels(
        scene, presses or own_presses(scene), offset=offset, against_rest=against_rest
    )
    among = hypotheses(scene, target)
    return accuracy_of_hand(hand, among, seed=seed, draws=draws, samples=samples, progress=progress)


def hand_distance(
    scene: Scene,
    presses: AnyDistribution | None = None,
    *,
    size: float,
    seed: int = 1,
    draws: int = 500,
    samples: int = 40_000,
    against_rest: int = 0,
) -> tuple[float, float]:
    """Median distance, m, of square touches anywhere from the middle of their posterior, and its
    standard error, of a skin that is known. It may be less than of any unbiased estimate.

    size: of a side, m. presses, against_rest: as in `bayes_accuracy`. samples: touches that the
    posterior is told by; with few of them the distance comes out large. Raises InputError for a
    size out of range or a meter without noise.
    """
    from ..bounds.position import chosen_touch
    from ..measure.experiment import own_presses
    from .hand import Hand, distance_of_hand

    touch = chosen_touch(scene, size)
    hand = Hand(
        scene,
        presses or own_presses(scene),
        size=(touch.width, touch.height),
        against_rest=against_rest,
    )
    return distance_of_hand(hand, seed=seed, draws=draws, samples=samples)


def position_bound(
    scene: Scene,
    *,
    size: float | None = None,
    factor: float | None = None,
    against_rest: int = 0,
    unknown_skin: bool = False,
    most: int | None = None,
    progress: ProgressCallback = silent,
) -> Bounds:
    """Least standard deviations of x and y [m] and of the rise of capacitance, over the sheet.

    No unbiased estimate from one sweep goes below them. size: of the square touch in m, by default
    a pixel's; factor: by default the scene's. against_rest: as in `bayes_accuracy`. unknown_skin:
    whether the skin differs from the scene's as [dataset.session] says. most: places along each
    side, by default every cell. Infinite where a coordinate is told no closer than its room.
    Raises InputError for a size or factor out of range or a meter without noise.
    """
    from ..bounds.fields import CELLS_PER_PIXEL, fields_of
    from ..bounds.position import chosen_touch, places_on, position_slopes

    touch = chosen_touch(scene, size, factor)
    fields = fields_of(scene, float(scene.frequencies[-1]), touch)
    slopes = position_slopes(
        fields,
        places_on(scene, touch, CELLS_PER_PIXEL, most),
        touch,
        scene.frequencies,
        against_rest=against_rest,
        unknown_skin=unknown_skin,
        progress=progress,
    )
    return slopes.bounds(taken=scene.taken)

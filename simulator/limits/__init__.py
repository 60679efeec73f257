"""Limits of one sweep for any estimator: bounds on position, strength and pixel."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..bounds.position_bound import PositionBounds
    from ..scene.parts import SceneParts
    from ..scene.randomisation import AnyDistribution
    from .random_press_limits import LimitInterval
from ..progress import ProgressCallback, silent


def bayes_accuracy(
    parts: SceneParts,
    target: str = "column",
    presses: AnyDistribution | None = None,
    *,
    seed: int = 1,
    draws: int = 2000,
    against_rest: int = 0,
    progress: ProgressCallback = silent,
) -> tuple[float, float]:
    """Accuracy of the best classifier of a known skin, and its standard error.

    No classifier is more accurate, up to the standard error. target: column, row, pixel, pair (two
    touches, both correct) or touches (their number, 0 to 2). presses: distribution of factors, by
    default the scene's. against_rest: number of baseline sweeps of the same session whose mean is
    subtracted from each sweep; 0 for none. A very large number bounds all uses of the unpressed
    skin, because it removes the meter's errors of the session. Raises InputError for another
    target, a meter without noise, or one with too little noise.
    """
    from ..bounds.bayes import bayes
    from ..bounds.touch_readings import TouchReadings, hypotheses
    from ..measure.experiment import own_presses

    among = hypotheses(parts.skin, parts.plan, target)
    factors = presses or own_presses(parts.skin, parts.plan.press)
    readings = TouchReadings(parts, factors, against_rest)
    return bayes(readings, among, factors, seed, draws, progress)


def off_centre_accuracy(
    parts: SceneParts,
    target: str = "column",
    presses: AnyDistribution | None = None,
    *,
    offset: float = 0.1,
    seed: int = 1,
    draws: int = 1000,
    samples: int = 4000,
    against_rest: int = 0,
    progress: ProgressCallback = silent,
) -> LimitInterval:
    """Best accuracy as in `bayes_accuracy`, for presses off the centre of their pixel.

    offset: standard deviation of the position along each side of a pixel, over that side. samples:
    presses over which each hypothesis is marginalised. The limit is between `lower` and `upper`, up
    to `error`; more samples make the interval smaller. Raises InputError as `bayes_accuracy` does,
    and for an offset out of range.
    """
    from ..bounds.touch_readings import hypotheses
    from ..measure.experiment import own_presses
    from ..sweeps import InputError
    from .random_press_limits import RandomPresses, accuracy_of_presses

    if not 0 <= offset <= 0.5:
        raise InputError(f"`offset` must be in 0..0.5 of a pixel's side, got {offset:g}")
    random_presses = RandomPresses.of_pixels(
        parts,
        presses or own_presses(parts.skin, parts.plan.press),
        offset=offset,
        against_rest=against_rest,
    )
    among = hypotheses(parts.skin, parts.plan, target)
    return accuracy_of_presses(
        random_presses, among, seed=seed, draws=draws, samples=samples, progress=progress
    )


def posterior_distance(
    parts: SceneParts,
    presses: AnyDistribution | None = None,
    *,
    size: float,
    seed: int = 1,
    draws: int = 500,
    samples: int = 40_000,
    against_rest: int = 0,
) -> tuple[float, float]:
    """Median distance, m, between square touches and the median of their posterior.

    Also returns its standard error. Touches are at random positions on a known skin. The distance
    may be less than that of any unbiased estimate. size: of a side, m. presses, against_rest: see
    `bayes_accuracy`. samples: touches that represent the posterior; with few of them the distance
    is too large. Raises InputError for a size out of range or a meter without noise.
    """
    from ..bounds.position_bound import chosen_touch
    from ..measure.experiment import own_presses
    from .random_press_limits import RandomPresses, distance_of_presses

    touch = chosen_touch(parts.skin, parts.plan.press, size)
    random_presses = RandomPresses(
        parts,
        presses or own_presses(parts.skin, parts.plan.press),
        size=(touch.width, touch.height),
        against_rest=against_rest,
    )
    return distance_of_presses(random_presses, seed=seed, draws=draws, samples=samples)


def position_bound(
    parts: SceneParts,
    *,
    size: float | None = None,
    factor: float | None = None,
    against_rest: int = 0,
    unknown_skin: bool = False,
    max_places: int | None = None,
    progress: ProgressCallback = silent,
) -> PositionBounds:
    """Smallest standard deviations of x and y [m] and of the rise of capacitance, over the sheet.

    They bound all unbiased estimates from one sweep. size: of the square touch in m, by default a
    pixel's. factor: by default the scene's. against_rest: see `bayes_accuracy`. unknown_skin: True
    if the skin differs from the scene's by [dataset.session]. max_places: largest number of
    positions along each side, by default one for every cell. Deviations are infinite where a
    coordinate is not known better than its range. Raises InputError for a size or factor out of
    range or a meter without noise.
    """
    from ..bounds.field_choice import fields_of
    from ..bounds.full_fields import CELLS_PER_PIXEL
    from ..bounds.position_bound import chosen_touch, place_likelihood, places_on

    touch = chosen_touch(parts.skin, parts.plan.press, size, factor)
    fields = fields_of(parts, float(parts.setup.frequency[-1]), touch)
    slopes = place_likelihood(
        fields,
        places_on(parts.skin, touch, CELLS_PER_PIXEL, max_places),
        touch,
        parts.setup.frequency,
        against_rest=against_rest,
        unknown_skin=unknown_skin,
        progress=progress,
    )
    return slopes.bounds(taken=parts.setup.taken)

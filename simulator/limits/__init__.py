"""What one sweep can tell at most, whoever reads it: bounds on position, strength and pixel."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from simulator.distribution import AnyDistribution
    from simulator.limits.position import Bounds
    from simulator.progress import Track
    from simulator.scene import Scene


def bayes_accuracy(
    scene: Scene,
    target: str = "column",
    presses: AnyDistribution | None = None,
    *,
    seed: int = 1,
    draws: int = 2000,
    against_rest: int = 0,
    track: Track | None = None,
) -> tuple[float, float]:
    """Share of sweeps that the best classifier of a known skin gets right, and its standard error.

    No classifier gets more of them right but for the standard error. target: column, row, pixel,
    pair (two touches, both right) or touches (how many, 0 to 2). presses: distribution of factors,
    by default the scene's. against_rest: sweeps of the skin at rest, in the same session, whose
    mean each sweep is read as the difference to; 0: as it is. A very large number bounds all uses
    of the skin at rest, for then nothing is left of the meter's errors of the session. Raises
    InputError for another target, a meter without noise, or one with too little of it.
    """
    from simulator.limits.bayes import bayes
    from simulator.limits.hypotheses import hypotheses
    from simulator.limits.readings import Readings
    from simulator.limits.strengths import own_presses
    from simulator.progress import silent

    among = hypotheses(scene, target)
    factors = presses or own_presses(scene)
    readings = Readings(scene, factors, against_rest)
    return bayes(readings, among, factors, seed, draws, track or silent)


def position_bound(
    scene: Scene,
    *,
    size: float | None = None,
    factor: float | None = None,
    against_rest: int = 0,
    unknown_skin: bool = False,
    most: int | None = None,
    track: Track | None = None,
) -> Bounds:
    """Least standard deviations of x and y [m] and of the rise of capacitance, over the sheet.

    No unbiased estimate from one sweep goes below them. size: of the square touch in m, by default
    a pixel's; factor: by default the scene's. against_rest: as in `bayes_accuracy`. unknown_skin:
    whether the skin differs from the scene's as [dataset.session] says. most: places along each
    side, by default every cell. Infinite where a coordinate is told no closer than its room.
    Raises InputError for a size or factor out of range or a meter without noise.
    """
    from simulator.limits.fields import Fields
    from simulator.limits.position import chosen_touch, places_on, position_slopes
    from simulator.progress import silent

    touch = chosen_touch(scene, size, factor)
    fields = Fields(scene, float(scene.frequencies[-1]))
    slopes = position_slopes(
        fields,
        places_on(scene, touch, fields.cells, most),
        touch,
        scene.frequencies,
        against_rest=against_rest,
        unknown_skin=unknown_skin,
        track=track or silent,
    )
    return slopes.bounds()

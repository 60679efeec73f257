"""References: another telling of the problem solved far closer, or polygons that become discs."""

from __future__ import annotations

from collections.abc import Callable

from rcskin.benchmarks.accuracy.campaign_parts.draws import Rng
from rcskin.benchmarks.accuracy.campaign_parts.moves import (
    has_discs,
    outlined,
    regridded,
    turned,
    with_polygons,
)
from rcskin.benchmarks.accuracy.campaign_parts.problem import Problem, Route, Truth, solved
from rcskin.simulator.fem.error_estimate import relative_difference

OTHER_SHARE = 1 / 12
"""Of the tolerance: what is asked of a reference by another mesh."""
SIDES, LOOSE = 24.0, 1e-3
"""Of the coarser polygon for a disc at that tolerance, and as its fourth root falls ever more."""
LEFT = 1 / 3
"""Of what a polygon of twice the sides changes, of the same area: what is off after that. It falls
as sides^-2 at least, as sides^-4 where nothing cuts the circle."""
CROSSED = 7.0
"""Over sides^3: the part of a disc by which a side that is cut is off at most, 2/3 pi² of it."""
TURNS = (0.2, 1.3)
OTHER_GRID = (3, 2)
Telling = Callable[[Problem], Problem]


def by(other: Problem, share: float = OTHER_SHARE) -> Route:
    """The truth is another telling of the problem, at a share of the tolerance."""
    return lambda rtol: solved(other, share * rtol)


def by_polygons(
    of_sides: Callable[[int], Problem], share: float = OTHER_SHARE, cut: bool = False
) -> Route:
    """The truth is what polygons in place of circles come to, as their sides are doubled.

    cut: whether something may jump across a circle's inside.
    """

    def route(rtol: float) -> Truth:
        sides = 4 * round(SIDES * (LOOSE / rtol) ** 0.25 / 4)
        coarse, fine = (solved(of_sides(n * sides), share * rtol) for n in (1, 2))
        left = LEFT * relative_difference(coarse.Z, fine.Z)
        return Truth(fine.Z, fine.doubt + left + cut * CROSSED / (2 * sides) ** 3)

    return route


def by_telling(problem: Problem, tell: Telling, share: float = OTHER_SHARE) -> Route:
    """The truth is the problem described in another way, with polygons for any discs."""
    if not has_discs(problem.press):
        return by(tell(problem), share)
    cut = len(problem.press.touches) > 1 or "outline" in problem.tables["skin"]
    return by_polygons(lambda sides: tell(with_polygons(problem, sides)), share, cut)


def elsewhere(rng: Rng, rectangle: Problem, share: float = OTHER_SHARE) -> Route:
    """By triangles on the rectangle as an outline, and discs as polygons.

    It is turned, so that no two lines are the same, where it is even; otherwise it has none of its
    pixels' lines.
    """
    even = not ({"stretch", "shape"} & rectangle.tables["skin"].keys()) and not any(
        "map" in rectangle.tables["skin"][part] for part in ("top", "bottom", "foam")
    )
    angle, pixels = rng.uniform(*TURNS), rectangle.tables["pixels"]
    grid = OTHER_GRID if pixels == {"rows": 1, "columns": 1} else (1, 1)

    def tell(problem: Problem) -> Problem:
        drawn = outlined(problem)
        return turned(drawn, angle) if even else regridded(drawn, *grid)

    return by_telling(rectangle, tell, share)

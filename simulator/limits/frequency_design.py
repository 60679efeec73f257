"""Choice of the best n frequencies, compared with the paper's and with logarithmic spacing."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ..arrays import Integer, Real
from ..bounds.choice import best_choice
from ..bounds.fields import CELLS_PER_PIXEL, fields_of
from ..bounds.frequency_sets import OPTIMAL, candidates_of, compared, too_near
from ..bounds.position_bound import Slopes, TouchSize, places_on, position_slopes
from ..progress import ProgressCallback, silent
from ..scene.parts import SceneParts
from ..sweeps import InputError
from ..sweeps.units import prefixed
from .criteria import Criterion, identity_criterion, position_criterion

GRID = 60

MIN_GRID, MAX_GRID = 2, 400

DESIGN_PLACES = 64
"""Approximate number of positions for the choice of frequencies."""


@dataclass(frozen=True)
class FrequencyDesign:
    """Sets of frequencies in Hz by name, OPTIMAL among them, and the figure of each.

    figures: minimized values; in m for position, for column and pixel 1 over the distance in the
    meter's errors. left_out: number of coordinates, or pairs of pixels, that no set resolves.
    errors: for position, the median error in m of each set, as in `limits`. assumptions: text on
    the touch, the meter and the candidates.
    """

    criterion: str
    sets: dict[str, Real]
    figures: dict[str, float]
    left_out: int
    errors: dict[str, float]
    assumptions: str

    @property
    def optimal_for(self) -> str:
        """Sentence on what the choice is optimal for."""
        if self.criterion == "position":
            goal = "the smallest bound on the position error, rms over the sheet"
        else:
            goal = (
                f"the largest distance of the nearest two {self.criterion}s in the meter's errors"
            )
        return f"{OPTIMAL}: {goal}, {self.assumptions}"

    @property
    def best(self) -> Real:
        """The frequencies chosen, Hz."""
        return self.sets[OPTIMAL]

    @property
    def heading(self) -> str:
        """Heading of the column of figures."""
        if self.criterion == "position":
            return "median error"
        return f"nearest {self.criterion}s (meter's errors)"

    def figure_text(self, name: str) -> str:
        """Text of the figure of a set."""
        if self.criterion == "position":
            return f"{1e3 * self.errors[name]:.4g} mm"
        return f"distance {1 / self.figures[name]:.3g} errors"

    @property
    def over(self) -> str:
        """Heading of the column of `ratio`."""
        return "rms bound over the best" if self.criterion == "position" else "over the best"

    def comparison(self, name: str) -> str:
        """Text of a set: its figure, and its ratio to the best."""
        figure = f"{self.figure_text(name)}, {self.ratio(name):.3g} times the best"
        return f"median error {figure} by the rms bound" if self.errors else figure

    def ratio(self, name: str) -> float:
        """Rms bound of a set over the best's, or its distance over the best's."""
        ratio = self.figures[name] / self.figures[OPTIMAL]
        return ratio if self.criterion == "position" else 1 / ratio


def design(
    parts: SceneParts,
    n: int,
    band: tuple[float, float],
    touch: TouchSize,
    *,
    criterion: str = "position",
    grid: int = GRID,
    against_rest: int = 0,
    repeats: bool = False,
    among: Real | None = None,
    progress: ProgressCallback = silent,
) -> FrequencyDesign:
    """The best n of `candidates_of` a scene in a band in Hz, by a criterion of `criteria`.

    Unless repeats are allowed, no two of them are `too_near`. among: candidate frequencies in Hz,
    ascending, instead of these. Raises InputError where n or the grid is out of range.
    """
    check_design(n, grid if among is None else len(among), repeats, grid)
    others = compared(parts.skin, parts.setup, n, band)
    own = candidates_of(parts.skin, parts.setup, n, band, grid) if among is None else among
    every = np.unique(np.concatenate([own, *others.values()]))
    scored, slopes = criterion_at(parts, criterion, every, touch, against_rest, progress)
    numbers = {name: np.searchsorted(every, f) for name, f in others.items()}
    best = best_set(
        scored, np.searchsorted(every, own), n, numbers.values(), repeats, among is None
    )
    chosen = {OPTIMAL: best, **numbers}
    return FrequencyDesign(
        criterion,
        {name: every[k] for name, k in chosen.items()},
        {name: float(scored.score(k[None])[0]) for name, k in chosen.items()},
        scored.left_out,
        {}
        if slopes is None
        else {name: slopes.bounds(every[k]).median_error() for name, k in chosen.items()},
        _assumptions(touch, own, against_rest),
    )


def _assumptions(touch: TouchSize, candidates: Real, against_rest: int) -> str:
    """Text on what a choice of frequencies takes as given."""
    low, high = (prefixed(each, "Hz") for each in (candidates[0], candidates[-1]))
    size = f"{1e3 * touch.width:.3g} x {1e3 * touch.height:.3g} mm"
    baseline = f", compared with {against_rest} unpressed sweeps" if against_rest else ""
    finger = f" by a finger of {1e12 * touch.finger:.3g} pF" if touch.finger else ""
    return (
        f"for one touch of {size} and {1 + touch.rise:.3g} times the capacitance{finger} "
        f"on a known skin, with the noise of the scene's readout{baseline}; the best found of "
        f"{len(candidates)} candidates from {low} to {high}"
    )


def best_set(
    criterion: Criterion,
    own: Integer,
    n: int,
    others: Iterable[Integer],
    repeats: bool = False,
    spaced: bool = True,
) -> Integer:
    """The best n of the candidates `own`, which are indices of frequencies of the criterion.

    others: further sets from which exchanges start. spaced: True if no two may be `too_near`.
    """
    excludes = too_near(criterion.frequency[own], n) if spaced else np.eye(len(own), dtype=bool)
    excludes &= not repeats
    starts = [np.searchsorted(own, k) for k in others if np.isin(k, own).all()]
    return own[best_choice(lambda k: criterion.score(own[k]), len(own), n, starts, excludes)]


def sampled_positions(slopes: Slopes) -> Slopes:
    """About DESIGN_PLACES of the positions, evenly spread."""
    return slopes.some(max(1, len(slopes.places) // DESIGN_PLACES))


def check_design(n: int, candidates: int, repeats: bool, grid: int) -> None:
    """Raises InputError where n frequencies cannot be chosen."""
    if not MIN_GRID <= grid <= MAX_GRID:
        raise InputError(f"--grid must be from {MIN_GRID} to {MAX_GRID}, got {grid}")
    if not (n >= 1 and (repeats or n <= candidates)):
        raise InputError(
            f"-n must be from 1 to {candidates}, the number of candidate frequencies, got {n}"
        )


def criterion_at(
    parts: SceneParts,
    name: str,
    candidates: Real,
    touch: TouchSize,
    against_rest: int,
    progress: ProgressCallback,
) -> tuple[Criterion, Slopes | None]:
    """The criterion and, for position, the slopes at all positions of `limits`."""
    of_groups = name != "position" and parts.skin.pixels.groups is not None
    cells = 1 if of_groups else None
    fields = fields_of(parts, float(candidates[-1]), touch, cells)
    if name != "position":
        return identity_criterion(fields, name, candidates, against_rest, progress, touch), None
    places = places_on(parts.skin, touch, CELLS_PER_PIXEL)
    slopes = position_slopes(
        fields, places, touch, candidates, against_rest=against_rest, progress=progress
    )
    return position_criterion(sampled_positions(slopes)), slopes

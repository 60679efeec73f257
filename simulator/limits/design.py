"""The n frequencies that tell most, beside those of the paper and those of even spacing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..bounds.exchange import best_choice
from ..bounds.fields import CELLS_PER_PIXEL, fields_of
from ..bounds.position import TouchSize, places_on, position_slopes
from ..bounds.sets import OPTIMAL, compared, logarithmic, within
from ..progress import Track, silent
from ..scene.scene import Scene
from ..sweeps import InputError
from .criteria import Criterion, identity_criterion, position_criterion

GRID = 60

LEAST_GRID, LARGEST_GRID = 2, 400

PLACES = 10
"""Along each side, that position is judged at."""


@dataclass(frozen=True)
class Design:
    """Sets of frequencies in Hz by name, OPTIMAL among them, and the figure of each.

    figures: what is to be small, in m for position, for column and pixel one over the distance in
    the meter's errors. left_out: coordinates at places, or pairs of pixels, that no set tells.
    """

    criterion: str
    sets: dict[str, NDArray[np.float64]]
    figures: dict[str, float]
    left_out: int

    @property
    def best(self) -> NDArray[np.float64]:
        """The frequencies chosen, Hz."""
        return self.sets[OPTIMAL]

    @property
    def heading(self) -> str:
        """What the figures are."""
        if self.criterion == "position":
            return "rms bound (mm)"
        return f"nearest {self.criterion}s (meter's errors)"

    def told(self, name: str) -> str:
        """The figure of a set for people."""
        figure = self.figures[name]
        if self.criterion == "position":
            return f"{1e3 * figure:.3g} mm"
        return f"{1 / figure:.3g} errors apart"

    def ratio(self, name: str) -> float:
        """How much worse a set is: its bound over the best, or its distance over the best's."""
        ratio = self.figures[name] / self.figures[OPTIMAL]
        return ratio if self.criterion == "position" else 1 / ratio


def design(
    scene: Scene,
    n: int,
    band: tuple[float, float],
    touch: TouchSize,
    *,
    criterion: str = "position",
    grid: int = GRID,
    against_rest: int = 0,
    repeats: bool = False,
    track: Track = silent,
) -> Design:
    """The best n of a grid of frequencies over a band in Hz, by a criterion of `criteria`.

    The frequencies of the sets it is compared with are candidates too. Raises InputError where n or
    the grid is out of range.
    """
    check_design(n, grid, repeats)
    others = compared(scene, n, band)
    candidates = np.unique(
        np.concatenate([within(logarithmic(band, grid), band), *others.values()])
    )
    judged = _criterion(scene, criterion, candidates, touch, against_rest, track)
    numbers = {name: np.searchsorted(candidates, f) for name, f in others.items()}
    starts = [k for k in numbers.values() if repeats or len(np.unique(k)) == n]
    best = best_choice(judged.score, len(candidates), n, starts, repeats=repeats)
    chosen = {OPTIMAL: best, **numbers}
    return Design(
        criterion,
        {name: candidates[k] for name, k in chosen.items()},
        {name: float(judged.score(k[None])[0]) for name, k in chosen.items()},
        judged.left_out,
    )


def check_design(n: int, grid: int, repeats: bool) -> None:
    """Raises InputError where so many frequencies cannot be chosen."""
    if not LEAST_GRID <= grid <= LARGEST_GRID:
        raise InputError(f"--grid must be from {LEAST_GRID} to {LARGEST_GRID}, got {grid}")
    if not (n >= 1 and (repeats or n <= grid)):
        raise InputError(f"-n must be from 1 to {grid}, the frequencies to choose from, got {n}")


def _criterion(
    scene: Scene,
    name: str,
    candidates: NDArray[np.float64],
    touch: TouchSize,
    against_rest: int,
    track: Track,
) -> Criterion:
    of_groups = name != "position" and scene.pixels.groups is not None
    cells = 1 if of_groups else None
    fields = fields_of(scene, float(candidates[-1]), touch, cells)
    if name != "position":
        return identity_criterion(fields, name, candidates, against_rest, track, touch)
    places = places_on(scene, touch, CELLS_PER_PIXEL, PLACES)
    slopes = position_slopes(
        fields, places, touch, candidates, against_rest=against_rest, track=track
    )
    return position_criterion(slopes)

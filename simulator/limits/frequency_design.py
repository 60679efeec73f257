"""Choice of the best n frequencies, compared with the paper's and with logarithmic spacing.

Criteria: precision of positions, separation of columns or pixels.

position: the bound on the distance between touch and estimate, in m, root mean square over the
sheet, for a touch at any position. column, pixel: the distance of the nearest two pixels with
different answers, in the meter's errors, with strengths unknown within the spread of presses. What
all candidates together do not resolve, such as mirror images, is left out.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Integer, Real
from ..bounds.choice import best_choice
from ..bounds.field_choice import AnyFields, fields_of
from ..bounds.frequency_sets import OPTIMAL, candidates_of, compared, too_near
from ..bounds.full_fields import CELLS_PER_PIXEL
from ..bounds.likelihood import in_noise, over_noise
from ..bounds.merits import Candidates, NearestPair, RmsError
from ..bounds.pixel_touches import middles
from ..bounds.position_bound import (
    PlaceLikelihood,
    chosen_touch,
    errors_in_fields,
    pixel_maps,
    place_likelihood,
    places_on,
)
from ..bounds.touch_pairs import pair_likelihood
from ..bounds.touch_rasterizers import RasterizedTouch, TouchSize, rasterizer_for
from ..bounds.touch_readings import Hypothesis, hypotheses
from ..measure.readout import observed
from ..models.reduced.touches import scene_spreads_presses
from ..models.solution import Response
from ..progress import ProgressCallback, silent, tracked
from ..scene.parts import SceneParts
from ..scene.supports import supported
from ..sweeps import InputError
from ..sweeps.units import prefixed

CRITERIA = ("position", "column", "pixel")
MIN_SEPARATION = 1.0
"""Smallest separation, in the meter's errors, that all candidates together must reach."""


def position_criterion(places: PlaceLikelihood) -> Candidates:
    """Frequencies as candidates, by the distance between touch and estimate.

    It uses the coordinates that all candidates together resolve. Raises InputError where there are
    none.
    """
    anywhere, every = np.square(places.room) / 12, places.readings.covariances(2)
    resolved = np.diagonal(every, axis1=1, axis2=2) < anywhere
    if not resolved.any():
        raise InputError("no frequencies resolve the position of a touch")
    readings = places.readings
    return Candidates(readings.by_frequency(), readings.weight, RmsError(resolved, anywhere))


def identity_criterion(
    fields: AnyFields,
    target: str,
    frequency: Real,
    against_rest: int = 0,
    progress: ProgressCallback = silent,
    touch: TouchSize | None = None,
) -> Candidates:
    """Frequencies as candidates, by the distance of the nearest two pixels with different answers.

    touch: around the middle of a pixel, by default the whole pixel as the parts presses it. Raises
    InputError where no pixels are resolved, and for touches of another size on pixels in groups.
    """
    parts = fields.parts
    model = errors_in_fields(fields, frequency, against_rest)
    among = hypotheses(parts.skin, parts.plan, target)
    touch = touch or chosen_touch(parts.skin, parts.plan.press)
    pixels = _pixel_touches(fields, touch)
    answers = [
        _pressed(fields, pixels, each, frequency) for each in tracked(among, "pixels", progress)
    ]
    spread = parts.plan.press.factor_spread * abs(touch.rise)
    middle = over_noise(np.stack([observed(each.Z) for each in answers]), model)
    slopes = np.stack(
        [in_noise(each.Z, [each.by_parameter["strength"]], model) for each in answers]
    )
    different = [
        (one, other)
        for one, other in itertools.combinations(range(len(among)), 2)
        if among[one].answer != among[other].answer
    ]
    pairs = pair_likelihood(
        middle, spread * np.moveaxis(slopes, -1, 1), np.array(different), None, model
    )
    resolved = pairs.covariances(1)[:, 0, 0] < MIN_SEPARATION**-2
    if not resolved.any():
        raise InputError(f"{parts.skin.name}: no frequencies distinguish any two {target}s")
    readings = pairs.cases(resolved)
    return Candidates(readings.by_frequency(), readings.weight, NearestPair())


def _pixel_touches(fields: AnyFields, touch: TouchSize) -> list[RasterizedTouch]:
    """Maps of a touch around the middle of each pixel, or of its whole pixel or group."""
    parts, whole = fields.parts, chosen_touch(fields.parts.skin, fields.parts.plan.press)
    of_its_size = (touch.width, touch.height) == (whole.width, whole.height)
    if not of_its_size:
        supported("touches of a size", parts)
    if parts.skin.pixels.groups is None and (
        scene_spreads_presses(parts.skin, parts.plan.press) or not of_its_size
    ):
        rasterizer = rasterizer_for(parts.skin, parts.plan.press, fields.grid, touch)
        return [rasterizer.rasterized(middle, touch) for middle in middles(parts.skin)]
    maps = pixel_maps(parts.skin, fields.cells).values()
    return [RasterizedTouch(1 + touch.rise * each, {"strength": each}) for each in maps]


def _pressed(
    fields: AnyFields, pixels: Sequence[RasterizedTouch], hypothesis: Hypothesis, frequency: Real
) -> Response:
    """Response to one pressed pixel, with the derivative by its strength."""
    columns, none = fields.parts.skin.pixels.columns, np.zeros(fields.grid)
    own = [pixels[i * columns + j] for i, j in hypothesis.pixels]
    factors = 1 + sum((each.factors - 1 for each in own), none)
    by_strength = sum((each.changes["strength"] for each in own), none)
    return fields.respond(factors, {"strength": by_strength}, frequency)


GRID = 60

MIN_GRID, MAX_GRID = 2, 400

DESIGN_PLACES = 64
"""Approximate number of positions for the choice of frequencies."""


@dataclass(frozen=True)
class FrequencyDesign:
    """Sets of frequencies in Hz by name, OPTIMAL among them, and the figure of each.

    figures: minimized values; in m for position, for column and pixel 1 over the distance in the
    meter's errors. errors: for position, the median error in m of each set, as in `limits`.
    assumptions: text on the touch, the meter and the candidates.
    """

    criterion: str
    sets: dict[str, Real]
    figures: dict[str, float]
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
    """The best n of `candidates_of` a scene in a band in Hz, by a criterion of CRITERIA.

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
        scored, every, np.searchsorted(every, own), n, numbers.values(), repeats, among is None
    )
    chosen = {OPTIMAL: best, **numbers}
    return FrequencyDesign(
        criterion,
        {name: every[k] for name, k in chosen.items()},
        {name: float(scored.score(k[None])[0]) for name, k in chosen.items()},
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
    candidates: Candidates,
    frequency: Real,
    own: Integer,
    n: int,
    others: Iterable[Integer],
    repeats: bool = False,
    spaced: bool = True,
) -> Integer:
    """The best n of the candidates `own`, which are indices of frequencies (Hz, ascending).

    others: further sets from which exchanges start. spaced: True if no two may be `too_near`.
    """
    excludes = too_near(frequency[own], n) if spaced else np.eye(len(own), dtype=bool)
    excludes &= not repeats
    starts = [np.searchsorted(own, k) for k in others if np.isin(k, own).all()]
    return own[best_choice(lambda k: candidates.score(own[k]), len(own), n, starts, excludes)]


def sampled_positions(slopes: PlaceLikelihood) -> PlaceLikelihood:
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
) -> tuple[Candidates, PlaceLikelihood | None]:
    """The candidates and, for position, the likelihood at all positions of `limits`."""
    of_groups = name != "position" and parts.skin.pixels.groups is not None
    cells = 1 if of_groups else None
    fields = fields_of(parts, float(candidates[-1]), touch, cells)
    if name != "position":
        return identity_criterion(fields, name, candidates, against_rest, progress, touch), None
    places = places_on(parts.skin, touch, CELLS_PER_PIXEL)
    slopes = place_likelihood(
        fields, places, touch, candidates, against_rest=against_rest, progress=progress
    )
    return position_criterion(sampled_positions(slopes)), slopes

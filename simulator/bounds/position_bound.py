"""Cramér and Rao's bound on position and strength of a touch from one sweep.

A touch is a rectangle of known size at any position. The unknowns are x, y and its strength, which
is the rise of capacitance over the unpressed one, and for a finger its capacitance to earth. The
meter's errors of the session are unknown too and, as an option, the skin within the spread of
[dataset.session].
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Complex, Integer, Mask, Real
from ..measure.readout import ErrorModel
from ..mesh.pixel_coverage import pixel_coverage
from ..models.session_spreads import session_spreads
from ..models.solution import Response
from ..press.batch import PressBatch
from ..press.finger import finger_over
from ..progress import ProgressCallback, silent, tracked
from ..scene.parts import Pressing, Skin
from ..sweeps import InputError
from .field_choice import AnyFields
from .likelihood import LinearLikelihood, error_model, in_noise
from .rasterization_errors import RasterizationErrors, rasterization_errors, sample_indices
from .touch_rasterizers import AreaRasterizer, DepthRasterizer, Point, TouchSize, rasterizer_for

ESTIMATED = ("x", "y", "strength")
MIN_SHARE = 1 - 1e-6


@dataclass(frozen=True)
class PositionBounds:
    """Smallest standard deviations of unbiased estimates, infinite where nothing is resolved.

    places: (x, y) in m, shape (place, 2). x, y: m; strength: over the unpressed capacitance; shape
    (place,). correlation: of errors of x and y, shape (place,). room: see `PlaceLikelihood`.
    """

    places: Real
    x: Real
    y: Real
    strength: Real
    correlation: Real
    room: tuple[float, float]

    def median_error(self, draws: int = 256, seed: int = 0) -> float:
        """Median error in m over all positions, for normal errors with the bound's deviations.

        A coordinate that is not resolved has the standard deviation of a guess over its range.
        """
        first, second = np.random.default_rng(seed).standard_normal((2, draws, len(self.places)))
        along = np.sqrt(1 - self.correlation**2) * second + self.correlation * first
        x, y = (
            np.minimum(own, length / math.sqrt(12))
            for own, length in zip((self.x, self.y), self.room, strict=True)
        )
        return float(np.median(np.hypot(x * first, y * along)))


@dataclass(frozen=True)
class PlaceLikelihood:
    """Readings of touches at positions, linear in the unknowns of a touch and of the skin.

    places: m, shape (place, 2). readings: ESTIMATED are the first unknowns, then a finger's
    capacitance. frequency: Hz. room: range of the middle of a touch along x and y, m; a deviation
    above it resolves nothing.
    """

    places: Real
    readings: LinearLikelihood
    frequency: Real
    room: tuple[float, float]

    def bounds(
        self,
        frequencies: Real | None = None,
        interfaces: Sequence[int] | None = None,
        taken: Mask | None = None,
    ) -> PositionBounds:
        """Bounds for sweeps at some of the frequencies, in Hz, and some of the interfaces.

        taken: True where an interface is read at a frequency, shape (interface, frequency); None:
        everywhere.
        """
        numbers = None if frequencies is None else self.number(frequencies).tolist()
        covariance = self.readings.some(interfaces, numbers, taken).covariances(len(ESTIMATED))
        spread = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
        x, y = (np.where(spread[:, k] < self.room[k], spread[:, k], np.inf) for k in (0, 1))
        resolved = np.isfinite(x) & np.isfinite(y)
        both = np.where(resolved, spread[:, 0] * spread[:, 1], 1.0)
        correlation = np.where(resolved, covariance[:, 0, 1] / both, 0.0)
        return PositionBounds(
            self.places, x, y, spread[:, 2], np.clip(correlation, -1.0, 1.0), self.room
        )

    def some(self, step: int) -> PlaceLikelihood:
        """The likelihood at every `step`-th position."""
        every = slice(None, None, step)
        return replace(self, places=self.places[every], readings=self.readings.cases(every))

    def number(self, frequencies: Real) -> Integer:
        """Indices of these frequencies."""
        return np.searchsorted(self.frequency, frequencies)


def chosen_touch(
    skin: Skin, pressing: Pressing, size: float | None = None, factor: float | None = None
) -> TouchSize:
    """A touch of the size of a pixel, or a square of `size` in m; factor: default the scene's.

    Raises InputError where it is larger than the skin or does not change the capacitance.
    """
    pixels = skin.pixels
    width, height = skin.length / pixels.columns, skin.width / pixels.rows
    if size is not None:
        if not 0 < size <= min(skin.length, skin.width):
            raise InputError(
                f"--size must be > 0 and <= {1e3 * min(skin.length, skin.width):g} mm, "
                f"got {1e3 * size:g}"
            )
        width = height = size
    factor = pressing.factor(skin) if factor is None else factor
    how = pressing.finger
    finger = float(finger_over(skin, np.array(width * height), how)) if how else 0.0
    if not (np.isfinite(factor) and factor > 0 and (factor != 1 or finger)):
        alone = " without a finger in `press.finger`" if factor == 1 else ""
        raise InputError(f"--factor must be finite, > 0 and not 1{alone}, got {factor:g}")
    return TouchSize(width, height, factor - 1, finger)


def places_on(
    skin: Skin, touch: TouchSize, cells: int, max_places: int | None = None
) -> list[Point]:
    """Middles of touches inside the skin: the middles of cells, at most `most` on each side.

    Where no cell fits along a side, it is the middle of the skin. Other outlines: see `_on_skin`.
    """
    grid = skin.grid(cells)
    x = _along(skin.length, grid[1], touch.width, max_places)
    y = _along(skin.width, grid[0], touch.height, max_places)
    places = [(each, other) for other in y for each in x]
    return places if skin.rectangular else _on_skin(skin, places, touch, grid)


def _on_skin(
    skin: Skin, places: Sequence[Point], touch: TouchSize, grid: tuple[int, int]
) -> list[Point]:
    """The positions whose cells are all skin; where there is none, those with most skin."""
    part = pixel_coverage(skin, grid).part.reshape(grid)
    cells = AreaRasterizer.of(skin, grid)
    covers = [cells.raised(place, touch)["strength"] for place in places]
    shares = np.array([(each * part).sum() / each.sum() for each in covers])
    whole = shares >= min(MIN_SHARE, shares.max())
    return [place for place, kept in zip(places, whole.tolist(), strict=True) if kept]


def place_likelihood(
    fields: AnyFields,
    places: Sequence[Point],
    touch: TouchSize,
    frequency: Real,
    *,
    against_rest: int = 0,
    unknown_skin: bool = False,
    progress: ProgressCallback = silent,
    rasterizer: AreaRasterizer | DepthRasterizer | None = None,
    model: ErrorModel | None = None,
) -> PlaceLikelihood:
    """Likelihood at every position, for all interfaces at all frequencies, in Hz, ascending.

    against_rest: number of baseline sweeps that the sweep is compared with, 0 for none.
    unknown_skin: True if the skin is unknown too. rasterizer: of touches, by default
    `rasterizer_for`. model: error model, needed where not all interfaces are read at all
    frequencies. Raises InputError for a meter without noise, and as the rasterizer does.
    """
    parts = fields.parts
    model = model or errors_in_fields(fields, frequency, against_rest)
    skin = SkinUnknowns(fields, frequency, model) if unknown_skin else None
    rasterizer = rasterizer or rasterizer_for(parts.skin, parts.plan.press, fields.grid, touch)
    cells = AreaRasterizer.of(parts.skin, fields.grid)
    unknown = (*ESTIMATED, "finger") if touch.finger else ESTIMATED
    found = []
    for place in tracked(places, "places", progress):
        factors, changes = cells.with_finger(rasterizer.rasterized(place, touch), place, touch)
        of_foam = skin.maps(factors) if skin else None
        answer = fields.respond(factors, changes, frequency, of_foam)
        own = in_noise(answer.Z, [answer.by_parameter[name] for name in unknown], model)
        found.append(np.concatenate([own, *([skin.slopes(answer)] if skin else [])], -1))
    prior = np.concatenate([np.zeros(len(unknown)), *([skin.prior] if skin else [])])
    room = parts.skin.length - touch.width, parts.skin.width - touch.height
    readings = LinearLikelihood.of_cases(np.stack(found), model, prior)
    return PlaceLikelihood(np.array(places), readings, frequency, room)


def errors_in_fields(fields: AnyFields, frequency: Real, against_rest: int = 0) -> ErrorModel:
    """Errors of all interfaces at all frequencies, Hz, evaluated at the unpressed skin."""

    def unpressed() -> Complex:
        return fields.respond(np.ones(fields.grid), {}, frequency).Z

    return error_model(fields.parts.setup, fields.parts.meter, frequency, against_rest, unpressed)


def errors_of_places(
    fields: AnyFields, places: Sequence[Point], touch: TouchSize
) -> RasterizationErrors | None:
    """Errors of touches rasterized on cells, at a sample of positions.

    None where presses are factors, which end at their edges. Raises as `rasterization_errors` does.
    """
    parts = fields.parts
    rasterizer = rasterizer_for(parts.skin, parts.plan.press, fields.grid, touch)
    if not isinstance(rasterizer, DepthRasterizer):
        return None
    sample = [places[k] for k in sample_indices(len(places))]
    own = np.stack([rasterizer.rasterized(place, touch).factors.ravel() for place in sample]) - 1

    def impedances(batch: PressBatch) -> Complex:
        found = []
        for cells, rises in batch.each():
            factors = np.ones(fields.grid)
            factors.flat[cells] += rises
            found.append(fields.respond(factors, {}, parts.setup.frequency).Z)
        return np.stack(found)

    each = [rasterizer.applied(place, touch.rise, beyond=0.0) for place in sample]
    return rasterization_errors(
        parts, rasterizer.lattice, each, PressBatch.on_grid(own), impedances
    )


class SkinUnknowns:
    """The skin's parameters and the foam of every pixel as unknowns with priors."""

    def __init__(self, fields: AnyFields, frequency: Real, model: ErrorModel) -> None:
        parts = fields.parts
        self._model, self._pixels = model, pixel_maps(parts.skin, fields.cells)
        ones = np.ones(fields.grid)
        self._unpressed = fields.respond(ones, {}, frequency, self.maps(ones))
        self.deviations = {
            name: spread.deviation
            for name, spread in session_spreads(parts).items()
            if spread.deviation > 0 and name in self._unpressed.by_parameter
        }
        if spread := parts.plan.draws.session.foam_spread:
            self.deviations |= dict.fromkeys(self._pixels, spread)
        self.prior = np.array([1 / each**2 for each in self.deviations.values()])

    def maps(self, factors: Real) -> dict[str, Real]:
        """Change of c with the foam of each pixel; fingers do not change with it."""
        of_foam = factors if factors.ndim == 2 else factors * np.array([1.0, 0.0])[:, None, None]
        return {name: pixel * of_foam for name, pixel in self._pixels.items()}

    def slopes(self, answer: Response) -> Real:
        """Slopes of a press, minus those of the baseline where one is subtracted."""
        found = self._in_noise(answer)
        return found - self._in_noise(self._unpressed) if self._model.against_rest else found

    def _in_noise(self, answer: Response) -> Real:
        return in_noise(
            answer.Z, [answer.by_parameter[name] for name in self.deviations], self._model
        )


def _along(length: float, cells: int, size: float, max_places: int | None) -> list[float]:
    middles = (np.arange(cells) + 0.5) * length / cells
    rounding = 1e-9 * length
    fitting = middles[(middles >= size / 2 - rounding) & (middles <= length - size / 2 + rounding)]
    if not fitting.size:
        return [length / 2]
    if max_places is not None and fitting.size > max_places:
        fitting = fitting[
            np.unique(np.linspace(0, fitting.size - 1, max_places).round().astype(int))
        ]
    return fitting.tolist()


def pixel_maps(skin: Skin, cells: int) -> dict[str, Real]:
    """Map of each pixel on a grid with `cells` along each of its sides, (row, column) of cells."""
    rows, columns = skin.pixels.rows, skin.pixels.columns
    units = np.eye(rows * columns).reshape(-1, rows, columns)
    return {
        f"foam {k}": np.kron(unit, np.ones((cells, cells))).astype(np.float64)
        for k, unit in enumerate(units)
    }

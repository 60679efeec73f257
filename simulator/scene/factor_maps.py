"""Maps of factors: a grid, a formula, a random field, or a tear of a sheet."""

from __future__ import annotations

from functools import lru_cache
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from ..arrays import Integer, Real
from .planar import NO_LINES, Lines
from .ranges import Length, MapFactor, Seed, Slope
from .validation import Number, Table, by_kind, within

GAP = 6.0
"""Period beyond the side over the correlation length: opposite edges correlate by 1.5e-8."""

BAND = 5.0
"""Largest wave number times l; the neglected modes have 6e-7 of the variance per axis."""

AT_ONCE = 2**12


def random_field(x: Real, sides: tuple[float, float], correlation_length: float, seed: int) -> Real:
    """Random field of mean 0 and variance 1 at positions x in m, shape (2, ...) to (...).

    sides: of the rectangle, m. A seed always gives the same field, at any positions.
    """
    points = np.asarray(x, dtype=np.float64).reshape(2, -1)
    modes = [_modes(side, correlation_length) for side in sides]
    amplitudes = _amplitudes(seed, *(2 * len(k) for k, _ in modes))
    field = np.empty(points.shape[1])
    for start in range(0, points.shape[1], AT_ONCE):
        part = np.s_[start : start + AT_ONCE]
        along, across = (_basis(at[part], *mode) for at, mode in zip(points, modes, strict=True))
        field[part] = np.einsum("jp,jp->p", amplitudes.T @ along, across)
    return field.reshape(np.shape(x)[1:])


def _modes(side: float, length: float) -> tuple[Real, Real]:
    """Wave numbers on the torus in rad/m, and their fractions of the variance (sum 1)."""
    period = side + GAP * length
    k = 2 * np.pi / period * np.arange(np.ceil(BAND * period / (2 * np.pi * length)) + 1)
    density = np.where(k > 0, 2.0, 1.0) * np.exp(-((k * length) ** 2) / 2)
    return k, density / density.sum()


def _basis(x: Real, k: Real, share: Real) -> Real:
    """Cosines, then sines of every mode, scaled by its fraction; shape (2 * mode, point).

    They are computed as powers of the first mode; the hundredth has a hundred rounding errors.
    """
    turned = np.empty((len(k), len(x)), dtype=np.complex128)
    turned[0], turned[1:] = 1.0, np.exp(1j * k[1] * x)
    np.cumprod(turned, axis=0, out=turned)
    turned *= np.sqrt(share)[:, None]
    return np.concatenate([turned.real, turned.imag])


@lru_cache(maxsize=32)
def _amplitudes(seed: int, along: int, across: int) -> Real:
    return np.random.default_rng(seed).standard_normal((along, across))


MAX_VALUES = 128
"""Largest number of values of a grid along each axis."""

SHORTEST = 0.02
"""Smallest correlation length over the skin's longer side; finer fields need another mesh."""

MAX_NORMAL_DEVIATION, MIN_FACTOR = 0.3, 0.05
"""Largest deviation of a normally distributed factor, and its smallest allowed value."""

SAMPLES_PER_LENGTH = 4
"""Sample points per correlation length; between them the field falls by at most 0.02."""

Factor = MapFactor

Sides = tuple[float, float]
"""Length and width of the unstretched skin, m."""


class FactorMap(Table):
    """Base of all maps; the defaults are for maps without kinks and without a shortest length."""

    @property
    def uniform(self) -> float | None:
        """The factor of a constant map; None if the map varies."""
        raise NotImplementedError

    def factors(self, x: Real, sides: Sides) -> Real:
        """Factors at positions x in m, shape (2, ...) to (...)."""
        raise NotImplementedError

    def kinks(self, sides: Sides) -> Lines:
        """Lines across x and y, in m, at which the slope jumps."""
        return NO_LINES

    def shortest(self, sides: Sides) -> float:
        """Shortest length over which the map varies, m."""
        return np.inf

    def details(self, sides: Sides) -> Real:
        """Points in m that show what a coarse grid of points may miss, shape (2, point)."""
        return np.zeros((2, 0))

    def check(self, sides: Sides) -> None:
        """Raises ValueError if the map does not fit a skin with these sides."""


class Constant(FactorMap):
    """One factor everywhere.

    value: the factor.
    """

    kind: Literal["constant"] = "constant"
    value: Factor

    @property
    def uniform(self) -> float | None:
        return self.value

    def factors(self, x: Real, sides: Sides) -> Real:
        return np.full(np.shape(x)[1:], self.value)


class Gradient(FactorMap):
    """A linear map with the factor `middle` in the middle of the skin.

    x: rise of the factor from the left edge to the right. y: rise of the factor from the bottom
    edge to the top. middle: factor in the middle.
    """

    kind: Literal["gradient"] = "gradient"
    x: Slope = 0.0
    y: Slope = 0.0
    middle: Factor = 1.0

    @property
    def uniform(self) -> float | None:
        return None if self.x or self.y else self.middle

    def factors(self, x: Real, sides: Sides) -> Real:
        length, width = sides
        return self.middle + self.x * (x[0] / length - 0.5) + self.y * (x[1] / width - 0.5)

    def shortest(self, sides: Sides) -> float:
        return np.inf if self.uniform is not None else min(sides)

    @model_validator(mode="after")
    def _positive_at_all_corners(self) -> Self:
        lowest = self.middle - (abs(self.x) + abs(self.y)) / 2
        if not lowest > 0:
            raise ValueError(
                "x and y must leave the factor > 0 at every corner: |x| + |y| < "
                f"{2 * self.middle:g}, got {abs(self.x) + abs(self.y):g}"
            )
        return self


class Random(FactorMap):
    """A smooth random field of mean 1 with a relative standard deviation.

    deviation: relative standard deviation. correlation_length [m]: l of exp(-r² / (2 l²)).
    distribution: of the factor; a normal one is refused if it falls below 0.05 anywhere. seed: of
    the random numbers; equal seeds give equal fields.
    """

    kind: Literal["random"] = "random"
    deviation: Annotated[Number, within(0.0, 1.0, "(relative)", "more is no uniform material")]
    correlation_length: Length
    distribution: Literal["lognormal", "normal"] = "lognormal"
    seed: Seed = 1

    @property
    def uniform(self) -> float | None:
        return None if self.deviation else 1.0

    def factors(self, x: Real, sides: Sides) -> Real:
        field = random_field(x, sides, self.correlation_length, self.seed)
        if self.distribution == "normal":
            return 1 + self.deviation * field
        variance = np.log1p(self.deviation**2)
        return np.exp(np.sqrt(variance) * field - variance / 2)

    def shortest(self, sides: Sides) -> float:
        return self.correlation_length if self.deviation else np.inf

    def check(self, sides: Sides) -> None:
        smallest = SHORTEST * max(sides)
        if not self.correlation_length >= smallest:
            raise ValueError(
                f"correlation_length must be >= {smallest:g} m, {SHORTEST:g} of the skin's longer "
                f"side, got {self.correlation_length:g}"
            )
        if self.distribution == "normal":
            self._check_positive(sides)

    def _check_positive(self, sides: Sides) -> None:
        always = 'distribution = "lognormal" is always positive'
        if self.deviation > MAX_NORMAL_DEVIATION:
            raise ValueError(
                f"deviation must be <= {MAX_NORMAL_DEVIATION:g} for a normal factor, got "
                f"{self.deviation:g}; {always}"
            )
        lowest = 1 + self.deviation * _field_minimum(sides, self.correlation_length, self.seed)
        if lowest < MIN_FACTOR:
            raise ValueError(
                f"deviation must leave the factor >= {MIN_FACTOR:g} everywhere, got "
                f"{self.deviation:g} and a factor of {lowest:.2g}; {always}"
            )


@lru_cache(maxsize=64)
def _field_minimum(sides: Sides, correlation_length: float, seed: int) -> float:
    """Minimum of the field on a fine grid over the skin."""
    counts = [int(np.ceil(SAMPLES_PER_LENGTH * side / correlation_length)) + 1 for side in sides]
    lines = (np.linspace(0, side, count) for side, count in zip(sides, counts, strict=True))
    return float(random_field(np.stack(np.meshgrid(*lines)), sides, correlation_length, seed).min())


def _values(rows: tuple[tuple[float, ...], ...]) -> tuple[tuple[float, ...], ...]:
    if not rows or not rows[0] or len({len(row) for row in rows}) > 1:
        raise ValueError("must be rows of equally many values")
    if max(len(rows), len(rows[0])) > MAX_VALUES:
        raise ValueError(
            f"must be at most {MAX_VALUES} x {MAX_VALUES}, got {len(rows)} x {len(rows[0])}"
        )
    return rows


class Grid(FactorMap):
    """Factors by row and column, row 1 along the bottom edge, column 1 along the left one.

    The first and last values lie on the edges, the others at equal distances, and between four of
    them the map is bilinear. The error for a smooth map is O(h²) everywhere; values at the centres
    of cells would give O(h) along the edges. values: factors of row 1, of row 2, and so on.
    """

    kind: Literal["grid"] = "grid"
    values: Annotated[tuple[tuple[Factor, ...], ...], AfterValidator(_values)]

    @property
    def uniform(self) -> float | None:
        first = self.values[0][0]
        return first if all(value == first for row in self.values for value in row) else None

    def factors(self, x: Real, sides: Sides) -> Real:
        """Factors at positions x; beyond the edges those on the edges."""
        values = np.array(self.values)
        (low, right), (row, up) = (
            _between(at, side, count)
            for at, side, count in zip(x, sides, values.shape[::-1], strict=True)
        )
        next_low = np.minimum(low + 1, values.shape[1] - 1)
        next_row = np.minimum(row + 1, values.shape[0] - 1)
        below = (1 - right) * values[row, low] + right * values[row, next_low]
        above = (1 - right) * values[next_row, low] + right * values[next_row, next_low]
        return (1 - up) * below + up * above

    def kinks(self, sides: Sides) -> Lines:
        across_x = np.linspace(0, sides[0], max(len(self.values[0]), 2))
        across_y = np.linspace(0, sides[1], max(len(self.values), 2))
        return tuple(across_x[1:-1].tolist()), tuple(across_y[1:-1].tolist())

    def shortest(self, sides: Sides) -> float:
        counts = len(self.values[0]), len(self.values)
        steps = [side / (n - 1) for side, n in zip(sides, counts, strict=True) if n > 1]
        return min(steps, default=np.inf)


def _between(at: Real, side: float, count: int) -> tuple[Integer, Real]:
    """Index of the value before each position along a side, and the fraction to the next."""
    steps = np.clip(np.asarray(at) / side, 0, 1) * (count - 1)
    before = np.minimum(steps.astype(np.int64), max(count - 2, 0))
    return before, steps - before


AnyMap = Constant | Gradient | Random | Grid


def refuse_file(given: object) -> object:
    """The given table. Raises ValueError if it is a map of the kind "file"."""
    if isinstance(given, dict) and given.get("kind") == "file":
        raise ValueError("of the kind 'file' is read only together with a scene file")
    return given


Map = Annotated[
    AnyMap,
    by_kind(Constant, Gradient, Random, Grid, elsewhere="file"),
    BeforeValidator(refuse_file),
]


TORN = 1e9
"""Sheet resistance within a tear over that around it. Across a gap of 0.1 mm it leaves the current
at 1 kHz below 1e-3 of that through the foam beyond."""

GRADING, FINEST, WIDEST = 4.0, -1, 12
"""Ratio of the distances of lines from the gap, and powers of it for the nearest and the farthest
of them, in widths. The field is singular at the end of the gap."""

NEAR = 1e-3
"""Distance of `details` from the corners of the gap, over its half size."""

SAME = 1e-12
"""Distance in m below which two lines are one."""


class Tear(FactorMap):
    """A straight cut of a sheet from an edge inwards; no current flows across it.

    edge: where it begins. at: place along that edge, as a fraction from its low-coordinate end.
    length: over the skin's side, 1 for a cut to the opposite edge. width [m]: of the gap, in which
    the sheet does not conduct.
    """

    kind: Literal["tear"] = "tear"
    edge: Literal["left", "right", "bottom", "top"]
    at: Annotated[Number, Field(gt=0, lt=1)]
    length: Annotated[Number, Field(gt=0, le=1)]
    width: Length = 1e-4

    @property
    def uniform(self) -> float | None:
        return None

    def factors(self, x: Real, sides: Sides) -> Real:
        (left, right), (low, high) = self._gap(sides)
        torn = (x[0] > left) & (x[0] < right) & (x[1] > low) & (x[1] < high)
        return np.where(torn, TORN, 1.0)

    def kinks(self, sides: Sides) -> Lines:
        """Limits of the gap, and lines that narrow towards them, in m."""
        along, across = (
            self._graded(ends, side) for ends, side in zip(self._gap(sides), sides, strict=True)
        )
        return along, across

    def details(self, sides: Sides) -> Real:
        """Points on both sides of the four corners of the gap."""
        corners = np.stack([each.ravel() for each in np.meshgrid(*self._gap(sides))])
        middle = corners.mean(axis=1, keepdims=True)
        return np.hstack([middle + scale * (corners - middle) for scale in (1 - NEAR, 1 + NEAR)])

    def check(self, sides: Sides) -> None:
        along = sides[self.edge in ("left", "right")]
        least = self.width / along
        if not least < self.at < 1 - least:
            raise ValueError(
                f"at must be from {least:.3g} to {1 - least:.3g}, so that the gap of {self.width:g}"
                f" m is on the skin, got {self.at:g}"
            )

    def _gap(self, sides: Sides) -> tuple[tuple[float, float], tuple[float, float]]:
        """Limits of the gap along x and along y, m."""
        vertical = self.edge in ("bottom", "top")
        along, side = sides if vertical else sides[::-1]
        middle, cut = self.at * along, self.length * side
        gap = middle - self.width / 2, middle + self.width / 2
        inwards = (0.0, cut) if self.edge in ("left", "bottom") else (side - cut, side)
        return (gap, inwards) if vertical else (inwards, gap)

    def _graded(self, ends: tuple[float, float], side: float) -> tuple[float, ...]:
        """Lines at and around those ends that lie within the skin, ascending, m."""
        inside = [end for end in ends if SAME < end < side - SAME]
        steps = self.width * GRADING ** np.arange(FINEST, WIDEST)
        lines = [line for end in inside for line in (end, *(end - steps), *(end + steps))]
        kept = sorted(line for line in lines if SAME < line < side - SAME)
        apart = [k for k, line in enumerate(kept) if not k or line - kept[k - 1] > SAME]
        return tuple(kept[k] for k in apart)


SheetMap = Annotated[
    AnyMap | Tear,
    by_kind(Constant, Gradient, Random, Grid, Tear, elsewhere="file"),
    BeforeValidator(refuse_file),
]

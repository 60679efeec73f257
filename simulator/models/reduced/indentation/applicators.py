"""Every pixel of a skin as an applicator: deflections under and next to it by its depth.

On a rectangle, pixels in equivalent positions relative to its edges share one depth series.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ....arrays import Integer, Real
from ....press.pixels import pixels_with_skin
from ....press.touch import Touch
from ....scene.foam.foam_mechanics import REACH_OF_APPLICATORS, Mechanics
from ....scene.parts import Skin

if TYPE_CHECKING:
    from ...mechanics.depth_series import DepthSeries

FACTOR_SHARE, COARSEST = 30.0, 1e-2
"""Largest error of a factor over the tolerance of Rs and Cp, and its maximum. It occurs only at
corners."""
DEPTH_SHARE = 0.1
"""Interpolation between depths may leave this share of the tolerance as error of the factor."""
NEGLIGIBLE = 0.1
"""Deflections count as 0 below this share of the tolerance times the applicator's deflection."""


@dataclass(frozen=True)
class PixelApplicators:
    """Deflections by all pixels of a scene as applicators.

    of_pixel: number of each pixel's depth series, -1 without skin, shape (pixel,). turn, shift: a
    position x on the skin is x turn + shift in the depth series' own coordinates, shape (pixel, 2).
    far: distance beyond which an applicator has no effect, m.
    """

    skin: Skin
    all_series: tuple[DepthSeries, ...]
    of_pixel: Integer
    turn: Real
    shift: Real
    far: float

    @property
    def mechanics(self) -> Mechanics:
        """Mechanics of the foam."""
        assert self.skin.foam.mechanics is not None
        return self.skin.foam.mechanics

    @property
    def thickness(self) -> float:
        """Thickness of the foam, m."""
        assert self.skin.foam.thickness is not None
        return self.skin.foam.thickness

    @cached_property
    def deepest(self) -> float:
        """Largest depth, m."""
        return deepest(self.skin)

    def depth(self, rises: Real) -> Real:
        """Depth in m at which the factor under an applicator is 1 + rises."""
        strain = self.mechanics.strain_at(1 + np.asarray(rises, dtype=np.float64))
        return np.minimum(strain * self.thickness, self.deepest)

    def depth_series_of(self, pixel: int) -> DepthSeries:
        """Depth series of a pixel with skin."""
        return self.all_series[self.of_pixel[pixel]]

    def rises(self, pixel: int, x: Real) -> tuple[Real, Real]:
        """`DepthSeries.factors` of one pixel, at positions x (2, point) on the skin in m."""
        own = self.turn[pixel][:, None] * x + self.shift[pixel][:, None]
        return self.depth_series_of(pixel).factors(own, self.mechanics, self.thickness)

    def deflection(self, pixel: int, depth: float, x: Real) -> Real:
        """Deflection by one applicator at a depth in m, at positions x (2, point) on the skin,
        m."""
        own, series = (
            self.turn[pixel][:, None] * x + self.shift[pixel][:, None],
            self.depth_series_of(pixel),
        )
        found = np.zeros(x.shape[1])
        low, high = series.reach(self.far)
        there = ((own >= low[:, None]) & (own <= high[:, None])).all(axis=0)
        found[there] = series.deflection(depth, own[:, there])
        return found


def deepest(skin: Skin) -> float:
    """Largest depth of a scene's applicators, m."""
    mechanics, thickness = skin.foam.mechanics, skin.foam.thickness
    assert mechanics is not None and thickness is not None
    return REACH_OF_APPLICATORS * mechanics.elastic.greatest_strain * thickness


def applicators(skin: Skin, rtol: float) -> PixelApplicators:
    """Applicators on all pixels; the scene's foam has mechanics and its skins have tension.

    rtol: tolerance of Rs and Cp. Raises what `depth_series` raises.
    """
    rows, columns = skin.pixels.shape
    count, lengths = rows * columns, np.array(skin.sides)
    of_pixel, turn, shift = np.full(count, -1), np.ones((count, 2)), np.zeros((count, 2))
    known: dict[tuple[int, int], int] = {}
    assert skin.foam.mechanics is not None and skin.foam.thickness is not None
    spread = skin.foam.mechanics.spread(skin.foam.thickness)
    far = spread * math.log(1 / (NEGLIGIBLE * rtol))
    for row, column in pixels_with_skin(skin):
        pixel, place = (row - 1) * columns + column - 1, (column - 1, row - 1)
        equivalent = place
        if skin.rectangular:
            pitch = lengths / (columns, rows)
            equivalent = (
                _equivalent_index(place[0], columns, pitch[0], far),
                _equivalent_index(place[1], rows, pitch[1], far),
            )
            flipped = [k > n - 1 - k for k, n in zip(place, (columns, rows), strict=True)]
            nearest = [min(k, n - 1 - k) for k, n in zip(place, (columns, rows), strict=True)]
            turn[pixel] = np.where(flipped, -1.0, 1.0)
            moved = (np.array(equivalent) - nearest) * pitch
            shift[pixel] = np.where(flipped, lengths, 0.0) + moved
        of_pixel[pixel] = known.setdefault(equivalent, len(known))
    found = [_computed_series(skin, place, rtol) for place in known]
    return PixelApplicators(skin, tuple(found), of_pixel, turn, shift, far)


def _computed_series(skin: Skin, place: Sequence[int], rtol: float) -> DepthSeries:
    from ...mechanics.depth_series import depth_series

    column, row = place
    factor_rtol = min(COARSEST, FACTOR_SHARE * rtol)
    pixel = Touch(row + 1, column + 1, 1.0)
    return depth_series(skin, pixel, deepest(skin), factor_rtol, DEPTH_SHARE * rtol)


def _equivalent_index(index: int, count: int, pitch: float, far: float) -> int:
    """Smallest index in an equivalent position relative to both ends of a row.

    far: distance beyond which an end has no effect, m.
    """
    nearest = min(index, count - 1 - index)
    enough = int(np.ceil(far / pitch))
    if count - 1 - nearest < enough:
        return nearest
    return min(nearest, enough)

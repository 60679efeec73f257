"""Materials of a skin at any position: conductance, capacitance, stretch.

Symmetric 2x2 tensors are given as (xx, yy, xy), shape (3, ...).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import Real
from ...scene.foam_mechanics import strain_of
from ...scene.form import Stretch
from ...scene.parts import Skin
from ...scene.planar import SAME_EDGE, Lines, distinct
from ...scene.skin import Electrode, Sheet, SheetsAndFoam


@dataclass(frozen=True)
class Metric:
    """G = F'F of the tangents F = d(position)/d(flat x), as (xx, yy, xy), shape (3, ...).

    area: J = sqrt(det G), area over that of the flat, unstretched skin, shape (...).
    """

    G: Real
    area: Real


def position(skin: Skin, x: Real) -> Real:
    """Position in space, m, of points x in m of the flat, unstretched skin, shape (2, ...) to (3,
    ...)."""
    stretched = _ratios(skin, x) * np.asarray(x)
    if skin.shape is None:
        return np.stack([*stretched, np.zeros(np.shape(x)[1:])])
    return skin.shape.position(stretched, skin.stretched_sides)


def tangents(skin: Skin, x: Real) -> Real:
    """Derivative of `position` by x, shape (3, 2, ...)."""
    ratios = _ratios(skin, x)
    if skin.shape is None:
        flat = np.eye(3, 2).reshape((3, 2) + (1,) * (np.ndim(x) - 1))
        return np.broadcast_to(flat * ratios, (3, 2, *np.shape(x)[1:]))
    return skin.shape.tangents(ratios * np.asarray(x), skin.stretched_sides) * ratios


def metric(skin: Skin, x: Real) -> Metric:
    """Metric at points x in m of the flat, unstretched skin, shape (2, ...)."""
    F = tangents(skin, x)
    xx, yy, xy = (
        np.einsum("i...,i...->...", F[:, i], F[:, j]) for i, j in ((0, 0), (1, 1), (0, 1))
    )
    return Metric(np.stack([xx, yy, xy]), np.sqrt(xx * yy - xy**2))


def isometric(skin: SheetsAndFoam) -> bool:
    """True if all lengths within the skin are those of the flat, unstretched skin."""
    unstretched = skin.stretch is None or skin.stretch.ratios == (1.0, 1.0)
    return unstretched and (skin.shape is None or skin.shape.developable)


def _ratios(skin: SheetsAndFoam, x: Real) -> Real:
    ratios = skin.stretch.ratios if skin.stretch else (1.0, 1.0)
    return np.reshape(ratios, (2,) + (1,) * (np.ndim(x) - 1))


def directed(ratio: float, angle: float) -> Real:
    """Tensor of determinant 1, `ratio` times as large along `angle` [rad] from x as across, shape
    (3,)."""
    along, across = ratio**0.5, ratio**-0.5
    mean, half, turned = (along + across) / 2, (along - across) / 2, 2 * angle
    part = half * np.cos(turned)
    return np.array([mean + part, mean - part, half * np.sin(turned)])


def root(G: Real, determinant: Real) -> Real:
    """U = sqrt(G) of that determinant: (G + det U) / sqrt(tr G + 2 det U), by Cayley-Hamilton."""
    xx, yy, xy = G
    scale = 1 / np.sqrt(xx + yy + 2 * determinant)
    return scale * np.stack([xx + determinant, yy + determinant, xy])


def adjugate(U: Real) -> Real:
    """det(U) times the inverse of U."""
    xx, yy, xy = U
    return np.stack([yy, xx, -xy])


def between(B: Real, A: Real) -> Real:
    """B A B."""
    (bx, by, b), (ax, ay, a) = B, A
    return np.stack(
        [
            bx * bx * ax + 2 * bx * b * a + b * b * ay,
            b * b * ax + 2 * b * by * a + by * by * ay,
            bx * b * ax + (bx * by + b * b) * a + b * by * ay,
        ]
    )


SLOPE_STEP = 1e-5
ISOTROPIC = np.array([1.0, 1.0, 0.0])


def gauged(skin: SheetsAndFoam) -> bool:
    """True if a press changes a sheet's resistance."""
    return any(sheet.piezoresistance for sheet in (skin.top, skin.bottom))


def gauges(skin: SheetsAndFoam, factors: Real) -> Real:
    """Conductance of top and bottom over the unpressed one, under touches of these factors.

    factors: capacitance over the unpressed one, shape (...). Returns shape (2, ...).
    """
    mechanics = skin.foam.mechanics
    strain = np.asarray(mechanics.strain_at(factors) if mechanics else strain_of(factors))
    return np.stack([1 / (1 + each.piezoresistance * strain) for each in (skin.top, skin.bottom)])


def gauge_slopes(skin: SheetsAndFoam, factors: Real) -> Real:
    """Derivative of `gauges` by the factors, to six digits; shape (2, ...)."""
    step = SLOPE_STEP * factors
    return (gauges(skin, factors + step) - gauges(skin, factors - step)) / (2 * step)


class Materials:
    """Conductances and capacitance of a scene's skin at any points x, flat and in m."""

    def __init__(self, skin: Skin) -> None:
        self.skin = skin
        self._isometric = isometric(skin)
        self._sheet_power, self._foam_power = (skin.stretch or Stretch()).thinning

    def conductance(self, electrode: Electrode, x: Real, strain: ArrayLike = 0.0) -> Real:
        """Conductance of an electrode as (xx, yy, xy) in S, shape (3, ...), at x of shape (2, ...).

        strain: compressive strain of the foam there, which broadcasts with (...), see `strain_of`.
        """
        sheet = self.skin.sheet(electrode)
        R = self._resistance(sheet, x) * (1 + sheet.piezoresistance * np.asarray(strain))
        own = sheet.anisotropy
        A = directed(own.ratio, own.angle) if own else ISOTROPIC
        A = A.reshape(3, *(1,) * np.ndim(R))
        if self._isometric:
            return A / R
        found = metric(self.skin, x)
        J = found.area
        B = adjugate(root(found.G, J))
        return between(B, A) / (R * J ** (1 + self._sheet_power))

    def directed(self, electrode: Electrode) -> bool:
        """True if an electrode may conduct better along one direction than along another."""
        return not self._isometric or self.skin.sheet(electrode).anisotropy is not None

    def capacitance(self, x: Real) -> Real:
        """c of the unpressed foam in F per flat m², shape (...), at x of shape (2, ...)."""
        foam = self.skin.foam
        c = foam.unpressed_capacitance_per_area * self._factors(foam.map, x)
        if self._isometric:
            return c
        return c * metric(self.skin, x).area ** (1 + self._foam_power)

    def area(self, x: Real) -> Real:
        """Area over that of the flat, unstretched skin at x of shape (2, ...), shape (...)."""
        if self._isometric:
            return np.ones(np.shape(x)[1:])
        return metric(self.skin, x).area

    def flattened(self, x: Real) -> Real:
        """J G^-1 as (xx, yy, xy), shape (3, ...), at x of shape (2, ...).

        It turns grad u . grad v on the skin into that on the flat, unstretched skin.
        """
        if self._isometric:
            return ISOTROPIC.reshape(3, *(1,) * (np.ndim(x) - 1)) * np.ones(np.shape(x)[1:])
        found = metric(self.skin, x)
        return adjugate(found.G) / found.area

    def depth(self, x: Real) -> Real:
        """Thickness of the unpressed foam in m, shape (...).

        Maps and stretch make it thinner at constant permittivity.
        """
        foam = self.skin.foam
        return (
            foam.thickness_or_assumed
            / self._factors(foam.map, x)
            / self.area(x) ** self._foam_power
        )

    def line_stretch(self, x: Real, direction: Real) -> Real:
        """Length of a line through x along a direction, over that on the flat, unstretched skin.

        x and direction are of shape (2, ...); the direction need not be of unit length. Shape
        (...).
        """
        along = np.asarray(direction) / np.hypot(*direction)
        if self._isometric:
            return np.ones(np.broadcast_shapes(np.shape(x)[1:], np.shape(along)[1:]))
        return np.sqrt(np.sum(np.sum(tangents(self.skin, x) * along, axis=1) ** 2, axis=0))

    @property
    def same_sheets(self) -> bool:
        """True if both sheets' conductances are in one ratio everywhere, pressed or not."""
        top, bottom = self.skin.top, self.skin.bottom
        same_maps = top.map == bottom.map or None not in (_uniform(top), _uniform(bottom))
        return (
            same_maps
            and top.piezoresistance == bottom.piezoresistance
            and np.allclose(_direction(top), _direction(bottom), rtol=1e-12, atol=1e-12)
        )

    @cached_property
    def lines(self) -> Lines:
        """Lines in m across x, and across y, at which a map's slope jumps; ascending."""
        sides, maps = self.skin.sides, self.skin.maps.values()
        kinks = [of_place.kinks(sides) for of_place in maps]
        found = []
        for axis, side in enumerate(sides):
            all_lines = [line for each in kinks for line in each[axis]]
            found.append(tuple(distinct([*all_lines, side], SAME_EDGE)[:-1].tolist()))
        return found[0], found[1]

    @property
    def shortest(self) -> float:
        """Shortest length in m over which a map varies; inf without maps."""
        maps = self.skin.maps.values()
        return min((each.shortest(self.skin.sides) for each in maps), default=np.inf)

    def _resistance(self, sheet: Sheet, x: Real) -> Real:
        """Resistance of the unpressed sheet, ohm/sq."""
        return sheet.sheet_resistance * self._factors(sheet.map, x)

    def _factors(self, of_place, x: Real) -> Real:
        if of_place is None:
            return np.ones(np.shape(x)[1:])
        return of_place.factors(np.asarray(x, dtype=np.float64), self.skin.sides)


def _uniform(sheet: Sheet) -> float | None:
    return 1.0 if sheet.map is None else sheet.map.uniform


def _direction(sheet: Sheet) -> Real:
    own = sheet.anisotropy
    return directed(own.ratio, own.angle) if own else ISOTROPIC

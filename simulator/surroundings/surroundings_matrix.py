"""Surroundings of a skin as one matrix: charges of sheets by smooth potentials.

It is that of both sheets by both. Local charges are left out, since elements have them in M
already: those of straight fields across the foam and towards a plane, and of the part of those
across the foam that runs along it (`thickness`).

Potentials are products of Legendre polynomials on the rectangle around the sheet.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from numpy.polynomial.legendre import legder, legval

from ..arrays import Integer, Mask, Real
from ..scene.foam import VACUUM_PERMITTIVITY
from ..scene.parts import Skin
from ..sweeps import InputError
from . import array_cache
from .charges import influence, sigma
from .panels import PanelBlock, Shape, quarter, shape_of
from .reflections import Layer, layer

SMOOTH = 1
DEGREE, MIN_DEGREE = 8, 3
"""Degrees along the longer side of a skin, and minimum along any.

Half a wave of the highest is an eighth of the side.
"""


@dataclass(frozen=True)
class Polynomials:
    """P_i(2x/L - 1) P_j(2y/W - 1), i up to degrees[0] and j up to degrees[1].

    sides: L and W in m.
    """

    sides: tuple[float, float]
    degrees: tuple[int, int]

    @property
    def count(self) -> int:
        """Number of polynomials."""
        return (self.degrees[0] + 1) * (self.degrees[1] + 1)

    @property
    def odd(self) -> Mask:
        """True for polynomials that are odd about the middle in x, and in y.

        Shape (2, polynomial).
        """
        return self._degrees % 2 == 1

    @property
    def squared(self) -> Real:
        """Integrals of their squares, m², shape (polynomial,)."""
        i, j = self._degrees
        return np.prod(self.sides) / ((2 * i + 1) * (2 * j + 1))

    @property
    def smooth(self) -> Mask:
        """True for polynomials of degree SMOOTH at most along either side, shape (polynomial,)."""
        return self._degrees.max(axis=0) <= SMOOTH

    @property
    def _degrees(self) -> Integer:
        """Degrees along x and y, shape (2, polynomial)."""
        i, j = np.meshgrid(*(np.arange(degree + 1) for degree in self.degrees), indexing="ij")
        return np.stack([i.ravel(), j.ravel()])

    def at(self, x: Real) -> Real:
        """Values at positions in m, shape (2, ...) to (polynomial, ...)."""
        return self._product(x, (0, 0))

    def slopes_at(self, x: Real) -> Real:
        """Gradients in 1/m, shape (2, ...) to (2, polynomial, ...)."""
        return np.stack([self._product(x, (1, 0)), self._product(x, (0, 1))])

    def _product(self, x: Real, derivatives: tuple[int, int]) -> Real:
        along, across = (
            legval(2 * at / side - 1, legder(np.eye(degree + 1), order, axis=0))
            * (2 / side) ** order
            for at, side, degree, order in zip(
                x, self.sides, self.degrees, derivatives, strict=True
            )
        )
        return (along[:, None] * across).reshape(self.count, *x.shape[1:])


def polynomials(sides: tuple[float, float]) -> Polynomials:
    """Polynomials of about the same resolution along both sides, m."""
    longer = max(sides)
    degrees = [max(MIN_DEGREE, int(np.ceil(DEGREE * side / longer))) for side in sides]
    return Polynomials(sides, (degrees[0], degrees[1]))


CACHED = 16
PANELS, EQUIDISTANT = (15, 22), 0.5
"""Panels from a skin's edge to its middle, of a coarse and of a fine block.

EQUIDISTANT is the fraction of them that is equidistant, for potentials that vary there.
"""
MARGIN = 0.1
"""Estimated error of Rs and Cp over the change by extrapolation to no panel size.

That change is the one of the charges of linear potentials. On the paper's sheet, 1 to 200 kHz, the
error was 0.04 of it at most.
"""
ACROSS = np.array([[1.0, -1.0], [-1.0, 1.0]])
ALONG = np.array([[1 / 3, 1 / 6], [1 / 6, 1 / 3]])


@dataclass(frozen=True)
class SurroundingsMatrix:
    """Charges D of both sheets by potentials of both, in polynomials.

    basis: on places as they are before a skin is stretched. matrix: F, shape (2, polynomial, 2,
    polynomial), the top sheet first; positive semidefinite. error: estimated, of the charges of the
    smoothest potentials, over those of straight fields across the foam.
    """

    basis: Polynomials
    matrix: Real
    error: float

    @cached_property
    def factor(self) -> Real:
        """C with D = C C', shape (2, polynomial, rank)."""
        size = 2 * self.basis.count
        power, modes = np.linalg.eigh(self.matrix.reshape(size, size))
        kept = power > 0
        return (modes[:, kept] * np.sqrt(power[kept])).reshape(2, self.basis.count, -1)


def surroundings_matrix(skin: Skin) -> SurroundingsMatrix:
    """Matrix of a scene with `surroundings.solved`, cached on disk.

    Raises InputError for unsupported scenes: skins that are not rectangles, two bodies, and a body
    that is not at the potential of earth.
    """
    key, around, skin = "surroundings.solved", skin.around, skin
    if not skin.rectangular:
        raise InputError(
            f"{skin.name}: `{key}` needs a rectangle; elsewhere give `surroundings.rim = true`"
        )
    bodies = around.body if around else ()
    if len(bodies) > 1 or any(body.potential != "earth" for body in bodies):
        raise InputError(
            f'{skin.name}: `{key}` takes one body at most, of `potential = "earth"`; with others '
            "give `surroundings.rim` in F/m in its place"
        )
    shape, plane = shape_of(skin, key), layer(bodies[0]) if bodies else None
    upside_down = bool(bodies) and bodies[0].side == "top"
    basis = polynomials((shape.length, shape.width))
    matrix, error = _solved(shape, plane, basis)
    matrix = matrix if upside_down else matrix[::-1, :, ::-1]
    return SurroundingsMatrix(replace(basis, sides=skin.sides), matrix, error)


@lru_cache(maxsize=CACHED)
def _solved(shape: Shape, plane: Layer | None, basis: Polynomials) -> tuple[Real, float]:
    """Matrix, F, sheet that faces a plane first, and its error; from disk if cached."""
    key = repr((shape, plane, basis, PANELS, EQUIDISTANT))
    found = array_cache.read(key)
    if found is None or found.shape != (len(PANELS), *2 * (2, basis.count)):
        sides = shape.length, shape.width, shape.thickness
        found = np.stack(
            [
                excess(quarter(*sides, count, EQUIDISTANT), plane, shape.permittivity, basis)
                for count in PANELS
            ]
        )
        array_cache.write(key, found)
    coarse, fine = found
    added = (fine - coarse) / ((PANELS[1] / PANELS[0]) ** 2 - 1)
    return fine + added, MARGIN * _relative(added, shape, basis)


def _relative(change: Real, shape: Shape, basis: Polynomials) -> float:
    """Largest change of charges of the smoothest potentials.

    It is over those of straight fields.
    """
    size = 2 * basis.count
    norms = np.tile(np.sqrt(basis.squared), 2)
    smooth = np.tile(basis.smooth, 2)
    scaled = (change.reshape(size, size) / np.outer(norms, norms))[np.ix_(smooth, smooth)]
    straight = VACUUM_PERMITTIVITY * shape.permittivity / shape.thickness
    return float(np.abs(np.linalg.eigvalsh(scaled)).max()) / straight


def excess(block: PanelBlock, layer: Layer | None, permittivity: float, basis: Polynomials) -> Real:
    """Matrix of one block, F, shape (2, polynomial, 2, polynomial).

    The bottom sheet is first. Polynomials are those of the whole skin. If the block is a part of it
    that mirrors complete, even ones and odd ones are solved separately.
    """
    found, of_parts = np.zeros((2, basis.count, 2, basis.count)), influence(block, layer)
    for odd in np.unique(basis.odd, axis=1).T if len(block.mirrors) > 1 else [None]:
        own, signs = np.arange(basis.count), np.ones(len(block.mirrors))
        if odd is not None:
            own = np.flatnonzero((basis.odd.T == odd).all(axis=1))
            signs = np.where(odd, block.mirrors[:, :2], 1.0).prod(axis=1)
        values, slopes = basis.at(block.middles)[own], basis.slopes_at(block.middles)[:, own]
        height = block.points[:, 2] / block.thickness
        psi = np.concatenate([(1 - height) * values, height * values]).T
        charge = block.areas[:, None] * sigma(
            block, np.tensordot(of_parts, signs, axes=(1, 0)), permittivity, psi
        )
        beyond = psi.T @ charge - _local(block, layer, values, slopes)
        both = (beyond + beyond.T).reshape(2, len(own), 2, len(own)) / 2
        found[:, own[:, None], :, own] = both.transpose(1, 3, 0, 2)
    return VACUUM_PERMITTIVITY * len(block.mirrors) * found


def _local(block: PanelBlock, layer: Layer | None, values: Real, slopes: Real) -> Real:
    """Local charges of sheets with vacuum between, over eps0, m, shape (2 k, 2 k).

    values, slopes: those of k potentials and of their gradients at the middles of all panels.
    """
    sheet = np.s_[..., : len(block.panels)]
    weights, u, du = block.areas[sheet], values[sheet], slopes[sheet]
    mass, along = (weights * u) @ u.T, np.einsum("dip,djp->ij", weights * du, du)
    found = np.kron(ACROSS, mass / block.thickness) + np.kron(ALONG, along * block.thickness)
    if layer is not None:
        found[: len(u), : len(u)] += layer.permittivity / layer.thickness * mass
    return found

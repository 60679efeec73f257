"""Family of a skin whose pixels are pressed by applicators, and the changes of M by these."""

from __future__ import annotations

from functools import cached_property
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix

from ....arrays import Integer, Real
from ....fem.circuit import Circuit
from ....method_cache import cached_method
from ....press.parts import Parts, parts_of
from ....press.press import Press
from ....press.touch import Depth, Indentation, Touch
from ....scene.parts import Skin
from ...heterogeneous.pressed_system import add_foam
from ..cases import Case
from ..families.family import Triangulation
from ..families.heterogeneous_family import HeterogeneousFamily
from .applicators import (
    COARSEST,
    FACTOR_SHARE,
    MIN_RISE,
    PixelApplicators,
    RiseField,
    field_of,
    near,
)

COUPLED = 0.1
"""Applicators are coupled if one raises c under another by more than this share of the
tolerance."""
PRESSES_KEPT = 64


class PressRise(NamedTuple):
    """Rise of c of a whole press over the unpressed c, and its uncertainty, in some cells.

    Shapes (cell,), (cell, point) and (cell, point).
    """

    cells: Integer
    rise: Real
    uncertainty: Real


class IndentationFamily(HeterogeneousFamily):
    """Family of a skin whose pixels are pressed by applicators.

    Its factors of c are those of unpressed parts, followed by the rise of the factor under each
    pixel's applicator, 0 without one; shape (part + pixel,).
    """

    def __init__(
        self,
        skin: Skin,
        circuit: Circuit,
        mesh: Triangulation,
        modes: int,
        applicators: PixelApplicators,
        rtol: float,
    ) -> None:
        """rtol: tolerance of Rs and Cp, for coupled applicators."""
        self.applicators, self.rtol = applicators, rtol
        self._known: dict[int, RiseField] = {}
        super().__init__(skin, circuit, mesh, modes)

    def foam_of(self, case: Case) -> Real:
        """Factors of a case's foam, see the class."""
        rest = self.parts.resting
        if case.variation is not None:
            rest = rest * case.variation.factors(self.skin)
        return self.pressed(rest, case.cells, case.rises)

    def pressed(self, rest: Real, cells: Integer, rises: Real) -> Real:
        """Unpressed parts with the fingers of a press, followed by rises under applicators."""
        foam, fingers = self.parts.by_kind(cells, rises)
        under = np.zeros(self.skin.pixels.rows * self.skin.pixels.columns)
        under[foam.cells] = foam.rises
        touched = (
            np.bincount(fingers.cells, fingers.rises, len(rest)) if len(fingers.cells) else 0.0
        )
        return np.concatenate([rest + touched, under])

    def mass(self, factors: NDArray) -> csc_matrix:
        """M in F, in the system's pattern. factors: see the class."""
        mass, applied = self.masses.mass(factors[: self.parts.count]), self._applied(factors)
        return mass if applied is None else self.system.pattern.matrix(mass.data + applied.data)

    def applied_inside(self, factors: Real) -> csc_matrix | None:
        """What applicators add to `mass_inside`, F; None without any. factors: see the class."""
        applied = self._applied(factors)
        return None if applied is None else self.space.restricted(applied)

    def _applied(self, factors: NDArray) -> csc_matrix | None:
        rest, under = factors[: self.parts.count], factors[self.parts.count :]
        cells = np.flatnonzero(under)
        if not cells.size:
            return None
        c, found = np.zeros_like(self.unpressed_capacitance), self.press(cells, under[cells])
        for each in found:
            of_parts = rest[self.part_of[each.cells]][:, None]
            c[each.cells] += of_parts * self.unpressed_capacitance[each.cells] * each.rise
        within = np.zeros(len(c), dtype=bool)
        within[np.concatenate([each.cells for each in found])] = True
        values = np.zeros(len(self.system.pattern.indices))
        unknowns, coupling = self.system.unknowns, self.circuit.coupling
        add_foam(values, coupling, self.elements, unknowns, c, within)
        return self.system.pattern.matrix(values)

    def mass_inside(self, factors: Real) -> csc_matrix:
        """M in F of the space alone. factors: see the class."""
        return self.space.restricted(self.mass(factors))

    def press(self, cells: Integer, rises: Real) -> list[PressRise]:
        """Rises of c by each touch, or the one rise by all touches if any two are coupled."""
        if self.coupled(cells):
            return [self.coupled_rise(tuple(cells.tolist()), tuple(rises.tolist()))]
        return [self._alone(*each) for each in zip(cells.tolist(), rises.tolist(), strict=True)]

    def coupled(self, cells: Integer) -> bool:
        """True if the applicator of any of these pixels affects that of another."""
        return any(
            max(self.tails[k, m], self.tails[m, k]) > COUPLED * self.rtol
            for k, m in combinations(np.asarray(cells).tolist(), 2)
        )

    def field(self, pixel: int) -> RiseField:
        """Rise of c by the applicator of a pixel with skin, cached."""
        if pixel not in self._known:
            self._known[pixel] = field_of(self.applicators, pixel, self.elements, self.domain)
        return self._known[pixel]

    @cached_property
    def tails(self) -> Real:
        """Largest rise of c that each pixel's applicator causes under others, shape (pixel,
        pixel)."""
        count = len(self.applicators.of_pixel)
        found = np.zeros((count, count))
        for pixel in self.pressable.tolist():
            own = self.field(pixel)
            rise = (own.coefficients[-1] @ own.modes.reshape(len(own.modes), -1)).reshape(
                own.modes.shape[1:]
            )
            under = self.domain.pixel[own.cells]
            known = under >= 0
            np.maximum.at(found[pixel], under[known], rise.max(axis=1)[known])
        return found

    @property
    def pressable(self) -> Integer:
        """Pixels with skin."""
        return np.flatnonzero(self.applicators.of_pixel >= 0)

    @cached_property
    def parts(self) -> Parts:
        """Numbering of the parts of M."""
        return parts_of(self.skin)

    @cached_property
    def unpressed_capacitance(self) -> Real:
        """c of the scene's own unpressed foam, F/m², at the points of the rule, shape (cell,
        point)."""
        return self._coefficients.capacitance(self.elements.surface.x)

    @cached_property
    def part_of(self) -> Integer:
        """Part of the foam that each cell belongs to, shape (cell,)."""
        pixel = self.domain.pixel
        return np.where(pixel < 0, self.skin.pixels.rows * self.skin.pixels.columns, pixel)

    @cached_property
    def _finer(self) -> IndentationFamily:
        finer = Triangulation(self.domain, self.mesh.order + 1)
        known = self.applicators, self.rtol
        return IndentationFamily(self.skin, self.circuit, finer, self.modes, *known)

    def _alone(self, pixel: int, rise: float) -> PressRise:
        own = self.field(pixel)
        coefficients = own.at(float(self.applicators.depth(np.array(rise))))
        found = np.tensordot(coefficients, own.modes, axes=1)
        return PressRise(own.cells, found, max(rise, MIN_RISE) * own.uncertainty)

    @cached_method(PRESSES_KEPT)
    def coupled_rise(self, pixels: tuple[int, ...], rises: tuple[float, ...]) -> PressRise:
        """Rise of c from the mechanics of the whole press."""
        from ...mechanics.indentation import deformation

        domain, columns = self.domain, self.skin.pixels.columns
        depths = self.applicators.depth(np.array(rises)).tolist()
        touches = tuple(
            Indentation(Touch(k // columns + 1, k % columns + 1, 1.0), Depth(depth))
            for k, depth in sorted(zip(pixels, depths, strict=True))
        )
        found = deformation(self.skin, Press(touches), min(COARSEST, FACTOR_SHARE * self.rtol))
        far = self.applicators.far
        cells = np.unique(np.concatenate([near(domain, domain.pixel == k, far) for k in pixels]))
        x = self.elements.surface.x[:, cells]
        rise = found.factor(x) - 1
        return PressRise(cells, rise, found.deeper(1.0).factor(x) - 1 - rise)

"""Reduced model of a skin whose pixels are pressed by applicators, by depth or force.

A touch of pixel k by `rise` stands for the depth at which the factor under its applicator is 1 +
rise. The rise of c next to the applicator follows from the membrane. The change of M by each
touch has factors of low rank, so that a press costs as much as one by capacitance factors.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ....arrays import Complex, Integer, Real
from ....fem.error_estimate import both, relative_difference
from ....press.batch import PressBatch
from ....sweeps import InputError
from ...parameters import Variation
from ...small_system.system import UnpressedMass
from ..compressing import typical
from ..families.family import Family
from ..reduced_model import Reduced
from ..reduced_skin import KRYLOV_SHARE, ReducedSkin
from .applicator_tables import FoamPotentials, Tables, family_on, finer_families, tables
from .applicators import MIN_RISE, PixelApplicators
from .indentation_family import IndentationFamily

TOUCHES_AT_ONCE = 4096


@dataclass(frozen=True)
class IndentationModel(Reduced):
    """Reduced model with applicators on all pixels.

    tables: changes of M by the applicators, in the basis.
    """

    applicators: PixelApplicators | None = None
    tables: Tables | None = None

    @cached_property
    def family(self) -> IndentationFamily:
        """Full model; it is built again if it is not at hand."""
        if isinstance(self.built, IndentationFamily):
            return self.built
        assert self.applicators is not None
        given = self.parts.skin, self.circuit, self.mesh, self.modes
        return family_on(*given, self.applicators, self.rtol)

    def skin(self, variation: Variation | None, pressed: Real | None = None) -> IndentationSkin:
        """One skin of the family, see `Reduced.skin`."""
        return IndentationSkin(self, variation, pressed)

    @cached_property
    def foam_potentials(self) -> FoamPotentials:
        """Potentials of the basis across the foam."""
        return FoamPotentials(self.family, self.coordinates)


def with_applicator_tables(reduced: Reduced) -> IndentationModel:
    """Model with tables of its family's applicators; the family is an `IndentationFamily`."""
    family = reduced.family
    assert isinstance(family, IndentationFamily)
    own = {name: getattr(reduced, name) for name in reduced.__dataclass_fields__}
    found = tables(family, reduced.coordinates, typical(reduced), reduced.rtol)
    return IndentationModel(**own, applicators=family.applicators, tables=found)


class IndentationSkin(ReducedSkin):
    """One skin of the family, see `ReducedSkin`; its cells are applicators of pixels."""

    reduced: IndentationModel

    def __init__(
        self, reduced: IndentationModel, variation: Variation | None, pressed: Real | None = None
    ) -> None:
        super().__init__(reduced, variation, pressed)
        assert reduced.tables is not None and reduced.applicators is not None
        self._tables, self._applicators = reduced.tables, reduced.applicators
        of_parts = self.unpressed_factors[self._tables.parts]
        self._matrices = np.einsum("kp,kpjrs->kjrs", of_parts, self._tables.matrices)
        self._bases = self._tables.bases @ self.turn

    def touched(self, cells: Integer, rises: Real) -> tuple[UnpressedMass, Integer, Real]:
        """Terms that one press adds to M, see `ReducedSkin.touched`."""
        foam, fingers = self.parts.by_kind(cells, rises)
        self._check(foam.rises)
        if self.reduced.family.coupled(foam.cells):
            (press,) = self.reduced.family.press(*foam)
            F = (
                self.reduced.foam_potentials.thin(press, self.unpressed_factors, press.rise)
                @ self.turn
            )
            factors = _stacked(F[None], self._by_fingers(*fingers))
        else:
            factors = self._factors(cells, rises)
        return self.pressed_by(factors), np.arange(len(factors)), np.ones(len(factors))

    def map_of(self, cells: Integer, rises: Real) -> Real:
        """Factors of a press, as the family's `mass` takes them."""
        unpressed, fingers = self.unpressed_factors, self.parts.kind[1]
        found = self.reduced.family.pressed(unpressed * self.parts.resting, cells, rises)
        found[fingers] *= unpressed[fingers]
        return found

    def uncertainty_error(self, cells: Integer, rises: Real, s: Complex) -> Real:
        """Relative changes of Rs and Cp if c is higher by its whole uncertainty. s: rad/s."""
        found = self.solved(cells, rises, s)
        Y = np.stack([each for _, each in found])
        more = s * np.stack([self._uncertain_form(cells, rises, u) for u, _ in found])
        Z, raised = (self.combination.impedance(each) for each in (Y, Y + more))
        return both(relative_difference(raised, Z))

    def charges(self, cells: Integer, rises: Real, u: Complex) -> tuple[Complex, Complex]:
        """Derivatives of u'Mu, and u'Mu itself, see `ReducedSkin.charges`.

        Those of touched pixels are by the rise under their applicators, over the unpressed c there.
        Coupled applicators are taken as if each were alone.
        """
        squares, (foam, _) = self.squares(u), self.parts.by_kind(cells, rises)
        rest, _, _ = self.touched(cells, rises)
        touched = (rest.factors @ np.linalg.solve(self.turn, u)) ** 2
        whole = squares @ (self.unpressed_factors * self.parts.resting) + touched.sum(axis=(0, 1))
        for cell, rise in zip(foam.cells.tolist(), foam.rises.tolist(), strict=True):
            y, step = self._tables.bases[cell] @ u, SLOPE_STEP * (1 + rise)
            ends = np.clip([rise - step, rise + step], 0.0, self._most - 1)
            C = np.diff(self._summed(np.array([cell, cell]), ends), axis=0)[0]
            by_rise = np.einsum("rs,rf,sf->f", C, y, y) / np.ptp(ends)
            squares[:, cell] = by_rise / self.unpressed_factors[cell]
        return squares, whole

    def _swept(self, batch: PressBatch, s: Complex, precision: float) -> Complex:
        self._check(batch.rises[batch.cells < self.parts.foam])
        found = np.empty((batch.count, len(self.combination.weights), len(s)), dtype=np.complex128)
        rtol, each = precision * KRYLOV_SHARE * self.reduced.rtol, list(batch.each())
        coupled = np.array([self._coupled(own.cells) for own in each], dtype=bool)
        for press in np.flatnonzero(coupled):
            rest, which, weights = self.touched(*each[press])
            found[[press]] = self._by_factors(rest, PressBatch.of([(which, weights)]), s, rtol)
        for some in _parts(np.flatnonzero(~coupled), batch.starts):
            own = PressBatch.of(each[press] for press in some)
            factors = self._factors(own.cells, own.rises)
            touches = PressBatch(np.arange(len(factors)), np.ones(len(factors)), own.starts)
            found[some] = self._by_factors(self.pressed_by(factors), touches, s, rtol)
        return found

    def _by_factors(
        self, mass: UnpressedMass, batch: PressBatch, s: Complex, rtol: float
    ) -> Complex:
        """Z in ohm of presses that have factors of their own, shape (press, interface, s)."""
        from ...small_system.lanczos import Skins

        return self._impedances(Skins.of_one(mass, np.ones(len(mass.factors)), s, rtol), batch)

    def _coupled(self, cells: Integer) -> bool:
        if len(cells) < 2:
            return False
        return self.reduced.family.coupled(cells[cells < self.parts.foam])

    def _factors(self, cells: Integer, rises: Real) -> Real:
        """F of each touch, which raises M by F'F, shape (touch, rank, N + n)."""
        foam, fingers = self.parts.by_kind(cells, rises)
        if not len(fingers.cells):
            return self._by_applicators(cells, rises)
        found = _stacked(self._by_applicators(*foam), self._by_fingers(*fingers))
        back = np.argsort(np.argsort(cells >= self.parts.foam, kind="stable"))
        return np.ascontiguousarray(found[back])

    def _by_fingers(self, cells: Integer, rises: Real) -> Real:
        """F of fingers. rises: capacitance of each finger, F."""
        roots = np.sqrt(rises * self.unpressed_factors[cells])
        return roots[:, None, None] * (self.reduced.factors[cells] @ self.turn)

    def _by_applicators(self, cells: Integer, rises: Real) -> Real:
        """F of applicators."""
        power, turn = np.linalg.eigh(self._summed(cells, rises))
        roots = np.sqrt(np.maximum(power, 0.0))
        thin = (turn * roots[:, None, :]).transpose(0, 2, 1)
        return np.ascontiguousarray(thin @ self._bases[cells])

    def _summed(self, cells: Integer, rises: Real) -> Real:
        """C of each touch, F, shape (touch, rank, rank), see `tables`."""
        weights = np.zeros((len(cells), self._matrices.shape[1]))
        depth = self._applicators.depth(rises)
        for number in np.unique(cells):
            here = cells == number
            found = self.reduced.family.field(int(number)).at(depth[here])
            weights[here, : found.shape[1]] = found
        return np.einsum("tj,tjrs->trs", weights, self._matrices[cells])

    def _uncertain_form(self, cells: Integer, rises: Real, u: Complex) -> Complex:
        """u'Eu, with E the uncertainty of M, F, shape (s,)."""
        cells, rises = self.parts.by_kind(cells, rises)[0]
        if self._coupled(cells):
            (press,) = self.reduced.family.press(cells, rises)
            F = self.reduced.foam_potentials.thin(press, self.unpressed_factors, press.uncertainty)
            return ((F @ u) ** 2).sum(axis=0)
        found, most = np.zeros(u.shape[1], dtype=complex), self.unpressed_factors.max()
        for cell, rise in zip(cells, rises, strict=True):
            y = self._tables.bases[cell] @ u
            E = max(rise, MIN_RISE) * most * self._tables.uncertainties[cell]
            found += np.einsum("rs,rf,sf->f", E, y, y)
        return found

    def _check(self, rises: Real) -> None:
        """Raises InputError for rises outside the range of the applicators."""
        known, most = self._applicators, self._most
        if len(rises) and not (rises.min() >= 0 and rises.max() <= (most - 1) * (1 + ROUNDING)):
            raise InputError(
                f"{self.reduced.parts.skin.name}: the factor under an applicator must be from 1 to "
                f"{most:.4g}, at {known.deepest:.4g} m, got {1 + rises.min():.4g} to "
                f"{1 + rises.max():.4g}"
            )

    @cached_property
    def _most(self) -> float:
        """Factor under the deepest applicator."""
        known = self._applicators
        return float(known.mechanics.factor(np.array(known.deepest / known.thickness)))

    def _families(self, cells: Integer, rises: Real) -> Iterator[Family]:
        yield self.reduced.family
        foam, _ = self.parts.by_kind(cells, rises)
        yield from finer_families(self.reduced.family, *foam, self.reduced.frequency)


SLOPE_STEP = 1e-5
ROUNDING = 1e-9


def _stacked(*factors: Real) -> Real:
    """Factors of touches one after the other, each padded with zeros to the largest rank."""
    rank = max(each.shape[1] for each in factors)
    return np.concatenate(
        [np.pad(each, ((0, 0), (0, rank - each.shape[1]), (0, 0))) for each in factors]
    )


def _parts(presses: Integer, starts: Integer) -> Iterator[Integer]:
    """Groups of presses with about TOUCHES_AT_ONCE touches each."""
    if not len(presses):
        return
    touches = np.cumsum(starts[presses + 1] - starts[presses])
    number = touches // TOUCHES_AT_ONCE
    for each in np.unique(number):
        yield presses[number == each]

"""Touches by depth or force that tension of the skins spreads: their changes of M have tables.

A touch of pixel k by `rise` stands for the depth at which the factor under its applicator is 1 +
rise. The rise of c next to the applicator follows from the membrane. For each applicator the few
combinations y = U u of a basis are kept that matter where it presses. M rises by y'Cy there. C is a
sum over modes, weighted by coefficients of depth, and over parts of the foam, weighted by their
unpressed c. So a press costs as much as one by factors.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations
from typing import TYPE_CHECKING, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Complex, Integer, Real
from ...fem.error_estimate import both, relative_difference
from ...mesh.domain import Domain
from ...method_cache import cached_method
from ...press.batch import PressBatch
from ...press.parts import Parts
from ...press.press import Press
from ...press.touch import Depth, Indentation, Touch
from ...scene.parts import Skin
from ...sweeps import InputError
from ..heterogeneous.elements import Elements
from ..heterogeneous.pressed_system import add_foam
from ..mechanics.deformation import Deformation
from .applicators import (
    COARSEST,
    FACTOR_SHARE,
    MIN_RISE,
    PixelApplicators,
    RiseField,
    applicators,
    field_of,
    near,
)
from .cases import Case, Draw, alone, separated_draws
from .touches import Touches, Trial

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix

    from ..small_system.lanczos import Skins
    from ..small_system.system import UnpressedMass
    from .family import Family
    from .reduced_model import Reduced
    from .reduced_skin import ReducedSkin

MAX_SINGLE_PIXELS, TURNS = 12, 2
TOUCHES_AT_ONCE = 4096
COUPLED = 0.1
"""Applicators are coupled if one raises c under another by more than this share of the
tolerance."""
PRESSES_KEPT = 64
DROPPED = 5e-3
"""Combinations with less than this share of the tolerance times the first one's energy in an
applicator's foam are left out."""
ROUNDING, BEYOND_RANGE = 1e-15, 1e-9
SLOPE_STEP = 1e-5


class PressRise(NamedTuple):
    """Rise of c of a whole press over the unpressed c, and its uncertainty, in some cells.

    Shapes (cell,), (cell, point) and (cell, point).
    """

    cells: Integer
    rise: Real
    uncertainty: Real


class MeshRises:
    """Rises of c by applicators at the points of the elements of one mesh.

    part_of: part of the foam that each cell belongs to, shape (cell,). unpressed: c of the scene's
    own unpressed foam, F/m², shape (cell, point).
    """

    def __init__(
        self,
        touches: Touches,
        elements: Elements,
        domain: Domain,
        part_of: Integer,
        unpressed: Real,
    ) -> None:
        assert isinstance(touches, DepthTouches)
        self.applicators, self.rtol = touches.applicators, touches.rtol
        self.elements, self.domain = elements, domain
        self.part_of, self.unpressed = part_of, unpressed
        self._known: dict[int, RiseField] = {}

    def press(self, cells: Integer, rises: Real) -> list[PressRise]:
        """Rises of c by each touch, or the one rise by all touches if any two are coupled."""
        if self.coupled(cells):
            return [self.coupled_rise(tuple(cells.tolist()), tuple(rises.tolist()))]
        return [self._alone(*each) for each in zip(cells.tolist(), rises.tolist(), strict=True)]

    def coupled(self, cells: Integer) -> bool:
        """True if the applicator of any of these pixels affects that of another."""
        return any(
            max(self.tails[k, m], self.tails[m, k]) > COUPLED * self.rtol
            for k, m in combinations(cells.tolist(), 2)
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
        for pixel in self.applicators.pressable.tolist():
            own = self.field(pixel)
            rise = np.tensordot(own.coefficients[-1], own.modes, axes=1)
            under = self.domain.pixel[own.cells]
            known = under >= 0
            np.maximum.at(found[pixel], under[known], rise.max(axis=1)[known])
        return found

    def capacitance(self, unpressed: Real, cells: Integer, rises: Real) -> Real:
        """Rise of c by a press in F/m², shape (cell, point).

        unpressed: amount of each part of the foam over the scene's own, shape (part,).
        """
        c = np.zeros_like(self.unpressed)
        for own, rise, _ in self.press(cells, rises):
            c[own] += unpressed[self.part_of[own]][:, None] * self.unpressed[own] * rise
        return c

    def _alone(self, pixel: int, rise: float) -> PressRise:
        own = self.field(pixel)
        coefficients = own.at(float(self.applicators.depth(np.array(rise))))
        found = np.tensordot(coefficients, own.modes, axes=1)
        return PressRise(own.cells, found, max(rise, MIN_RISE) * own.uncertainty)

    @cached_method(PRESSES_KEPT)
    def coupled_rise(self, pixels: tuple[int, ...], rises: tuple[float, ...]) -> PressRise:
        """Rise of c from the mechanics of the whole press."""
        from ..mechanics.indentation import deformation

        domain, skin, far = self.domain, self.applicators.skin, self.applicators.far
        columns = skin.pixels.columns
        depths = self.applicators.depth(np.array(rises)).tolist()
        touches = tuple(
            Indentation(Touch(k // columns + 1, k % columns + 1, 1.0), Depth(depth))
            for k, depth in sorted(zip(pixels, depths, strict=True))
        )
        found = deformation(skin, Press(touches), min(COARSEST, FACTOR_SHARE * self.rtol))
        cells = np.unique(np.concatenate([near(domain, domain.pixel == k, far) for k in pixels]))
        x = self.elements.surface.x[:, cells]
        rise = found.factor(x) - 1
        return PressRise(cells, rise, found.deeper(1.0).factor(x) - 1 - rise)


@dataclass(frozen=True)
class Tables:
    """Matrices of all applicators, padded with zeros to a common shape.

    bases: U, shape (pixel, rank, N + n). parts: parts of the foam that each applicator affects,
    shape (pixel, part). matrices: C in F, shape (pixel, part, mode, rank, rank). uncertainties: C
    of the uncertainty of a rise, in all parts together, F, shape (pixel, rank, rank).
    """

    bases: Real
    parts: Integer
    matrices: Real
    uncertainties: Real


def tables(known: MeshRises, across: FoamPotentials, size: Real) -> Tables:
    """Tables of all pixels. size: typical size of coordinates, V, shape (N + n,)."""
    found = {k: _of_pixel(known, across, k, size) for k in known.applicators.pressable.tolist()}
    count, m = len(known.applicators.of_pixel), len(size)
    rank, parts, modes = (
        max(each[which].shape[axis] for each in found.values())
        for which, axis in ((0, 0), (1, 0), (2, 1))
    )
    bases, uncertainties = np.zeros((count, rank, m)), np.zeros((count, rank, rank))
    of_parts = np.zeros((count, parts), dtype=np.int64)
    matrices = np.zeros((count, parts, modes, rank, rank))
    for k, (U, own, C, E) in found.items():
        r = len(U)
        bases[k, :r], uncertainties[k, :r, :r], of_parts[k, : len(own)] = U, E, own
        matrices[k, : len(own), : C.shape[1], :r, :r] = C
    return Tables(bases, of_parts, matrices, uncertainties)


def _of_pixel(
    known: MeshRises, across: FoamPotentials, pixel: int, size: Real
) -> tuple[Real, Integer, Real, Real]:
    field = known.field(pixel)
    weights = across.weights(field.cells)
    D = across.potentials(field.cells) * size
    most = np.tensordot(field.coefficients[-1], field.modes, axes=1)
    heavy = D * np.sqrt(weights * np.maximum(most, 0.0))[..., None]
    flat = heavy.reshape(-1, len(size))
    power, turn = np.linalg.eigh(flat.T @ flat)
    turn = turn[:, power > DROPPED * known.rtol * power[-1]]
    local = D @ turn
    parts, place = np.unique(known.part_of[field.cells], return_inverse=True)
    matrices = np.zeros((len(parts), len(field.modes), turn.shape[1], turn.shape[1]))
    for part in range(len(parts)):
        a = local[place == part].reshape(-1, turn.shape[1])
        for mode, g in enumerate(field.modes):
            matrices[part, mode] = (a.T * (weights * g)[place == part].ravel()) @ a
    a = local.reshape(-1, turn.shape[1])
    uncertainties = (a.T * (weights * field.uncertainty).ravel()) @ a
    return turn.T / size, parts, matrices, uncertainties


class FoamPotentials:
    """Potentials of a basis across the foam, at the points of a family's rule."""

    def __init__(self, family: Family, W: Real) -> None:
        """W: basis in the full space, shape (inner + N, N + n)."""
        self._rises, self._number = family.rises, family.system.unknowns.number
        spread = family.space.spread(W)
        self._values = np.vstack([spread, np.zeros((1, W.shape[1]))])

    def potentials(self, cells: Integer) -> Real:
        """Potentials across the foam, V, shape (cell, point, N + n)."""
        elements = self._rises.elements
        dofs = elements.trial.dofs.element_dofs[:, cells]
        first, *others = (self._values[of_field[dofs]] for of_field in self._number)
        across = first - others[0] if others else first
        return np.einsum("fp,fcm->cpm", elements.rule.values, across, optimize=True)

    def weights(self, cells: Integer) -> Real:
        """Unpressed capacitance of the rule's points, F, shape (cell, point)."""
        elements = self._rises.elements
        area = elements.surface.some(cells).area * elements.rule.weights
        return self._rises.unpressed[cells] * area

    def thin(self, cells: Integer, unpressed: Real, values: Real) -> Real:
        """F of the rise F'F of M, shape (rank, N + n).

        unpressed: see `MeshRises.capacitance`. values: rise of c over the unpressed c, shape (cell,
        point).
        """
        of_parts = unpressed[self._rises.part_of[cells]][:, None]
        weights = self.weights(cells) * of_parts * np.maximum(values, 0.0)
        D = self.potentials(cells) * np.sqrt(weights)[..., None]
        flat = D.reshape(-1, D.shape[-1])
        power, turn = np.linalg.eigh(flat.T @ flat)
        kept = power > ROUNDING * power[-1]
        return np.sqrt(power[kept])[:, None] * turn[:, kept].T


class _OnSkin(NamedTuple):
    """Tables for one skin: C with its unpressed c, (pixel, mode, rank, rank), and U in its
    coordinates."""

    matrices: Real
    bases: Real


@dataclass(frozen=True)
class DepthTouches(Touches):
    """Touches by depth or force of applicators on all pixels, whose pressing spreads.

    Amounts of a press are those of the parts, followed by the rise of the factor under each pixel's
    applicator, 0 without one, shape (part + pixel,). rtol: tolerance of Rs and Cp. tables: changes
    of M in the basis of a model; None for a family without one.
    """

    applicators: PixelApplicators
    rtol: float
    tables: Tables | None = None
    spread: ClassVar[bool] = True

    @classmethod
    def of(cls, skin: Skin, rtol: float) -> DepthTouches:
        """Touches on all pixels of a skin. Raises ToleranceError as `applicators` does."""
        return cls(applicators(skin, rtol), rtol)

    @cached_property
    def largest(self) -> float:
        """Rise of the factor under the deepest applicator."""
        known = self.applicators
        return float(known.mechanics.factor(np.array(known.deepest / known.thickness))) - 1

    def draws(self, draw: Draw, skin: Skin) -> Draw:
        """Draws on separate pixels, see `separated_draws`."""
        return separated_draws(draw, skin, self.largest)

    def trials(self, skin: Skin, cases: Sequence[Case]) -> tuple[list[Trial], list[Case]]:
        """Presses of every second pixel each way to the largest depth, and of single pixels."""
        pixels = self.applicators.pressable
        row, column = np.divmod(pixels, skin.pixels.columns)
        turns = [
            pixels[(row % TURNS == first) & (column % TURNS == second)]
            for first, second in np.ndindex(TURNS, TURNS)
        ]
        each = [
            self._trial(dict.fromkeys(own.tolist(), self.applicators.deepest))
            for own in turns
            if len(own)
        ]
        return each, alone(pixels, self.largest, MAX_SINGLE_PIXELS)

    def trial(self, skin: Skin, cells: Integer, rises: Real) -> Trial:
        """Press of pixels, each as if it were alone."""
        on_pixels = cells < len(self.applicators.of_pixel)
        depths = self.applicators.depth(rises[on_pixels]).tolist()
        return self._trial(dict(zip(cells[on_pixels].tolist(), depths, strict=True)))

    def _trial(self, depths: dict[int, float]) -> Trial:
        """Press of pixels to depths in m."""
        known = self.applicators

        def w(x: Real) -> Real:
            flat = np.reshape(x, (2, -1))
            found = np.zeros(flat.shape[1])
            for pixel, own in depths.items():
                np.maximum(found, known.deflection(pixel, own, flat), out=found)
            return found.reshape(x.shape[1:])

        deepest, exact = tuple(depths.values()), (0.0,) * len(depths)
        given = known.mechanics, known.thickness, w, deepest, exact, 0.0, (), None
        return Trial(Press(), Deformation(*given))

    def amounts(self, parts: Parts, unpressed: Real | float, cells: Integer, rises: Real) -> Real:
        """Amounts of the parts, followed by rises under applicators, see the class."""
        foam, fingers = parts.by_kind(cells, rises)
        under = np.zeros(len(self.applicators.of_pixel))
        under[foam.cells] = foam.rises
        return np.concatenate([parts.pressed(*fingers) * unpressed, under])

    def added(self, family: Family, amounts: NDArray) -> csc_matrix | None:
        """What applicators add to M, F, in the system's pattern; None without any."""
        unpressed, under = np.split(amounts, [family.parts.count])
        cells = np.flatnonzero(under)
        if not cells.size:
            return None
        c, system = family.rises.capacitance(unpressed, cells, under[cells]), family.system
        values, within = np.zeros(len(system.pattern.indices)), np.asarray(c.any(axis=1))
        given = family.circuit.coupling, family.rises.elements, system.unknowns
        add_foam(values, *given, c, within)
        return system.pattern.matrix(values)

    def in_basis(self, reduced: Reduced) -> Reduced:
        """The model with tables of its applicators."""
        from .compressing import typical

        across = FoamPotentials(reduced.family, reduced.coordinates)
        found = tables(reduced.family.rises, across, typical(reduced))
        return replace(reduced, touches=replace(self, tables=found))

    def on(self, skin: ReducedSkin) -> _OnSkin:
        """Tables for one skin."""
        assert self.tables is not None
        unpressed = skin.unpressed_factors[self.tables.parts]
        matrices = np.einsum("kp,kpjrs->kjrs", unpressed, self.tables.matrices)
        return _OnSkin(matrices, self.tables.bases @ skin.turn)

    def terms(
        self, skin: ReducedSkin, cells: Integer, rises: Real
    ) -> tuple[UnpressedMass, Integer, Real]:
        """Factors of each touch, or of all together if they are coupled, each with weight 1."""
        foam, fingers = skin.parts.by_kind(cells, rises)
        self._check(skin, foam.rises)
        rises_on_mesh = skin.reduced.family.rises
        if rises_on_mesh.coupled(foam.cells):
            (press,) = rises_on_mesh.press(*foam)
            F = self._thin(skin, press.cells, press.rise) @ skin.turn
            factors = _stacked(F[None], _of_fingers(skin, *fingers))
        else:
            factors = self._factors(skin, cells, rises)
        return skin.pressed_by(factors), np.arange(len(factors)), np.ones(len(factors))

    def systems(
        self, skin: ReducedSkin, batch: PressBatch
    ) -> Iterator[tuple[Integer, Skins, PressBatch]]:
        """Each press whose touches are coupled alone, all others in groups."""
        pixels = batch.where(batch.cells < skin.parts.foam) if skin.parts.around else batch
        self._check(skin, pixels.rises)
        coupled, each = skin.reduced.family.rises.coupled, list(batch.each())
        alone = np.diff(pixels.starts) > 1
        alone[alone] = [coupled(pixels.one(k).cells) for k in np.flatnonzero(alone).tolist()]
        for press in np.flatnonzero(alone):
            mass, which, weights = self.terms(skin, *each[press])
            yield np.array([press]), _system(skin, mass), PressBatch.of([(which, weights)])
        for some in _groups(np.flatnonzero(~alone), batch.starts):
            own = PressBatch.of(each[press] for press in some)
            factors = self._factors(skin, own.cells, own.rises)
            touches = PressBatch(np.arange(len(factors)), np.ones(len(factors)), own.starts)
            yield some, _system(skin, skin.pressed_by(factors)), touches

    def charges(
        self, skin: ReducedSkin, cells: Integer, rises: Real, u: Complex
    ) -> tuple[Complex, Complex]:
        """Derivatives of u'Mu by each part, and u'Mu itself, see `Touches.charges`.

        Those of touched pixels are by the rise under their applicators, over the unpressed c there.
        Coupled applicators are taken as if each were alone.
        """
        assert self.tables is not None
        squares, (foam, _) = skin.squares(u), skin.parts.by_kind(cells, rises)
        mass, _, _ = self.terms(skin, cells, rises)
        touched = (mass.factors @ np.linalg.solve(skin.turn, u)) ** 2
        whole = squares @ (skin.unpressed_factors * skin.parts.resting) + touched.sum(axis=(0, 1))
        for cell, rise in zip(foam.cells.tolist(), foam.rises.tolist(), strict=True):
            y, step = self.tables.bases[cell] @ u, SLOPE_STEP * (1 + rise)
            ends = np.clip([rise - step, rise + step], 0.0, self.largest)
            C = np.diff(self._summed(skin, np.array([cell, cell]), ends), axis=0)[0]
            by_rise = np.einsum("rs,rf,sf->f", C, y, y) / np.ptp(ends)
            squares[:, cell] = by_rise / skin.unpressed_factors[cell]
        return squares, whole

    def uncertainty(self, skin: ReducedSkin, cells: Integer, rises: Real, s: Complex) -> Real:
        """Relative changes of Rs and Cp if c is higher by its whole uncertainty."""
        found = skin.solved(cells, rises, s)
        Y = np.stack([each for _, each in found])
        more = s * np.stack([self._uncertain_form(skin, cells, rises, u) for u, _ in found])
        Z, raised = (skin.combination.impedance(each) for each in (Y, Y + more))
        return both(relative_difference(raised, Z))

    def _uncertain_form(
        self, skin: ReducedSkin, cells: Integer, rises: Real, u: Complex
    ) -> Complex:
        """u'Eu, with E the uncertainty of M, F, shape (s,)."""
        assert self.tables is not None
        (cells, rises), on_mesh = skin.parts.by_kind(cells, rises)[0], skin.reduced.family.rises
        if on_mesh.coupled(cells):
            (press,) = on_mesh.press(cells, rises)
            return ((self._thin(skin, press.cells, press.uncertainty) @ u) ** 2).sum(axis=0)
        found, most = np.zeros(u.shape[1], dtype=complex), skin.unpressed_factors.max()
        for cell, rise in zip(cells, rises, strict=True):
            y = self.tables.bases[cell] @ u
            E = max(rise, MIN_RISE) * most * self.tables.uncertainties[cell]
            found += np.einsum("rs,rf,sf->f", E, y, y)
        return found

    def _thin(self, skin: ReducedSkin, cells: Integer, values: Real) -> Real:
        return skin.reduced.across_foam.thin(cells, skin.unpressed_factors, values)

    def _factors(self, skin: ReducedSkin, cells: Integer, rises: Real) -> Real:
        """F of each touch, which raises M by F'F, shape (touch, rank, N + n)."""
        foam, fingers = skin.parts.by_kind(cells, rises)
        power, turn = np.linalg.eigh(self._summed(skin, *foam))
        roots = np.sqrt(np.maximum(power, 0.0))
        thin = (turn * roots[:, None, :]).transpose(0, 2, 1)
        found = np.ascontiguousarray(thin @ skin.of_touches.bases[foam.cells])
        if not len(fingers.cells):
            return found
        found = _stacked(found, _of_fingers(skin, *fingers))
        back = np.argsort(np.argsort(cells >= skin.parts.foam, kind="stable"))
        return np.ascontiguousarray(found[back])

    def _summed(self, skin: ReducedSkin, cells: Integer, rises: Real) -> Real:
        """C of each touch, F, shape (touch, rank, rank), see `tables`."""
        matrices = skin.of_touches.matrices
        weights = np.zeros((len(cells), matrices.shape[1]))
        depth = self.applicators.depth(rises)
        for number in np.unique(cells):
            here = cells == number
            found = skin.reduced.family.rises.field(int(number)).at(depth[here])
            weights[here, : found.shape[1]] = found
        return np.einsum("tj,tjrs->trs", weights, matrices[cells])

    def _check(self, skin: ReducedSkin, rises: Real) -> None:
        """Raises InputError for rises outside the range of the applicators."""
        most = self.largest + 1
        if len(rises) and not (rises.min() >= 0 and rises.max() <= (most - 1) * (1 + BEYOND_RANGE)):
            raise InputError(
                f"{skin.reduced.parts.skin.name}: the factor under an applicator must be from 1 to "
                f"{most:.4g}, at {self.applicators.deepest:.4g} m, got {1 + rises.min():.4g} to "
                f"{1 + rises.max():.4g}"
            )


def _of_fingers(skin: ReducedSkin, cells: Integer, rises: Real) -> Real:
    """F of fingers. rises: capacitance of each finger, F."""
    roots = np.sqrt(rises * skin.unpressed_factors[cells])
    return roots[:, None, None] * (skin.reduced.factors[cells] @ skin.turn)


def _system(skin: ReducedSkin, mass: UnpressedMass) -> Skins:
    """System of presses that have factors of their own."""
    from ..small_system.lanczos import Skins

    return Skins.of_one(mass, np.ones(len(mass.factors)), skin.s, skin.krylov_rtol)


def _stacked(*factors: Real) -> Real:
    """Factors of touches one after the other, each padded with zeros to the largest rank."""
    rank = max(each.shape[1] for each in factors)
    return np.concatenate(
        [np.pad(each, ((0, 0), (0, rank - each.shape[1]), (0, 0))) for each in factors]
    )


def _groups(presses: Integer, starts: Integer) -> Iterator[Integer]:
    """Groups of presses with about TOUCHES_AT_ONCE touches each."""
    if not len(presses):
        return
    touches = np.cumsum(starts[presses + 1] - starts[presses])
    number = touches // TOUCHES_AT_ONCE
    for each in np.unique(number):
        yield presses[number == each]

"""Changes of M by applicators in a reduced basis: small matrices by depth modes and parts.

For each applicator the few combinations y = U u of the basis are kept that matter where it presses.
M rises by y'Cy there. C is a sum over modes, weighted by coefficients of depth, and over parts of
the foam, weighted by their unpressed c.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ....arrays import Integer, Real
from ....fem.circuit import Circuit
from ....mesh.domain import Domain
from ....mesh.refinement import finer
from ....press.press import Press
from ....progress import ProgressCallback, silent
from ....scene.parts import Skin
from ...heterogeneous.discretised import indicators, marked_cells
from ...heterogeneous.triangle_meshes import MAX_TRIANGLES, Triangles
from ...mechanics.deformation import Deformation
from ..cases import Case
from ..families.family import Mesh, Triangulation
from ..families.family_meshes import alone, coarsest
from .applicators import PixelApplicators, applicators
from .indentation_family import IndentationFamily, PressRise

MAX_SINGLE_PIXELS = 12
TURNS = 2


def family_on(
    skin: Skin, circuit: Circuit, mesh: Mesh, modes: int, known: PixelApplicators, rtol: float
) -> IndentationFamily:
    """Family on a mesh."""
    assert isinstance(mesh, Triangulation)
    return IndentationFamily(skin, circuit, mesh, modes, known, rtol)


def resolved(
    skin: Skin,
    circuit: Circuit,
    modes: int,
    rtol: float,
    cases: Sequence[Case],
    frequency: Real,
    progress: ProgressCallback = silent,
) -> tuple[IndentationFamily, float]:
    """Coarsest family whose discretisation keeps its share of the tolerance, and its error.

    frequency: Hz, ascending. progress: see `coarsest`. Raises ToleranceError if none does,
    InputError as `applicators` does.
    """
    known = applicators(skin, rtol)
    rise = float(known.mechanics.factor(np.array(known.deepest / known.thickness))) - 1
    pixels = np.flatnonzero(known.of_pixel >= 0)
    in_turns = [_in_turns(known, turn) for turn in np.ndindex(TURNS, TURNS)]
    meshes = _triangulations(skin, circuit, rtol, [e for e in in_turns if e], frequency)
    families = (family_on(skin, circuit, mesh, modes, known, rtol) for mesh in meshes)
    every = [*cases, *alone(pixels, rise, MAX_SINGLE_PIXELS)]
    return coarsest(families, every, rtol, frequency, progress)


def finer_families(
    family: IndentationFamily, cells: Integer, rises: Real, frequency: Real
) -> Iterator[IndentationFamily]:
    """Families on finer and finer meshes, for a press at frequencies in Hz."""
    depth = family.applicators.depth(rises)
    press = _pressed(family.applicators, dict(zip(cells.tolist(), depth.tolist(), strict=True)))
    given = family.skin, family.circuit
    for mesh in _triangulations(*given, family.rtol, [press], frequency, family.domain):
        yield family_on(*given, mesh, family.modes, family.applicators, family.rtol)


def _triangulations(
    skin: Skin,
    circuit: Circuit,
    rtol: float,
    presses: Sequence[Deformation],
    frequency: Real,
    domain: Domain | None = None,
) -> Iterator[Triangulation]:
    """Triangulations, each refined where the error of any press is largest on the one before.

    domain: mesh to refine first, which is not yielded itself; the coarsest mesh is first without
    it.
    """
    ends = np.unique(frequency[[0, -1]])
    bare = Triangles(skin, circuit, Press(), rtol)
    each = [Triangles(skin, circuit, Press(), rtol, press) for press in presses]

    def refined(domain: Domain) -> Domain:
        marked = [
            marked_cells(indicators(press.discretised(domain), ends).sum(axis=0)) for press in each
        ]
        return finer(domain, np.unique(np.concatenate(marked)))

    domain = bare.coarsest(float(ends[-1])) if domain is None else refined(domain)
    while domain.t.shape[1] <= MAX_TRIANGLES:
        yield Triangulation(domain, each[0].order)
        domain = refined(domain)


def _in_turns(known: PixelApplicators, turn: tuple[int, ...]) -> Deformation | None:
    """Press of every second pixel each way to the largest depth; None if there is no such pixel."""
    columns = known.skin.pixels.columns
    pixels = np.flatnonzero(known.of_pixel >= 0)
    row, column = np.divmod(pixels, columns)
    own = pixels[(row % TURNS == turn[0]) & (column % TURNS == turn[1])]
    if not len(own):
        return None
    return _pressed(known, dict.fromkeys(own.tolist(), known.deepest))


def _pressed(known: PixelApplicators, depth: dict[int, float]) -> Deformation:
    """Press of pixels to depths in m, each as if it were alone."""

    def w(x: Real) -> Real:
        flat = np.reshape(x, (2, -1))
        found = np.zeros(flat.shape[1])
        for pixel, own in depth.items():
            np.maximum(found, known.deflection(pixel, own, flat), out=found)
        return found.reshape(x.shape[1:])

    deepest = tuple(depth.values())
    return Deformation(
        known.mechanics, known.thickness, w, deepest, (0.0,) * len(deepest), 0.0, (), None
    )


DROPPED = 5e-3
"""Combinations with less than this share of the tolerance times the first one's energy in an
applicator's foam are left out."""


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


def tables(family: IndentationFamily, W: Real, size: Real, rtol: float) -> Tables:
    """Tables of all pixels.

    W: basis in the full space, shape (inner + N, N + n). size: typical size of coordinates, V,
    shape (N + n,). rtol: the tolerance.
    """
    potentials = FoamPotentials(family, W)
    found = {k: _of_pixel(family, potentials, k, size, rtol) for k in family.pressable.tolist()}
    count, m = len(family.applicators.of_pixel), W.shape[1]
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
    family: IndentationFamily, potentials: FoamPotentials, pixel: int, size: Real, rtol: float
) -> tuple[Real, Integer, Real, Real]:
    field = family.field(pixel)
    weights = potentials.weights(field.cells)
    D = potentials.potentials(field.cells) * size
    most = np.tensordot(field.coefficients[-1], field.modes, axes=1)
    heavy = D * np.sqrt(weights * np.maximum(most, 0.0))[..., None]
    flat = heavy.reshape(-1, len(size))
    power, turn = np.linalg.eigh(flat.T @ flat)
    turn = turn[:, power > DROPPED * rtol * power[-1]]
    local = D @ turn
    parts, place = np.unique(family.part_of[field.cells], return_inverse=True)
    matrices = np.zeros((len(parts), len(field.modes), turn.shape[1], turn.shape[1]))
    for part in range(len(parts)):
        a = local[place == part].reshape(-1, turn.shape[1])
        for mode, g in enumerate(field.modes):
            weight = (weights * g)[place == part].ravel()
            matrices[part, mode] = (a.T * weight) @ a
    a = local.reshape(-1, turn.shape[1])
    uncertainties = (a.T * (weights * field.uncertainty).ravel()) @ a
    return turn.T / size, parts, matrices, uncertainties


class FoamPotentials:
    """Potentials of a basis across the foam, at the points of a family's rule."""

    def __init__(self, family: IndentationFamily, W: Real) -> None:
        """W: shape (inner + N, N + n)."""
        self._family = family
        spread = family.space.spread(W)
        self._values = np.vstack([spread, np.zeros((1, W.shape[1]))])

    def potentials(self, cells: Integer) -> Real:
        """Potentials across the foam, V, shape (cell, point, N + n)."""
        family = self._family
        elements, number = family.elements, family.system.unknowns.number
        dofs = elements.trial.dofs.element_dofs[:, cells]
        first, *others = (self._values[of_field[dofs]] for of_field in number)
        across = first - others[0] if others else first
        return np.einsum("fp,fcm->cpm", elements.rule.values, across, optimize=True)

    def weights(self, cells: Integer) -> Real:
        """Unpressed capacitance of the rule's points, F, shape (cell, point)."""
        family = self._family
        area = family.elements.surface.some(cells).area * family.elements.rule.weights
        return family.unpressed_capacitance[cells] * area

    def thin(self, press: PressRise, rest: Real, values: Real) -> Real:
        """F of the rise F'F of M, shape (rank, N + n).

        values: rise of c over the unpressed c, shape (cell, point).
        """
        of_parts = rest[self._family.part_of[press.cells]][:, None]
        weights = self.weights(press.cells) * of_parts * np.maximum(values, 0.0)
        D = self.potentials(press.cells) * np.sqrt(weights)[..., None]
        flat = D.reshape(-1, D.shape[-1])
        power, turn = np.linalg.eigh(flat.T @ flat)
        kept = power > ROUNDING * power[-1]
        return np.sqrt(power[kept])[:, None] * turn[:, kept].T


ROUNDING = 1e-15

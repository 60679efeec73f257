"""Greedy reduction of a scene's family to a small real basis.

It is greedy over skins, presses and frequencies. The first vectors come from snapshots of a sample
of presses at real shifts, compressed by their energy in K. Then fresh draws come in batches. The
draws with the worst certificates add what the basis lacks, until the certificates of enough fresh
draws keep the tolerance.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag
from scipy.sparse import csc_matrix

from ...arrays import Real
from ...fem.factors import one_blas_thread, without_zeros
from ...fem.galerkin import Galerkin
from ...fem.lanczos import potentials_of_all
from ...fem.system import check_grid_fits
from ...progress import ProgressCallback, silent
from ...scene.contacts import Interface
from ...scene.frequency import laplace_variable
from ...scene.parts import SceneParts
from ...sweeps import ToleranceError
from ..heterogeneous.elements_model import circuit_of
from ..heterogeneous.pressed_system import check_surroundings
from .cases import Case, Draw, by_skin, covering, pixel_touches, sharing_skins
from .certificate import largest_bounds
from .compressing import COMPRESSED_SHARE, compressed, sizes
from .depth_touches import DepthTouches
from .family import Family
from .family_meshes import resolved, weights_of_case
from .reduced_model import Reduced
from .touches import FACTORS, spreading

IDLE_DRAWS = 50
"""Number of useless draws in a row after which the first sample is complete, see `covering`."""
AT_ONCE, PRESSES_ON_SKIN = 64, 8
BATCH = 32
MIN_QUIET_CASES, MAX_QUIET_CASES = 64, 192
LARGEST = 1200
TRAINING = "training a reduced model"
"""Label of the reduction's progress."""
MESH_DRAWS = 4
FURTHER_FREQUENCIES = 2
SNAPSHOT_SHARE = 0.1
"""Error of snapshots in the norm of K, over the part of them that may be dropped."""
WORTH_ADDING = 0.1
"""Largest missing energy of a snapshot after vectors are added, over that before, at any
tolerance."""
CERTIFIED_SHARE, NEAR = 0.7, 0.5
TRAINED_SHARE = 1e-4
"""Share of a factor's energy that is omitted while the basis grows, over what `compressed` may
omit."""
DROPPED_SHARE = 0.1
"""A snapshot of unit energy may lose this share of the tolerance as energy."""
ESSENCE_SHARE = 1e-4
"""Compression within one skin may take this share of the energy that a snapshot may lose."""

NOTHING_CHARGED = 1e-24
"""Smallest energy of a snapshot over that of 1 V in a sheet. Less is rounding: the excitation
charges nothing, for example both terminals against an earth that nothing has a capacitance to."""

Shared = tuple[Real, Real]
"""Vectors in the inner unknowns, shape (inner, k), and the coefficients of snapshots in these,
shape (k, snapshot)."""


def reduce(
    parts: SceneParts,
    rtol: float = 1e-5,
    draw: Draw | None = None,
    *,
    modes: int = 1,
    same_sheets: bool = True,
    seed: int = 0,
    progress: ProgressCallback = silent,
    frequency: Real | None = None,
    readings: Sequence[Interface] | None = None,
    by_depth: bool | None = None,
) -> Reduced:
    """Reduced model of a scene, within rtol in Rs and Cp for skins and presses as drawn.

    draw: draws the cases that the model is trained on, by default one or two touched pixels. modes:
    number of modes of each sheet's conductance, see `parameters.HALF_WAVES`. same_sheets: True if
    both sheets vary in the same way, so that one field may serve. frequency: Hz, ascending; by
    default those of the scene's sweep. readings: interfaces whose excitations drive two fields; by
    default those of the scene. by_depth: True if pixels are pressed by depth or force; by default
    as the scene presses them. Raises ToleranceError if the mesh or the basis does not reach rtol,
    InputError if the pixels do not fit in memory.
    """
    check_surroundings(parts.skin)
    spread = spreading(parts.skin, parts.plan.press, by_depth)
    parts = parts if spread else parts.evened
    skin, setup = parts.skin, parts.setup
    circuit = circuit_of(skin, setup, same_sheets)
    circuit = circuit if readings is None else circuit.read(readings)
    check_grid_fits(skin, circuit)
    random, f = np.random.default_rng(seed), setup.frequency if frequency is None else frequency
    progress(TRAINING, 0.0)
    with one_blas_thread():
        touches = DepthTouches.of(skin, rtol) if spread else FACTORS
        draw = touches.draws(draw or pixel_touches(skin, parts.plan), skin)
        cases = [draw(random) for _ in range(MESH_DRAWS)]
        known = skin, circuit, modes, rtol, cases, f, touches, progress
        family, mesh_error = resolved(*known)
        return GreedyBasis(parts, family, rtol, mesh_error, f).grow(draw, random, progress)


class GreedyBasis:
    """Growing basis of a family's space, orthonormal in K."""

    def __init__(
        self,
        parts: SceneParts,
        family: Family,
        rtol: float,
        mesh_error: float,
        frequency: Real,
    ) -> None:
        """parts: with the skin of the family. frequency: Hz, ascending; the basis serves all from
        the first to the last.
        """
        self.parts, self.family, self.rtol, self.mesh_error = parts, family, rtol, mesh_error
        self.frequency, loss = frequency, family.skin.foam.loss
        self.vectors: Real = np.zeros((family.space.inner, 0))
        low, high = float(frequency[0]), float(frequency[-1])
        decades = max(4, math.ceil(math.log10(high / low)) + 1)
        self._shifts = np.abs(laplace_variable(np.geomspace(low, high, decades), loss))
        self._certified = np.geomspace(low, high, decades + FURTHER_FREQUENCIES)
        self._most, self._K = 0.0, without_zeros(family.space.K)
        self._sheets = [without_zeros(family.space.restricted(each)) for each in family.sheet_terms]
        self._projected: list[Real] = [np.zeros((0, 0)) for _ in self._sheets]

    def grow(
        self,
        draw: Draw,
        random: np.random.Generator,
        progress: ProgressCallback,
        most: int = MAX_QUIET_CASES,
    ) -> Reduced:
        """Adds vectors until enough fresh draws in a row keep the tolerance.

        The tolerance of the basis is what the mesh leaves of rtol. most: number of fresh draws that
        is always enough.
        """
        pixels, left = self.family.skin.pixels, self.rtol - self.mesh_error
        limit, cells = CERTIFIED_SHARE * left, pixels.rows * pixels.columns
        first = sharing_skins(covering(draw, random, cells, IDLE_DRAWS), PRESSES_ON_SKIN)
        for start in range(0, len(first), AT_ONCE):
            self._add(first[start : start + AT_ONCE])
        quiet, reduced, begun, roughly = 0, self._reduced(), 0.0, True
        while quiet < min(max(MIN_QUIET_CASES, cells // 2), most):
            cases = [draw(random) for _ in range(BATCH)]
            roughly = roughly and any(case.variation is not None for case in cases)
            cases = sharing_skins(cases, PRESSES_ON_SKIN) if roughly else cases
            found = largest_bounds(reduced, cases, self._certified)
            begun = max(begun, float(np.nan_to_num(found).max()), 2 * limit)
            progress(TRAINING, _done(found.max(), begun, limit))
            if found.max() <= limit:
                quiet, roughly = quiet + (0 if roughly else BATCH), False
                continue
            self._add([cases[k] for k in np.flatnonzero(~(found <= NEAR * limit))])
            quiet, reduced = 0, self._reduced()
            if reduced.size > LARGEST:
                raise ToleranceError(
                    f"the reduced model leaves an error of {found.max():.1e} with {reduced.size} "
                    f"vectors, tolerance {self.rtol:g}"
                )
        reduced = self.family.touches.in_basis(reduced)
        return compressed(reduced, [draw(random) for _ in range(BATCH)])

    def _add(self, cases: list[Case]) -> None:
        """Adds the relevant components of these cases' snapshots outside the basis."""
        found, shares = map(list, zip(*self._snapshots(cases), strict=True))
        found, share = self._beyond(np.hstack(found)), np.asarray(block_diag(*shares), dtype=float)
        root = _root(found.T @ (self._K @ found))
        axes, power, turn = np.linalg.svd(root @ share, full_matrices=False)
        axes, power, turn = axes[:, ::-1], power[::-1], turn[::-1]
        lost = np.cumsum((power[:, None] * turn) ** 2, axis=0).max(axis=1)
        kept = lost > min(DROPPED_SHARE * self.rtol, WORTH_ADDING * lost[-1])
        new = found @ np.linalg.lstsq(root, axes[:, kept], rcond=None)[0]
        for _ in range(2):
            new = self._beyond(new)
            new = np.linalg.solve(np.linalg.cholesky(new.T @ (self._K @ new)), new.T).T
        self.vectors = np.hstack([self.vectors, new]).astype(np.float64)

    def _beyond(self, found: NDArray) -> Real:
        """Components that are orthogonal to the basis in K."""
        return found - self.vectors @ (self.vectors.T @ (self._K @ found))

    def _snapshots(self, cases: list[Case]) -> Iterator[Shared]:
        """Snapshots at the shifts, each of unit energy, as sums of few vectors.

        They are deviations from the lifted terminals' potentials.
        """
        for group in by_skin(cases, self.family.skin):
            space = self.family.space_of(weights_of_case(self.family, cases[group[0]]))
            for start in range(0, len(group), PRESSES_ON_SKIN):
                some = [cases[k] for k in group[start : start + PRESSES_ON_SKIN]]
                yield self._essence(self._at_shifts(space, some))

    def _essence(self, snapshots: Real) -> Shared:
        """Few vectors, orthonormal in K, that represent snapshots to the accuracy of these."""
        power, turn = np.linalg.eigh(snapshots.T @ (self._K @ snapshots))
        lost = np.cumsum(np.maximum(power, 0.0) * turn**2, axis=1).max(axis=0)
        kept = lost > ESSENCE_SHARE * DROPPED_SHARE * self.rtol
        size = np.sqrt(power[kept])
        return snapshots @ (turn[:, kept] / size), size[:, None] * turn[:, kept].T

    def _at_shifts(self, space: Galerkin, cases: list[Case]) -> Real:
        family, rtol = self.family, SNAPSHOT_SHARE * math.sqrt(DROPPED_SHARE * self.rtol)
        drives = family.circuit.excitations
        masses = [family.mass_inside(family.amounts(case)) for case in cases]
        pencils = space.pencils(masses, drives)
        found = [self._deviation(each) for each in potentials_of_all(pencils, self._shifts, rtol)]
        energies = [(each * (self._K @ each)).sum(axis=0) for each in found]
        self._most = max(self._most, *(math.sqrt(energy.max()) for energy in energies))
        none = NOTHING_CHARGED * max(family.circuit.conductance)
        charged = [energy > none for energy in energies]
        unit = [
            each[:, some] / np.sqrt(energy[some])
            for each, energy, some in zip(found, energies, charged, strict=True)
        ]
        if space is family.space:
            return np.hstack(unit)
        for k, drive in enumerate(drives):
            most = (energy.max() for energy in energies[k :: len(drives)])
            least = min((energy for energy in most if energy > none), default=np.inf)
            driven = space.driven(drive)
            at_zero = self._deviation(np.column_stack([driven.potential, driven.floating]))
            unit.append(at_zero / np.sqrt(least))
        return np.hstack(unit)

    def _deviation(self, u: Real) -> Real:
        inner = self.family.space.inner
        return u[:inner] - self.family.space.lift[:inner] @ u[inner:]

    def _reduced(self) -> Reduced:
        """Reduced model in the present basis."""
        family = self.family
        reduced = Reduced(
            parts=self.parts,
            circuit=family.circuit,
            mesh=family.mesh,
            modes=family.modes,
            rtol=self.rtol,
            mesh_error=self.mesh_error,
            frequency=self.frequency,
            terminal_field=family.space.terminal_field,
            conductance=family.space.conductance,
            basis=self.vectors,
            stiffness=np.zeros((0, 0, 0)),
            factors=np.zeros((0, 0, 0)),
            built=family,
        )
        W = reduced.coordinates
        self._projected = [
            _extended(known, W, term)
            for known, term in zip(self._projected, self._sheets, strict=True)
        ]
        films = [family.space.film_energy(W, term) for term in family.film_terms]
        size = sizes(len(family.space.conductance), self.vectors.shape[1], self._most)
        parts, share = family.parts, TRAINED_SHARE * COMPRESSED_SHARE * self.rtol
        factors = family.masses.factors(W, size, share, parts)
        fixed = [*family.masses.energies(W, slice(parts.touched, None))]
        if family.far_inside is not None:
            far = family.far_inside.T @ W
            fixed[-1] = fixed[-1] + far.T @ far
        reduced = replace(reduced, stiffness=np.stack([*self._projected, *films]), factors=factors)
        return replace(reduced, fixed=np.stack(fixed)) if fixed else reduced


def _extended(known: Real, W: Real, term: csc_matrix) -> Real:
    """W'TW of a symmetric term T, of which that of the first columns of W is known."""
    first = len(known)
    new = W.T @ (term @ W[:, first:])
    return np.block([[known, new[:first]], [new[:first].T, new[first:]]])


def _root(gram: Real) -> Real:
    """R with R'R equal to a Gram matrix, whose vectors may be linearly dependent."""
    power, turn = np.linalg.eigh(gram)
    return np.sqrt(np.maximum(power, 0.0))[:, None] * turn.T


def _done(error: float, begun: float, limit: float) -> float:
    """Progress from a first error down to a limit by decades, 0 to 1."""
    left = max(np.nan_to_num(error, nan=begun), limit)
    way = np.log(begun) - np.log(limit)
    return float(np.clip((np.log(begun) - np.log(left)) / way, 0.0, 1.0))

"""Reduction of a scene's family to a small real basis, greedily over skins, presses, frequencies.

The first vectors come from a sample of presses at real shifts, compressed by their energy in K;
then, batch by batch, the draws whose certificates are worst add what the basis lacks, until fresh
draws keep the tolerance.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from simulator.circuit import Circuit, one_field, two_fields
from simulator.estimate import relative_difference
from simulator.family import Family
from simulator.frequency import laplace_variable
from simulator.ladder import Ladder
from simulator.lanczos import potentials
from simulator.press import Press, Touch
from simulator.reduced import Reduced, ReducedSkin
from simulator.scene import Scene
from simulator.sheet import one_blas_thread
from simulator.sweeps import ToleranceError
from simulator.variation import Variation

SHARE = 0.5
"""Of the tolerance, for the mesh; the rest is for the basis."""
FIRST_DRAWS, MOST_FIRST_DRAWS, AT_ONCE = 6, 4000, 100
BATCH = 32
FEWEST_QUIET, MOST_QUIET = 64, 192
LARGEST = 1200
MESH_DRAWS = 4
FREQUENCIES = 6
SNAPSHOT_RTOL = 1e-6
WORTH_ADDING = 0.3
"""Of the most that any of the worst cases lacks: so much is added whatever the tolerance."""
CERTIFIED_SHARE = 0.7
COMPRESSED_SHARE = 0.01
DROPPED_SHARE = 0.1
"""Of the tolerance: what any snapshot of unit energy may lose of that."""


@dataclass(frozen=True)
class Case:
    """A press on a skin of the family: the touched pixels and by how much c rises there.

    variation: None for the scene's own skin. cells: row * columns + column, from 0.
    """

    variation: Variation | None
    cells: NDArray[np.int64]
    rises: NDArray[np.float64]


Draw = Callable[[np.random.Generator], Case]


def pixel_touches(scene: Scene, factor: tuple[float, float] = (1.0, 3.0), most: int = 2) -> Draw:
    """One or several pixels pressed at random on the scene's own skin, factors within a range."""
    pixels = scene.pixels.rows * scene.pixels.columns

    def draw(random: np.random.Generator) -> Case:
        touches = random.integers(1, min(most, pixels), endpoint=True)
        cells = random.choice(pixels, touches, replace=False)
        return Case(None, cells, random.uniform(*factor, touches) - 1)

    return draw


def reduce(
    scene: Scene,
    rtol: float = 1e-5,
    draw: Draw | None = None,
    *,
    modes: int = 1,
    alike: bool = True,
    seed: int = 0,
) -> Reduced:
    """A reduced model of a scene, within rtol in Rs and Cp for skins and presses as drawn.

    draw: of what the model is trained on, by default one or two touched pixels. modes: of each
    sheet's conductance, see `variation.WAVES`. alike: whether both sheets vary in the same way, so
    that one field may serve. Raises ToleranceError where mesh or basis do not get there.
    """
    draw = draw or pixel_touches(scene)
    circuit = (one_field(scene) if alike else None) or two_fields(scene)
    random = np.random.default_rng(seed)
    with one_blas_thread():
        family, mesh_error = _resolved(scene, circuit, modes, rtol, draw, random)
        return _Basis(family, rtol, mesh_error).grow(draw, random)


def _resolved(
    scene: Scene,
    circuit: Circuit,
    modes: int,
    rtol: float,
    draw: Draw,
    random: np.random.Generator,
) -> tuple[Family, float]:
    """The coarsest family whose discretisation keeps its share of the tolerance, and its error."""
    ladder = Ladder(scene, circuit)
    cases = [draw(random) for _ in range(MESH_DRAWS)]
    press = _everywhere(scene, max(float(case.rises.max(initial=0)) for case in cases))
    for level in range(ladder.first(rtol), len(ladder.levels)):
        resolution = ladder.resolution(level, press, scene.frequencies[-1])
        family = Family(scene, circuit, resolution, modes)
        error = max(family.solved(case.variation, _map(case, scene), rtol)[1] for case in cases)
        if error <= SHARE * rtol:
            return family, error
    raise ToleranceError(f"the mesh of the reduced model does not reach {rtol:g}: {error:.1e}")


def _everywhere(scene: Scene, rise: float) -> Press:
    pixels = np.ndindex(scene.pixels.rows, scene.pixels.columns)
    return Press(tuple(Touch(i + 1, j + 1, 1 + rise) for i, j in pixels))


def _map(case: Case, scene: Scene) -> NDArray[np.float64]:
    """c over the scene's own at rest, shape (row, column)."""
    factors = np.ones(scene.pixels.rows * scene.pixels.columns)
    np.add.at(factors, case.cells, case.rises)
    rest = 1.0 if case.variation is None else case.variation.capacitance
    return factors.reshape(scene.pixels.rows, scene.pixels.columns) * rest


class _Basis:
    """Vectors of a family's space, orthonormal in K, growing."""

    def __init__(self, family: Family, rtol: float, mesh_error: float) -> None:
        self.family, self.rtol, self.mesh_error = family, rtol, mesh_error
        self.vectors: NDArray[np.float64] = np.zeros((family.space.inner, 0))
        scene, loss = family.scene, family.scene.skin.foam.loss
        low, high = float(scene.frequencies[0]), float(scene.frequencies[-1])
        decades = max(4, math.ceil(math.log10(high / low)) + 1)
        self._shifts = np.abs(laplace_variable(np.geomspace(low, high, decades), loss))
        self._s = laplace_variable(np.geomspace(low, high, FREQUENCIES), loss)
        self._pixels = family.pixel_factors()

    def grow(self, draw: Draw, random: np.random.Generator) -> Reduced:
        """Until enough fresh draws in a row keep what the mesh leaves of the tolerance."""
        pixels, left = self.family.scene.pixels, self.rtol - self.mesh_error
        first = min(FIRST_DRAWS * pixels.rows * pixels.columns, MOST_FIRST_DRAWS)
        for start in range(0, first, AT_ONCE):
            self._add([draw(random) for _ in range(min(AT_ONCE, first - start))])
        quiet, reduced = 0, self._reduced()
        enough = min(max(FEWEST_QUIET, pixels.rows * pixels.columns // 2), MOST_QUIET)
        while quiet < enough:
            cases = [draw(random) for _ in range(BATCH)]
            bounds = self._bounds(reduced, cases)
            quiet += BATCH
            bad = np.flatnonzero(~(bounds <= CERTIFIED_SHARE * left))
            if bad.size:
                self._add([cases[k] for k in bad])
                quiet, reduced = 0, self._reduced()
            if reduced.size > LARGEST:
                told = f"{bounds.max():.1e} with {reduced.size} vectors"
                raise ToleranceError(f"the scene does not reduce to {self.rtol:g}: {told}")
        return compressed(reduced, [draw(random) for _ in range(BATCH)])

    def _add(self, cases: list[Case]) -> None:
        """What the snapshots of these cases have beyond the basis, as far as it matters."""
        found = np.hstack([self._snapshots(case) for case in cases])
        found = self._beyond(self._beyond(found))
        power, turn = np.linalg.eigh(found.T @ (self.family.space.K @ found))
        lost = np.cumsum(np.maximum(power, 0.0) * turn**2, axis=1).max(axis=0)
        kept = lost > min(DROPPED_SHARE * self.rtol, WORTH_ADDING * lost[-1])
        new = found @ (turn[:, kept] / np.sqrt(power[kept]))
        for _ in range(2):
            new = self._beyond(new)
            new = np.linalg.solve(np.linalg.cholesky(new.T @ (self.family.space.K @ new)), new.T).T
        self.vectors = np.hstack([self.vectors, new]).astype(np.float64)

    def _beyond(self, found: NDArray) -> NDArray[np.float64]:
        """What is K-orthogonal to the basis."""
        return found - self.vectors @ (self.vectors.T @ (self.family.space.K @ found))

    def _snapshots(self, case: Case) -> NDArray[np.float64]:
        """Deviations from the lifted terminals' potentials at the shifts, each of unit energy."""
        family = self.family
        space, mass = family.skin(case.variation), family.mass(_map(case, family.scene))
        found = []
        for drive in family.circuit.drives:
            pencil, driven = space.pencil(mass, drive, 0.0), space.driven(drive)
            at_shifts = self._deviation(potentials(pencil, self._shifts, SNAPSHOT_RTOL))
            energy = (at_shifts * (family.space.K @ at_shifts)).sum(axis=0)
            found.append(at_shifts / np.sqrt(energy))
            if case.variation is not None:
                at_zero = np.column_stack([driven.potential, driven.floating])
                found.append(self._deviation(at_zero) / np.sqrt(energy.max()))
        return np.hstack(found)

    def _deviation(self, u: NDArray[np.float64]) -> NDArray[np.float64]:
        inner = self.family.space.inner
        return u[:inner] - self.family.space.lift[:inner] @ u[inner:]

    def _bounds(self, reduced: Reduced, cases: list[Case]) -> NDArray[np.float64]:
        """The certificate of each case, the largest over a few frequencies."""
        skins = _skins(reduced, cases)
        pairs = zip(skins, cases, strict=True)
        return np.array([s.certificate(c.cells, c.rises, self._s).max() for s, c in pairs])

    def _reduced(self) -> Reduced:
        """The model as it now is."""
        family = self.family
        reduced = Reduced(
            scene=family.scene,
            circuit=family.circuit,
            resolution=family.resolution,
            modes=family.modes,
            rtol=self.rtol,
            mesh_error=self.mesh_error,
            terminal_field=family.space.terminal_field,
            conductance=family.space.conductance,
            basis=self.vectors,
            stiffness=np.zeros((0, 0, 0)),
            factors=np.zeros((0, 0, 0)),
            built=family,
        )
        W = reduced.coordinates
        terms = [family.space.sheet_energy(W, term) for term in family.sheet_terms]
        terms += [family.space.film_energy(W, term) for term in family.film_terms]
        factors = [F @ W[own] for own, F in self._pixels]
        return replace(reduced, stiffness=np.stack(terms), factors=np.stack(factors))


def compressed(reduced: Reduced, cases: list[Case]) -> Reduced:
    """The same with pixels' factors of lower rank, as far as that leaves these cases unchanged."""
    exact = _impedances(reduced, cases)
    omega = 2 * np.pi * reduced.scene.frequencies
    share = COMPRESSED_SHARE * reduced.rtol
    while True:
        candidate = replace(reduced, factors=_of_lower_rank(reduced, share))
        change = relative_difference(_impedances(candidate, cases), exact, omega)
        if change.max() <= COMPRESSED_SHARE * reduced.rtol:
            return candidate
        share *= 0.1


def _skins(reduced: Reduced, cases: list[Case]) -> Iterator[ReducedSkin]:
    """The skin of each case; that of the scene is set up once."""
    own = reduced.skin(None)
    return (own if c.variation is None else reduced.skin(c.variation) for c in cases)


def _impedances(reduced: Reduced, cases: list[Case]) -> NDArray[np.complex128]:
    return np.concatenate(
        [
            skin.sweeps(case.cells, case.rises, np.array([0, len(case.cells)]))
            for skin, case in zip(_skins(reduced, cases), cases, strict=True)
        ]
    )


def _of_lower_rank(reduced: Reduced, share: float) -> NDArray[np.float64]:
    """Each pixel's factor without what adds less than a share of its energy.

    Potentials are weighed as they are: 1 V at terminals, as much as the skin at rest has of the
    basis.
    """
    skin = reduced.skin(None)
    none = np.zeros(0, dtype=np.int64)
    at_rest = np.hstack([u for u, _ in skin.solved(none, np.zeros(0), skin.s)])
    terminals = len(reduced.conductance)
    size = np.full(len(at_rest), np.linalg.norm(at_rest[terminals:], axis=0).max())
    size[:terminals] = 1.0
    _, power, right = np.linalg.svd(reduced.factors * size, full_matrices=False)
    rank = int((power**2 > share * power[:, :1] ** 2).sum(axis=1).max())
    return power[:, :rank, None] * right[:, :rank] / size

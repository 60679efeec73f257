"""Deflections on one mesh of triangles, cached for other depths at the same place."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .contact import ApplicatorLoads, Equilibrium, Newton, equilibrium, nearby_equilibrium
from .contact_mesh import ContactMesh
from .membrane import Membrane, MembraneSurface

LEFT = 1e-4
"""Share of the tolerance that the last step may change of a deflection that starts from cached
ones."""
NEAREST, STEADY = 4, 10.0
"""Number of cached deflections for a first guess, and the largest sum of the sizes of their
weights: a larger sum magnifies their errors more."""
MAX_CACHED_DEFLECTIONS = 16


@dataclass(frozen=True)
class DeflectionLevel:
    """A deflection on one mesh.

    held: number of the applicator that clamps each node, -1 for none. surface: deflection anywhere.
    refined: True if the mesh is finer than the first.
    """

    ground: ContactMesh
    membrane: Membrane
    held: NDArray[np.int64]
    rest: Equilibrium
    surface: MembraneSurface
    refined: bool


class DeflectionCache:
    """What presses of one place leave to the next one: the latest mesh, the latest deflections on
    it and the factors of a Newton step. Nothing before the first."""

    def __init__(self) -> None:
        self.level: DeflectionLevel | None = None
        self._known: dict[float, Equilibrium] = {}
        self._newton: Newton | None = None
        self._held = self._by_force = np.empty(0, np.int64)

    @property
    def ground(self) -> ContactMesh | None:
        """The latest mesh."""
        return self.level.ground if self.level else None

    @property
    def nodes(self) -> int:
        """Of that mesh."""
        return len(self.level.held) if self.level else 0

    def keep(self, level: DeflectionLevel, pushed: ApplicatorLoads) -> None:
        """For the next press."""
        before, self.level = self.level, level
        same = before is not None and before.membrane is level.membrane
        if not same:
            self._known = {}
        if level.rest.newton or not same:
            self._newton = level.rest.newton
            self._held, self._by_force = level.held, pushed.by_force
        key = _key(pushed)
        if key is not None:
            self._known[key] = replace(level.rest, newton=None)
            while len(self._known) > MAX_CACHED_DEFLECTIONS:
                del self._known[next(iter(self._known))]

    def start(self, level: DeflectionLevel, pushed: ApplicatorLoads) -> NDArray[np.float64]:
        """A first guess at the deflection, m, shape (node,): through those known of one applicator,
        by its depth or its force, and through that at rest."""
        key = _key(pushed)
        alike = [known for known in self._known if key is not None and known * key > 0]
        if key is None or not alike:
            return level.rest.w
        near = sorted([0.0, *alike], key=lambda known: abs(known - key))[:NEAREST]
        shares = lagrange(np.array(near), key)
        while np.abs(shares).sum() > STEADY:
            near.pop()
            shares = lagrange(np.array(near), key)
        start = np.zeros_like(level.rest.w)
        for share, known in zip(shares, near, strict=True):
            if known:
                start += share * self._known[known].w
        return np.clip(start, 0.0, np.nanmax(pushed.depth, initial=0.0) or None)

    def pressed(
        self,
        level: DeflectionLevel,
        held: NDArray[np.int64],
        pushed: ApplicatorLoads,
        start: NDArray[np.float64],
        rtol: float,
    ) -> DeflectionLevel:
        """Otherwise on the mesh of a level that was kept. rtol: of the factor anywhere."""
        body, key = level.membrane, _key(pushed)
        rest = None if key is None else self._known.get(key)
        if rest is None and self._serves(held, pushed) and self._newton is not None:
            rest = nearby_equilibrium(body, held, pushed, start, self._newton, LEFT * rtol)
        if rest is None:
            rest = equilibrium(body, held, pushed, start)
        return replace(level, held=held, rest=rest, surface=level.surface.of(rest.w), refined=True)

    def _serves(self, held: NDArray[np.int64], pushed: ApplicatorLoads) -> bool:
        """Whether the factors are of the same free points."""
        alike = np.array_equal(pushed.by_force, self._by_force)
        return alike and np.array_equal(held, self._held)


def _key(pushed: ApplicatorLoads) -> float | None:
    """Depth or force of one applicator, the latter below zero; None where there are several."""
    if len(pushed.depth) > 1:
        return None
    depth, force = float(pushed.depth[0]), float(pushed.force[0])
    return -force if np.isnan(depth) else depth


def lagrange(nodes: NDArray[np.float64], x: float) -> NDArray[np.float64]:
    """Weights of Lagrange's polynomials through any few nodes, shape (node,)."""
    others = ~np.eye(len(nodes), dtype=bool)
    ratios = (x - nodes) / np.where(others, nodes[:, None] - nodes, 1.0)
    return np.where(others, ratios, 1.0).prod(axis=1)

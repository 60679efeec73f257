"""Deflections on one mesh of triangles, cached for other depths at the same place."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ...arrays import Integer, Real
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

    clamped: number of the applicator that clamps each node, -1 for none, shape (node,). surface:
    deflection at any position. refined: True if the mesh is finer than the first.
    """

    contact: ContactMesh
    membrane: Membrane
    clamped: Integer
    solution: Equilibrium
    surface: MembraneSurface
    refined: bool


class DeflectionCache:
    """Cache for presses at one place: the latest mesh, deflections on it, factors of a Newton step.

    It is empty before the first press.
    """

    def __init__(self) -> None:
        self.level: DeflectionLevel | None = None
        self._known: dict[float, Equilibrium] = {}
        self._newton: Newton | None = None
        self._clamped = self._by_force = np.empty(0, np.int64)

    @property
    def contact(self) -> ContactMesh | None:
        """The latest mesh."""
        return self.level.contact if self.level else None

    @property
    def nodes(self) -> int:
        """Number of nodes of the latest mesh; 0 before the first press."""
        return len(self.level.clamped) if self.level else 0

    def keep(self, level: DeflectionLevel, loads: ApplicatorLoads) -> None:
        """Cache a level for the next press."""
        before, self.level = self.level, level
        same = before is not None and before.membrane is level.membrane
        if not same:
            self._known = {}
        if level.solution.newton or not same:
            self._newton = level.solution.newton
            self._clamped, self._by_force = level.clamped, loads.by_force
        key = _key(loads)
        if key is not None:
            self._known[key] = replace(level.solution, newton=None)
            while len(self._known) > MAX_CACHED_DEFLECTIONS:
                del self._known[next(iter(self._known))]

    def start(self, level: DeflectionLevel, loads: ApplicatorLoads) -> Real:
        """First guess of the deflection, m, shape (node,).

        For one applicator it interpolates by depth, or by force, between cached deflections and the
        unpressed skin. Otherwise it is the deflection of the level.
        """
        key = _key(loads)
        same_kind = [known for known in self._known if key is not None and known * key > 0]
        if key is None or not same_kind:
            return level.solution.w
        near = sorted([0.0, *same_kind], key=lambda known: abs(known - key))[:NEAREST]
        shares = lagrange(np.array(near), key)
        while np.abs(shares).sum() > STEADY:
            near.pop()
            shares = lagrange(np.array(near), key)
        start = np.zeros_like(level.solution.w)
        for share, known in zip(shares, near, strict=True):
            if known:
                start += share * self._known[known].w
        return np.clip(start, 0.0, np.nanmax(loads.depth, initial=0.0) or None)

    def pressed(
        self,
        level: DeflectionLevel,
        clamped: Integer,
        loads: ApplicatorLoads,
        start: Real,
        rtol: float,
    ) -> DeflectionLevel:
        """Level of another press on the mesh of a cached level.

        rtol: tolerance of the factor anywhere.
        """
        body, key = level.membrane, _key(loads)
        solution = None if key is None else self._known.get(key)
        if solution is None and self._serves(clamped, loads) and self._newton is not None:
            solution = nearby_equilibrium(body, clamped, loads, start, self._newton, LEFT * rtol)
        if solution is None:
            solution = equilibrium(body, clamped, loads, start)
        return replace(
            level,
            clamped=clamped,
            solution=solution,
            surface=level.surface.of(solution.w),
            refined=True,
        )

    def _serves(self, clamped: Integer, loads: ApplicatorLoads) -> bool:
        """True if the cached factors belong to the same free nodes."""
        same_loads = np.array_equal(loads.by_force, self._by_force)
        return same_loads and np.array_equal(clamped, self._clamped)


def _key(loads: ApplicatorLoads) -> float | None:
    """Depth, or minus the force, of one applicator; None for several applicators."""
    if len(loads.depth) > 1:
        return None
    depth, force = float(loads.depth[0]), float(loads.force[0])
    return -force if np.isnan(depth) else depth


def lagrange(nodes: Real, x: float) -> Real:
    """Weights of Lagrange interpolation at x between a few nodes, shape (node,)."""
    others = ~np.eye(len(nodes), dtype=bool)
    ratios = (x - nodes) / np.where(others, nodes[:, None] - nodes, 1.0)
    return np.where(others, ratios, 1.0).prod(axis=1)

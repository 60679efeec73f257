"""Deflection under a press within a tolerance: triangles are refined until the error suffices.

Deflections on the last mesh are cached for other depths and forces at the same place.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from ...arrays import Integer, Real
from ...fem.error_estimate import DEFLECTION
from ...press.press import Press
from ...press.touch import Depth
from ...progress import ProgressCallback, silent
from ...scene.foam_mechanics import Mechanics
from ...sweeps import InputError
from ...sweeps.errors import ToleranceError
from ..time_estimate import RemainingTime, check_within_reach
from .contact import (
    ApplicatorLoads,
    Equilibrium,
    Newton,
    above,
    clamped_nodes,
    deepest,
    equilibrium,
    nearby_equilibrium,
)
from .contact_mesh import ContactMesh
from .deformation import check_reached
from .membrane import ELEMENT, Membrane, MembraneSurface, tails

SHRINKS = 2 ** (-2 / 3)
"""Decrease of the error at the corner of a square, where w grows like r^(2/3), as triangles are
halved."""
OF_TAIL = 0.2
"""Mean error of w in a triangle over the largest contribution of the highest order there. It was
0.05 to 0.18 of that for presses up to the closing of the cells."""
FALLS = 5.0
"""Power of a triangle's size by which the error falls where the deflection is smooth."""
MAX_REFINEMENTS_AT_ONCE = 8
HALF_AGAIN = 2.0
"""Assumed error over the tolerance of a first mesh that seems to suffice already."""
MAX_PRESS_TRIANGLES = 60_000
MIN_TRIANGLES_ALONG = 4
"""Triangles for every length of the skins' spread along an applicator's edge."""
MORE_AGAIN = 4.0
"""Upper bound of the growth in triangles: some fifty presses that reached their tolerance had at
least 1.5 times as many triangles as predicted."""
PRESSING = "pressing the skin in"
SPREADS = "if the tension hardly spreads the press, set it to 0"
TOO_FINE = f"the press needs more than {MAX_PRESS_TRIANGLES} triangles at this tolerance; {SPREADS}"

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

    def known(self, loads: ApplicatorLoads) -> Equilibrium | None:
        """Cached equilibrium under the same loads."""
        key = _key(loads)
        return None if key is None else self._known.get(key)

    def newton(self, clamped: Integer, loads: ApplicatorLoads) -> Newton | None:
        """Solve with cached factors if they belong to the same free nodes."""
        same_loads = np.array_equal(loads.by_force, self._by_force)
        return self._newton if same_loads and np.array_equal(clamped, self._clamped) else None


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


def deflection_uncertainty(membrane: Membrane, w: Real) -> Real:
    """Possible error of a deflection, m, averaged over each triangle, shape (triangle,)."""
    return OF_TAIL * tails(membrane, w)


def adaptive_deflection(
    press: Press,
    contact: ContactMesh,
    mechanics: Mechanics,
    thickness: float,
    rtol: float,
    progress: ProgressCallback = silent,
    cache: DeflectionCache | None = None,
) -> tuple[DeflectionLevel, float]:
    """Deflection by a press's applicators, within `rtol` of the factor anywhere, and that error.

    progress: see `ProgressCallback`. cache: deflections by presses at the same places, on the mesh
    of `contact`; this deflection is added to it. Raises InputError where an applicator of given
    force meets another, ToleranceError if `rtol` is out of reach.
    """
    loads = _pushed(press)
    _check_separated(press, contact, loads)
    _check_length(contact, mechanics, thickness)
    pressing, remaining = _Pressing(mechanics, thickness, loads), RemainingTime(rtol)
    progress(PRESSING, 0.0)
    known = cache or DeflectionCache()
    level = (
        pressing.on_cached_mesh(known, known.level, rtol)
        if known.level
        else pressing.level(contact)
    )
    while True:
        check_reached(press, level.solution.depth, mechanics, thickness)
        found = DEFLECTION * pressing.relative(level)
        progress(PRESSING, remaining.share(max(float(found.max()), _least(rtol, level))))
        if not (found > rtol).any():
            if level.refined:
                known.keep(level, loads)
                return level, float(found.max())
            found *= HALF_AGAIN * rtol / found.max()
        _check_within_reach(level.contact, found / rtol)
        level = pressing.level(_refined(level.contact, found / rtol), level.surface)


def _least(rtol: float, level: DeflectionLevel) -> float:
    """Smallest error that is assumed for the first triangles, which are not refined yet."""
    return 0.0 if level.refined else HALF_AGAIN * rtol


def _check_within_reach(contact: ContactMesh, excess: Real) -> None:
    """Raise ToleranceError if even smooth triangles would have to become too many.

    excess: error over its target. Away from corners it falls like h^FALLS at best; a triangle is
    then divided into excess^(2 / FALLS). The final number of triangles was larger by about the same
    ratio again, up to MORE_AGAIN.
    """
    smooth = np.delete(excess, contact.cornered)
    needed = (np.maximum(smooth, 1.0) ** (2 / FALLS)).sum()
    needed *= np.clip(needed / len(excess), 1.0, MORE_AGAIN)
    check_within_reach(
        needed, MAX_PRESS_TRIANGLES, FALLS / 2, f"triangles under the press; {SPREADS}"
    )


def _refined(contact: ContactMesh, excess: Real) -> ContactMesh:
    """Mesh that is finer where the error exceeds its target; at corners as often as needed to
    reduce it."""
    worst = excess[contact.cornered].max(initial=0.0)
    finer = contact.refined(excess > 1)
    for _ in range(_times(worst)):
        finer = finer.refined(finer.cornered)
    return finer


@dataclass(frozen=True)
class _Pressing:
    """Applicators on foam with these mechanics and thickness [m]."""

    mechanics: Mechanics
    thickness: float
    loads: ApplicatorLoads

    def level(self, contact: ContactMesh, start: MembraneSurface | None = None) -> DeflectionLevel:
        if contact.mesh.nelements > MAX_PRESS_TRIANGLES:
            raise ToleranceError(TOO_FINE)
        tension = self.mechanics.tension
        membrane = Membrane(contact.mesh, tension, self.thickness, self.mechanics.elastic)
        nodes = len(membrane.places.T)
        first = np.zeros(nodes) if start is None else start(membrane.places)
        most = self._most(contact, membrane)
        clamped = clamped_nodes(membrane, tension, most, self.loads, first)
        solution = equilibrium(membrane, clamped, self.loads, first)
        surface = MembraneSurface(ELEMENT, contact.mesh.p, membrane.nodes, solution.w)
        return DeflectionLevel(contact, membrane, clamped, solution, surface, start is not None)

    def on_cached_mesh(
        self, known: DeflectionCache, level: DeflectionLevel, rtol: float
    ) -> DeflectionLevel:
        """Level on the mesh of a cached one. rtol: tolerance of the factor anywhere."""
        loads, body, start = self.loads, level.membrane, known.start(level, self.loads)
        most = self._most(level.contact, body)
        no_deeper = np.where(most < 0, start, np.fmin(start, loads.depth[most]))
        clamped = clamped_nodes(body, self.mechanics.tension, most, loads, no_deeper)
        solution, newton = known.known(loads), known.newton(clamped, loads)
        if solution is None and newton is not None:
            solution = nearby_equilibrium(body, clamped, loads, start, newton, LEFT * rtol)
        if solution is None:
            solution = equilibrium(body, clamped, loads, start)
        surface = level.surface.of(solution.w)
        return DeflectionLevel(level.contact, body, clamped, solution, surface, True)

    def _most(self, contact: ContactMesh, membrane: Membrane) -> Integer:
        """Applicator that may clamp each node, -1 for none, shape (node,)."""
        under = above(membrane.nodes, len(membrane.places.T), contact.covered)
        return deepest(under, self.loads)

    def relative(self, level: DeflectionLevel) -> Real:
        """Tails as relative changes of the factor, shape (triangle,)."""
        strain = level.solution.w[level.membrane.nodes].max(axis=0) / self.thickness
        moved = tails(level.membrane, level.solution.w)
        return moved / self.thickness * self.mechanics.gain(strain)


def _times(excess: float) -> int:
    """Number of further halvings of triangles at corners that exceed the target by so much."""
    if excess <= 1:
        return 0
    return min(MAX_REFINEMENTS_AT_ONCE, math.ceil(math.log(excess) / -math.log(SHRINKS)) - 1)


def _pushed(press: Press) -> ApplicatorLoads:
    by = [touch.by for touch in press.indented]
    depth = [each.value if isinstance(each, Depth) else np.nan for each in by]
    force = [np.nan if isinstance(each, Depth) else each.value for each in by]
    return ApplicatorLoads(np.array(depth), np.array(force))


def _check_length(contact: ContactMesh, mechanics: Mechanics, thickness: float) -> None:
    if MIN_TRIANGLES_ALONG * contact.edges > MAX_PRESS_TRIANGLES * mechanics.spread(thickness):
        raise ToleranceError(TOO_FINE)


def _check_separated(press: Press, contact: ContactMesh, loads: ApplicatorLoads) -> None:
    t = contact.domain.t
    under = above(t, int(t.max()) + 1, contact.covered)
    for each in loads.by_force:
        others = np.delete(under, each, axis=0)
        if (under[each] & others).any():
            raise InputError(
                f"press {press}: a touch of given force must not meet another touch; "
                "join touches that meet into one poly with the sum of their forces"
            )

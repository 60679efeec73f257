"""Deflection under a press within a tolerance: triangles are refined until the error suffices."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ...arrays import Integer, Real
from ...fem.error_estimate import DEFLECTION
from ...press.press import Press
from ...press.touch import Depth
from ...progress import ProgressCallback, silent
from ...scene.foam.foam_mechanics import Mechanics
from ...sweeps import InputError
from ...sweeps.errors import ToleranceError
from ..time_estimate import RemainingTime, check_within_reach
from .contact import ApplicatorLoads, Equilibrium, above, clamped_nodes, deepest, equilibrium
from .contact_mesh import ContactMesh
from .deflection_cache import DeflectionCache, DeflectionLevel
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


@dataclass(frozen=True)
class AdaptiveDeflection:
    """A deflection, the forces on the applicators, and the error.

    error: relative error of the factor anywhere. uncertainty: possible error of the deflection, m,
    averaged over each triangle, shape (triangle,). clamped: number of the applicator that clamps
    each node, -1 for none, shape (node,).
    """

    surface: MembraneSurface
    solution: Equilibrium
    error: float
    uncertainty: Real
    membrane: Membrane
    clamped: Integer


def _solved(level: DeflectionLevel, error: float) -> AdaptiveDeflection:
    """Deflection of a level with its error."""
    uncertainty = deflection_uncertainty(level.membrane, level.solution.w)
    return AdaptiveDeflection(
        level.surface, level.solution, error, uncertainty, level.membrane, level.clamped
    )


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
) -> AdaptiveDeflection:
    """Deflection by a press's applicators, within `rtol` of the factor anywhere.

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
                return _solved(level, float(found.max()))
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
        clamped = self._clamped(membrane, self._most(contact, membrane), first)
        solution = equilibrium(membrane, clamped, self.loads, first)
        surface = MembraneSurface(ELEMENT, contact.mesh.p, membrane.nodes, solution.w)
        return DeflectionLevel(contact, membrane, clamped, solution, surface, start is not None)

    def on_cached_mesh(
        self, known: DeflectionCache, level: DeflectionLevel, rtol: float
    ) -> DeflectionLevel:
        """Level on the mesh of a cached one."""
        start = known.start(level, self.loads)
        most = self._most(level.contact, level.membrane)
        no_deeper = np.where(most < 0, start, np.fmin(start, self.loads.depth[most]))
        clamped = self._clamped(level.membrane, most, no_deeper)
        return known.pressed(level, clamped, self.loads, start, rtol)

    def _most(self, contact: ContactMesh, membrane: Membrane) -> Integer:
        """Applicator that may clamp each node, -1 for none, shape (node,)."""
        under = above(membrane.nodes, len(membrane.places.T), contact.covered)
        return deepest(under, self.loads)

    def _clamped(self, membrane: Membrane, most: Integer, near: Real) -> Integer:
        """Applicator that clamps each node, shape (node,). near: deflections close to the solution,
        m."""
        return clamped_nodes(membrane, self.mechanics.tension, most, self.loads, near)

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

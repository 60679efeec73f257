"""The deflection under a press to a tolerance: triangles refined until its elements hold it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...fem.safety_factors import DEFLECTION
from ...press.press import Press
from ...press.touch import Depth
from ...progress import ProgressCallback, silent
from ...scene.foam_mechanics import Mechanics
from ...sweeps import InputError
from ...sweeps.errors import ToleranceError
from ..time_estimate import RemainingTime, check_within_reach
from .contact import ApplicatorLoads, Equilibrium, above, clamped_nodes, deepest, equilibrium
from .contact_mesh import ContactMesh
from .deflection_cache import DeflectionCache, DeflectionLevel
from .deformation import check_reached
from .membrane import ELEMENT, Membrane, MembraneSurface, tails

SHRINKS = 2 ** (-2 / 3)
"""The error at the corner of a square, where w grows like r^(2/3), as its triangles are halved."""
OF_TAIL = 0.2
"""Mean error of w in a triangle over the largest that the highest order alone holds of it there. Of
presses up to the closing of the cells its size was 0.05 to 0.18 of that."""
FALLS = 5.0
"""Power of a triangle's size that the error falls with where all is smooth."""
MOST_AT_ONCE = 8
HALF_AGAIN = 2.0
"""Of the tolerance: what the largest error counts as where the first triangles hold it already."""
MOST_TRIANGLES = 60_000
LEAST_ALONG = 4
"""Triangles for every length of the skins' spread along an applicator's edge."""
MORE_AGAIN = 4.0
"""Of some fifty presses those that reached their tolerance had at least 1.5 times as many."""
PRESSING = "pressing the skin in"
SPREADS = "a tension that spreads it by next to nothing may be set to 0"
TOO_FINE = f"the press needs more than {MOST_TRIANGLES} triangles at this tolerance; {SPREADS}"


@dataclass(frozen=True)
class AdaptiveDeflection:
    """A deflection, where and how what holds it pushes, and how little is known of it.

    error: of the factor, relatively, anywhere. unsure: of the deflection in m, averaged over each
    triangle, shape (triangle,). held: number of the applicator that holds each node, -1 for none.
    """

    surface: MembraneSurface
    rest: Equilibrium
    error: float
    unsure: NDArray[np.float64]
    membrane: Membrane
    held: NDArray[np.int64]


def _solved(level: DeflectionLevel, error: float) -> AdaptiveDeflection:
    """What is known of a level."""
    doubt = unsure(level.membrane, level.rest.w)
    return AdaptiveDeflection(level.surface, level.rest, error, doubt, level.membrane, level.held)


def unsure(membrane: Membrane, w: NDArray[np.float64]) -> NDArray[np.float64]:
    """By how much a deflection may be off, m, in the mean of each triangle, shape (triangle,)."""
    return OF_TAIL * tails(membrane, w)


def adaptive_deflection(
    press: Press,
    ground: ContactMesh,
    mechanics: Mechanics,
    thickness: float,
    rtol: float,
    progress: ProgressCallback = silent,
    again: DeflectionCache | None = None,
) -> AdaptiveDeflection:
    """The deflection by a press's applicators, within `rtol` of the factor anywhere.

    progress: as of `ProgressCallback`. again: what presses of the same places left, its mesh is
    that of `ground`; keeps what this one leaves. Raises InputError where one of given force meets
    another, ToleranceError where `rtol` is out of reach.
    """
    pushed = _pushed(press)
    _check_apart(press, ground, pushed)
    _check_length(ground, mechanics, thickness)
    pressing, remaining = _Pressing(mechanics, thickness, pushed), RemainingTime(rtol)
    progress(PRESSING, 0.0)
    known = again or DeflectionCache()
    level = pressing.again(known, known.level, rtol) if known.level else pressing.level(ground)
    while True:
        check_reached(press, level.rest.depth, mechanics, thickness)
        found = DEFLECTION * pressing.relative(level)
        progress(PRESSING, remaining.share(max(float(found.max()), _least(rtol, level))))
        if not (found > rtol).any():
            if level.refined:
                known.keep(level, pushed)
                return _solved(level, float(found.max()))
            found *= HALF_AGAIN * rtol / found.max()
        _check_within_reach(level.ground, found / rtol)
        level = pressing.level(_refined(level.ground, found / rtol), level.surface)


def _least(rtol: float, level: DeflectionLevel) -> float:
    """An error that the first triangles are taken not to be below, as they are refined yet."""
    return 0.0 if level.refined else HALF_AGAIN * rtol


def _check_within_reach(ground: ContactMesh, excess: NDArray[np.float64]) -> None:
    """Raises ToleranceError where even smooth triangles would have to become too many.

    excess: of the error over its target. Away from corners it falls like h^FALLS at best; a
    triangle is then divided into excess^(2 / FALLS). In the end there were as many times more again
    as that makes of those there are, up to MORE_AGAIN.
    """
    smooth = np.delete(excess, ground.cornered)
    needed = (np.maximum(smooth, 1.0) ** (2 / FALLS)).sum()
    needed *= np.clip(needed / len(excess), 1.0, MORE_AGAIN)
    check_within_reach(needed, MOST_TRIANGLES, FALLS / 2, f"triangles under the press; {SPREADS}")


def _refined(ground: ContactMesh, excess: NDArray[np.float64]) -> ContactMesh:
    """Finer where an error exceeds its target, and at corners as often as they are to shrink it."""
    worst = excess[ground.cornered].max(initial=0.0)
    finer = ground.refined(excess > 1)
    for _ in range(_times(worst)):
        finer = finer.refined(finer.cornered)
    return finer


@dataclass(frozen=True)
class _Pressing:
    """Applicators pushed into foam with these mechanics and thickness [m]."""

    mechanics: Mechanics
    thickness: float
    pushed: ApplicatorLoads

    def level(self, ground: ContactMesh, start: MembraneSurface | None = None) -> DeflectionLevel:
        if ground.mesh.nelements > MOST_TRIANGLES:
            raise ToleranceError(TOO_FINE)
        tension = self.mechanics.tension
        membrane = Membrane(ground.mesh, tension, self.thickness, self.mechanics.elastic)
        nodes = len(membrane.places.T)
        first = np.zeros(nodes) if start is None else start(membrane.places)
        held = self._held(membrane, self._most(ground, membrane), first)
        rest = equilibrium(membrane, held, self.pushed, first)
        surface = MembraneSurface(ELEMENT, ground.mesh.p, membrane.nodes, rest.w)
        return DeflectionLevel(ground, membrane, held, rest, surface, start is not None)

    def again(self, known: DeflectionCache, level: DeflectionLevel, rtol: float) -> DeflectionLevel:
        """On the mesh of a level that is known."""
        start = known.start(level, self.pushed)
        most = self._most(level.ground, level.membrane)
        no_deeper = np.where(most < 0, start, np.fmin(start, self.pushed.depth[most]))
        held = self._held(level.membrane, most, no_deeper)
        return known.pressed(level, held, self.pushed, start, rtol)

    def _most(self, ground: ContactMesh, membrane: Membrane) -> NDArray[np.int64]:
        """(node,): the applicator that may hold each node, -1 for none."""
        under = above(membrane.nodes, len(membrane.places.T), ground.covered)
        return deepest(under, self.pushed)

    def _held(
        self, membrane: Membrane, most: NDArray[np.int64], near: NDArray[np.float64]
    ) -> NDArray[np.int64]:
        """(node,): the one that does. near: deflections near by, m."""
        return clamped_nodes(membrane, self.mechanics.tension, most, self.pushed, near)

    def relative(self, level: DeflectionLevel) -> NDArray[np.float64]:
        """Tails as relative changes of the factor, shape (triangle,)."""
        strain = level.rest.w[level.membrane.nodes].max(axis=0) / self.thickness
        moved = tails(level.membrane, level.rest.w)
        return moved / self.thickness * self.mechanics.gain(strain)


def _times(excess: float) -> int:
    """How often more to halve triangles at corners that exceed the target by so much."""
    if excess <= 1:
        return 0
    return min(MOST_AT_ONCE, math.ceil(math.log(excess) / -math.log(SHRINKS)) - 1)


def _pushed(press: Press) -> ApplicatorLoads:
    by = [touch.by for touch in press.indented]
    depth = [each.value if isinstance(each, Depth) else np.nan for each in by]
    force = [np.nan if isinstance(each, Depth) else each.value for each in by]
    return ApplicatorLoads(np.array(depth), np.array(force))


def _check_length(ground: ContactMesh, mechanics: Mechanics, thickness: float) -> None:
    spread = math.sqrt(mechanics.tension * thickness / mechanics.young)
    if LEAST_ALONG * ground.edges > MOST_TRIANGLES * spread:
        raise ToleranceError(TOO_FINE)


def _check_apart(press: Press, ground: ContactMesh, pushed: ApplicatorLoads) -> None:
    t = ground.domain.t
    under = above(t, int(t.max()) + 1, ground.covered)
    for each in pushed.by_force:
        others = np.delete(under, each, axis=0)
        if (under[each] & others).any():
            raise InputError(
                f"press {press}: touches of a given force must lie apart from the others; "
                "join those that meet in one poly with the sum of their forces"
            )

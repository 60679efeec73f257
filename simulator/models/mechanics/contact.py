"""Contact of applicators with the membrane in equilibrium: the clamped nodes, and the forces."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.sparse import coo_array, csr_matrix
from scipy.sparse.linalg import splu

from ...arrays import Integer, Mask, Real
from ...sweeps.errors import ToleranceError
from .membrane import LumpedMembrane, Membrane

STILL = 1e-12
"""Smallest step over the deflection: less is rounding where the tension far outweighs the foam."""

SETTLED = 1e-10
"""Residual at free nodes over the largest force at a clamped node, both N."""

SYMMETRIC = {"permc_spec": "MMD_AT_PLUS_A", "diag_pivot_thresh": 0.0}
MAX_NEWTON_STEPS = 100
GAINED = 10.0
"""Smallest gain of an undamped step; one that gains less is damped, and new factors follow."""
SUFFICIENT = 1e-4
ROUNDING = 1e-13
MIXED, MAX_MIXED_TRIALS = 4, 8
"""Number of mixed steps, and number of trials before new factors, which cost as much as ten."""


class ElasticBody(Protocol):
    """A body with an energy, whose equilibrium is its minimum."""

    thickness: float

    def residual(self, w: Real) -> Real: ...
    def tangent(self, w: Real) -> csr_matrix: ...
    def energy(self, w: Real) -> float: ...


@dataclass(frozen=True)
class ApplicatorLoads:
    """Depth [m] of each applicator, nan if its `force` [N] is given instead."""

    depth: Real
    force: Real

    @property
    def by_force(self) -> Integer:
        """Numbers of the applicators of given force."""
        return np.flatnonzero(np.isnan(self.depth))


Newton = Callable[[Real], Real]
"""Maps residual forces at free nodes to the Newton step."""


@dataclass(frozen=True)
class Equilibrium:
    """Deflection w [m] (node,), and depth [m] and force [N] of each applicator.

    newton: solve with the last factors, None if none were made.
    """

    w: Real
    depth: Real
    force: Real
    newton: Newton | None = None


def equilibrium(
    body: ElasticBody, clamped: Integer, loads: ApplicatorLoads, start: Real
) -> Equilibrium:
    """Equilibrium under loads: minimum of the energy less the work of given forces.

    Solved by damped Newton steps from `start`.

    clamped: number of the applicator that clamps each node, -1 for none, shape (node,). Nodes under
    an applicator of given force move as one, and their forces add up to that force. The factors of
    one step serve the following ones as long as undamped steps gain GAINED.
    """
    given = _Loaded(body, clamped, loads)
    q = given.first(start)
    w, reaction, downhill = given.pulled(q)
    solve, newton, before = None, None, np.inf
    for _ in range(MAX_NEWTON_STEPS):
        left = np.abs(downhill).max(initial=0.0)
        if left <= SETTLED * np.abs(reaction).max():
            return given.solution(q, w, reaction, newton)
        if solve is None or left > before / GAINED:
            solve, before = given.factors(w), left
            newton = solve
        step = solve(downhill)
        if np.abs(step).max() <= STILL * np.abs(q).max():
            return given.solution(q, w, reaction, newton)
        ahead = given.pulled(q + step)
        if not np.abs(ahead[2]).max() <= left / GAINED:
            step, solve = given.damped(q, step, float(downhill @ step)) * step, None
            ahead = given.pulled(q + step)
        q, before = q + step, left
        w, reaction, downhill = ahead
    raise ToleranceError("no equilibrium of the press was found: its depth or force is too large")


def nearby_equilibrium(
    body: ElasticBody,
    clamped: Integer,
    loads: ApplicatorLoads,
    start: Real,
    newton: Newton,
    left: float,
) -> Equilibrium | None:
    """Equilibrium by steps with the factors of another deflection of the same free nodes.

    The latest steps are mixed for the smallest residual. Iteration ends when a step is at most
    `left` of the deflection and half of the previous step. None if that takes more than
    MAX_MIXED_TRIALS. Source: D. G. Anderson, Journal of the ACM 12 (1965) 547.
    """
    given = _Loaded(body, clamped, loads)
    q, before = given.first(start), np.inf
    tried: list[tuple[Real, Real]] = []
    for _ in range(MAX_MIXED_TRIALS):
        step = newton(given.pulled(q)[2])
        if not np.isfinite(step).all():
            return None
        mixed = _mixed(q, step, tried)
        tried = [*tried[1 - MIXED :], (q, step)]
        q, size = q + mixed, float(np.abs(mixed).max(initial=0.0))
        if size <= min(left * np.abs(q).max(initial=0.0), before / 2) and before < np.inf:
            return given.solution(q, *given.pulled(q)[:2])
        before = size
    return None


def _mixed(q: Real, step: Real, tried: list[tuple[Real, Real]]) -> Real:
    """Step from q with the smallest residual by a linear model of the tried points and their
    steps."""
    if not tried:
        return step
    moved, steps = (np.stack(each, axis=1) for each in zip(*tried, strict=True))
    shares = np.linalg.lstsq(step[:, None] - steps, step, rcond=None)[0]
    return step - (q[:, None] - moved + step[:, None] - steps) @ shares


class _Loaded:
    """A body under applicators, whose deflection is w = turn q + fixed.

    q: deflections of free nodes, then depths of applicators of given force.
    """

    def __init__(self, body: ElasticBody, clamped: Integer, loads: ApplicatorLoads) -> None:
        self.body, self.clamped, self.loads = body, clamped, loads
        self.free, forced = np.flatnonzero(clamped < 0), len(loads.by_force)
        rank = np.full(len(loads.depth), -1)
        rank[loads.by_force] = len(self.free) + np.arange(forced)
        carried = np.flatnonzero((clamped >= 0) & np.isnan(loads.depth)[clamped])
        rows = np.concatenate([self.free, carried])
        columns = np.concatenate([np.arange(len(self.free)), rank[clamped[carried]]])
        shape = (len(clamped), len(self.free) + forced)
        self.turn = csr_matrix(coo_array((np.ones(len(rows)), (rows, columns)), shape=shape))
        self.fixed = np.where(clamped < 0, 0.0, np.nan_to_num(loads.depth)[clamped])
        self.work = np.concatenate([np.zeros(len(self.free)), loads.force[loads.by_force]])

    def first(self, start: Real) -> Real:
        """q of a deflection that may lift off applicators."""
        depths = [start[self.clamped == each].max(initial=0.0) for each in self.loads.by_force]
        return np.concatenate([start[self.free], depths])

    def pulled(self, q: Real) -> tuple[Real, Real, Real]:
        """Deflection, the body's force at each node, and the downhill force on q."""
        w = self.turn @ q + self.fixed
        reaction = self.body.residual(w)
        return w, reaction, self.work - self.turn.T @ reaction

    def factors(self, w: Real) -> Newton:
        """Newton solve with factors at a deflection w."""
        stiffness = (self.turn.T @ self.body.tangent(w) @ self.turn).tocsc()
        return splu(stiffness, options={"SymmetricMode": True}, **SYMMETRIC).solve

    def damped(self, q: Real, step: Real, descent: float) -> float:
        """Share of a Newton step, halved until it lowers the energy enough."""

        def height(at: Real) -> float:
            return self.body.energy(self.turn @ at + self.fixed) - float(self.work @ at)

        here, part = height(q), 1.0
        slack = ROUNDING * (abs(here) + abs(float(self.work @ q)))
        while height(q + part * step) > here - SUFFICIENT * part * descent + slack:
            part /= 2
        return part

    def solution(
        self, q: Real, w: Real, reaction: Real, newton: Newton | None = None
    ) -> Equilibrium:
        """Equilibrium with depths and forces of all applicators."""
        depth = self.loads.depth.copy()
        depth[self.loads.by_force] = q[len(self.free) :]
        force = [reaction[self.clamped == each].sum() for each in range(len(depth))]
        return Equilibrium(w, depth, np.array(force), newton)


MAX_CONTACT_CHANGES = 200
CLOSE = 1e-6
SAME = 1e-12
"""Difference of deflections over the foam's thickness below which they count as equal."""


def above(nodes: Integer, count: int, covered: Mask) -> Mask:
    """True where an applicator lies on a node, edges included, shape (applicator, node)."""
    found = np.zeros((len(covered), count), bool)
    for under, triangles in zip(found, covered, strict=True):
        under[nodes[:, triangles]] = True
    return found


def deepest(under: Mask, loads: ApplicatorLoads) -> Integer:
    """Deepest applicator on each node, -1 for none, shape (node,).

    Applicators of given force must share no node with another.
    """
    depth = np.where(under, np.nan_to_num(loads.depth)[:, None], -1.0)
    return np.where(under.any(axis=0), depth.argmax(axis=0), -1)


def clamped_nodes(
    membrane: Membrane, tension: float, most: Integer, loads: ApplicatorLoads, start: Real
) -> Integer:
    """Applicator that clamps each node, among the candidates of `most`, or -1, shape (node,).

    start: deflections close to the solution, m.
    """
    if len(loads.depth) < 2:
        return most
    net, w = LumpedMembrane(membrane, tension), start
    clamped = np.where(start > _depths(start, most, loads)[most] + CLOSE * net.thickness, -1, most)
    for _ in range(MAX_CONTACT_CHANGES):
        solution = equilibrium(net, clamped, loads, w)
        w, reaction = solution.w, net.residual(solution.w)
        reaches = (most >= 0) & (w < solution.depth[most] - SAME * net.thickness)
        stays = np.where(clamped >= 0, reaction > 0, reaches)
        changed = np.where(stays, most, -1)
        if np.array_equal(changed, clamped):
            return clamped
        clamped = changed
    raise ToleranceError(
        "no equilibrium of the press was found: its touches keep gaining and losing contact"
    )


def _depths(start: Real, most: Integer, loads: ApplicatorLoads) -> Real:
    least = [start[most == each].min(initial=np.inf) for each in range(len(loads.depth))]
    return np.where(np.isnan(loads.depth), least, loads.depth)

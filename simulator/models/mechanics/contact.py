"""Applicators on the membrane at rest: which points they hold, and by which force."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_matrix
from scipy.sparse.linalg import splu

from ...sweeps.errors import ToleranceError
from .membrane import LumpedMembrane, Membrane

STILL = 1e-12
"""Of the deflection: steps that are but rounding where much tension outweighs the foam."""

SETTLED = 1e-10
"""What is left at free nodes over the largest that holds a node, both N."""

SYMMETRIC = {"permc_spec": "MMD_AT_PLUS_A", "diag_pivot_thresh": 0.0}
MOST_STEPS = 100
GAINED = 10.0
"""Of what is left: a step that gains less is damped, and followed by new factors."""
SUFFICIENT = 1e-4
ROUNDING = 1e-13
MIXED, MOST_MIXED = 4, 8
"""Steps that are mixed, and tried before new factors are made, which take as long as ten."""


class ElasticBody(Protocol):
    """What has an energy, and is at rest where it is least."""

    thickness: float

    def residual(self, w: NDArray[np.float64]) -> NDArray[np.float64]: ...
    def tangent(self, w: NDArray[np.float64]) -> csr_matrix: ...
    def energy(self, w: NDArray[np.float64]) -> float: ...


@dataclass(frozen=True)
class ApplicatorLoads:
    """What applicators do: depth [m] of each, nan where it is pushed by `force` [N] instead."""

    depth: NDArray[np.float64]
    force: NDArray[np.float64]

    @property
    def by_force(self) -> NDArray[np.int64]:
        """Numbers of the applicators of given force."""
        return np.flatnonzero(np.isnan(self.depth))


Newton = Callable[[NDArray[np.float64]], NDArray[np.float64]]
"""From what pulls at free points to the step that it takes them."""


@dataclass(frozen=True)
class Equilibrium:
    """Deflection w [m] (node,), and depth [m] and force [N] of each applicator.

    newton: by the last factors that were made for it, None where none were.
    """

    w: NDArray[np.float64]
    depth: NDArray[np.float64]
    force: NDArray[np.float64]
    newton: Newton | None = None


def equilibrium(
    body: ElasticBody, held: NDArray[np.int64], pushed: ApplicatorLoads, start: NDArray[np.float64]
) -> Equilibrium:
    """Least energy less the work of given forces, by damped Newton steps from deflections `start`.

    held: (node,) number of the applicator that holds each node, -1 where none does. Nodes that one
    of given force holds move as one, and what holds them adds up to that force. The factors of one
    step serve the following ones as long as those gain GAINED, undamped.
    """
    turn, fixed = _freedoms(held, pushed)
    q = _first(start, held, pushed)
    work, count = np.zeros_like(q), len(pushed.by_force)
    work[len(q) - count :] = pushed.force[pushed.by_force]

    def pulled(q: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
        w = turn @ q + fixed
        reaction = body.residual(w)
        return w, reaction, work - turn.T @ reaction

    w, reaction, downhill = pulled(q)
    solve, newton, before = None, None, np.inf
    for _ in range(MOST_STEPS):
        left = np.abs(downhill).max(initial=0.0)
        if left <= SETTLED * np.abs(reaction).max():
            return _rest(w, reaction, held, pushed, q[len(q) - count :], newton)
        if solve is None or left > before / GAINED:
            solve, before = _factors(body, turn, w), left
            newton = solve
        step = solve(downhill)
        if np.abs(step).max() <= STILL * np.abs(q).max():
            return _rest(w, reaction, held, pushed, q[len(q) - count :], newton)
        ahead = pulled(q + step)
        if not np.abs(ahead[2]).max() <= left / GAINED:
            part = _damped(body, turn, fixed, work, q, step, float(downhill @ step))
            step, solve = part * step, None
            ahead = pulled(q + step)
        q, before = q + step, left
        w, reaction, downhill = ahead
    raise ToleranceError("the press did not come to rest: its depth or force is too great")


def nearby_equilibrium(
    body: ElasticBody,
    held: NDArray[np.int64],
    pushed: ApplicatorLoads,
    start: NDArray[np.float64],
    newton: Newton,
    left: float,
) -> Equilibrium | None:
    """As `at_rest`, by steps of factors that were made for another deflection of the same nodes.

    Of the latest steps those are mixed that leave least, until one is but `left` of the deflection
    and half the one before or less. None where that takes more than MOST_MIXED. Source: D. G.
    Anderson, Journal of the ACM 12 (1965) 547.
    """
    turn, fixed = _freedoms(held, pushed)
    q, count = _first(start, held, pushed), len(pushed.by_force)
    work = np.zeros_like(q)
    work[len(q) - count :] = pushed.force[pushed.by_force]
    tried: list[tuple[NDArray[np.float64], NDArray[np.float64]]] = []
    before = np.inf
    for _ in range(MOST_MIXED):
        step = newton(work - turn.T @ body.residual(turn @ q + fixed))
        if not np.isfinite(step).all():
            return None
        mixed = _mixed(q, step, tried)
        tried = [*tried[1 - MIXED :], (q, step)]
        q, size = q + mixed, float(np.abs(mixed).max(initial=0.0))
        if size <= min(left * np.abs(q).max(initial=0.0), before / 2) and before < np.inf:
            w = turn @ q + fixed
            return _rest(w, body.residual(w), held, pushed, q[len(q) - count :])
        before = size
    return None


def _mixed(
    q: NDArray[np.float64],
    step: NDArray[np.float64],
    tried: list[tuple[NDArray[np.float64], NDArray[np.float64]]],
) -> NDArray[np.float64]:
    """The step from q that leaves least, as far as those tried tell: places, and steps there."""
    if not tried:
        return step
    moved, steps = (np.stack(each, axis=1) for each in zip(*tried, strict=True))
    shares = np.linalg.lstsq(step[:, None] - steps, step, rcond=None)[0]
    return step - (q[:, None] - moved + step[:, None] - steps) @ shares


def _factors(body: ElasticBody, turn: csr_matrix, w: NDArray[np.float64]) -> Newton:
    """At a deflection w."""
    stiffness = (turn.T @ body.tangent(w) @ turn).tocsc()
    return splu(stiffness, options={"SymmetricMode": True}, **SYMMETRIC).solve


def _freedoms(
    held: NDArray[np.int64], pushed: ApplicatorLoads
) -> tuple[csr_matrix, NDArray[np.float64]]:
    """w = turn q + fixed, q the free nodes, then the depths of applicators of given force."""
    free = np.flatnonzero(held < 0)
    rank = np.full(len(pushed.depth), -1)
    rank[pushed.by_force] = len(free) + np.arange(len(pushed.by_force))
    carried = np.flatnonzero((held >= 0) & np.isnan(pushed.depth)[held])
    rows = np.concatenate([free, carried])
    columns = np.concatenate([np.arange(len(free)), rank[held[carried]]])
    shape = (len(held), len(free) + len(pushed.by_force))
    turn = coo_array((np.ones(len(rows)), (rows, columns)), shape=shape)
    fixed = np.where(held < 0, 0.0, np.nan_to_num(pushed.depth)[held])
    return csr_matrix(turn), fixed


def _first(
    start: NDArray[np.float64], held: NDArray[np.int64], pushed: ApplicatorLoads
) -> NDArray[np.float64]:
    depths = [start[held == each].max(initial=0.0) for each in pushed.by_force]
    return np.concatenate([start[held < 0], depths])


def _damped(
    body: ElasticBody,
    turn: csr_matrix,
    fixed: NDArray[np.float64],
    work: NDArray[np.float64],
    q: NDArray[np.float64],
    step: NDArray[np.float64],
    descent: float,
) -> float:
    """The part of a Newton step that lowers the energy enough: halved until it does."""

    def height(at: NDArray[np.float64]) -> float:
        return body.energy(turn @ at + fixed) - float(work @ at)

    here, part = height(q), 1.0
    slack = ROUNDING * (abs(here) + abs(float(work @ q)))
    while height(q + part * step) > here - SUFFICIENT * part * descent + slack:
        part /= 2
    return part


def _rest(
    w: NDArray[np.float64],
    reaction: NDArray[np.float64],
    held: NDArray[np.int64],
    pushed: ApplicatorLoads,
    found: NDArray[np.float64],
    newton: Newton | None = None,
) -> Equilibrium:
    depth = pushed.depth.copy()
    depth[pushed.by_force] = found
    force = [reaction[held == each].sum() for each in range(len(depth))]
    return Equilibrium(w, depth, np.array(force), newton)


MOST_CHANGES = 200
CLOSE = 1e-6
SAME = 1e-12
"""Of the foam's thickness, deflections that are one."""


def above(nodes: NDArray[np.int64], count: int, covered: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """(applicator, node): which applicators lie on which nodes, edges included."""
    found = np.zeros((len(covered), count), bool)
    for under, triangles in zip(found, covered, strict=True):
        under[nodes[:, triangles]] = True
    return found


def deepest(under: NDArray[np.bool_], pushed: ApplicatorLoads) -> NDArray[np.int64]:
    """(node,): the deepest applicator on each node, -1 where there is none.

    Applicators of given force must share no node with another.
    """
    depth = np.where(under, np.nan_to_num(pushed.depth)[:, None], -1.0)
    return np.where(under.any(axis=0), depth.argmax(axis=0), -1)


def clamped_nodes(
    membrane: Membrane,
    tension: float,
    most: NDArray[np.int64],
    pushed: ApplicatorLoads,
    start: NDArray[np.float64],
) -> NDArray[np.int64]:
    """(node,): the applicator that holds each node, of those that `most` says could, or -1.

    start: deflections near those searched for, m.
    """
    if len(pushed.depth) < 2:
        return most
    net, w = LumpedMembrane(membrane, tension), start
    held = np.where(start > _depths(start, most, pushed)[most] + CLOSE * net.thickness, -1, most)
    for _ in range(MOST_CHANGES):
        rest = equilibrium(net, held, pushed, w)
        w, reaction = rest.w, net.residual(rest.w)
        reaches = (most >= 0) & (w < rest.depth[most] - SAME * net.thickness)
        stays = np.where(held >= 0, reaction > 0, reaches)
        changed = np.where(stays, most, -1)
        if np.array_equal(changed, held):
            return held
        held = changed
    raise ToleranceError("the press did not come to rest: its touches neither hold nor let go")


def _depths(
    start: NDArray[np.float64], most: NDArray[np.int64], pushed: ApplicatorLoads
) -> NDArray[np.float64]:
    least = [start[most == each].min(initial=np.inf) for each in range(len(pushed.depth))]
    return np.where(np.isnan(pushed.depth), least, pushed.depth)

"""Which nodes the applicators hold: the skin lies against them, or below where a deeper one pulls.

The deflection is at least the depth of every applicator above, and what holds a node only pushes.
Found on the net between the nodes by releasing and taking up nodes until their signs agree, the
primal-dual active set method: M. Hintermueller, K. Ito and K. Kunisch, SIAM Journal on Optimization
13 (2003) 865.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simulator.mechanics.equilibrium import Pushed, at_rest
from simulator.mechanics.membrane import Membrane, Net
from simulator.sweeps.errors import ToleranceError

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


def deepest(under: NDArray[np.bool_], pushed: Pushed) -> NDArray[np.int64]:
    """(node,): the deepest applicator on each node, -1 where there is none.

    Applicators of given force must share no node with another.
    """
    depth = np.where(under, np.nan_to_num(pushed.depth)[:, None], -1.0)
    return np.where(under.any(axis=0), depth.argmax(axis=0), -1)


def held_by(
    membrane: Membrane,
    tension: float,
    most: NDArray[np.int64],
    pushed: Pushed,
    start: NDArray[np.float64],
) -> NDArray[np.int64]:
    """(node,): the applicator that holds each node, of those that `most` says could, or -1.

    start: deflections near those searched for, m.
    """
    if len(pushed.depth) < 2:
        return most
    net, w = Net(membrane, tension), start
    held = np.where(start > _depths(start, most, pushed)[most] + CLOSE * net.thickness, -1, most)
    for _ in range(MOST_CHANGES):
        rest = at_rest(net, held, pushed, w)
        w, reaction = rest.w, net.residual(rest.w)
        reaches = (most >= 0) & (w < rest.depth[most] - SAME * net.thickness)
        stays = np.where(held >= 0, reaction > 0, reaches)
        changed = np.where(stays, most, -1)
        if np.array_equal(changed, held):
            return held
        held = changed
    raise ToleranceError("the press did not come to rest: its touches neither hold nor let go")


def _depths(
    start: NDArray[np.float64], most: NDArray[np.int64], pushed: Pushed
) -> NDArray[np.float64]:
    least = [start[most == each].min(initial=np.inf) for each in range(len(pushed.depth))]
    return np.where(np.isnan(pushed.depth), least, pushed.depth)

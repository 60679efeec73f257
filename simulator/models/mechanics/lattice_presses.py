"""Deflections by rigid bodies and pressures on a lattice, and the rises of c in cells of a grid."""

from __future__ import annotations

import numpy as np

from ...arrays import Real
from ...press.batch import NOTHING, TouchedCells
from ...press.press import Press, order
from ...press.touch import Depth, Disc, Indentation, Rectangle
from ...scene.parts import Skin
from ...scene.skin_region import covers
from ...sweeps.errors import ToleranceError
from .relaxation_kernel import Bodies, Nodes, relaxed_in_place
from .skin_lattice import Lattice, Window

STILL = 1e-5
"""Largest movement of a node in the last sweep, over the depth."""
MAX_RELAXATION_SWEEPS = 2000
FAINT = 1e-4
"""Rises of c below this are left out."""
SLOWEST = 2.0
"""Length of the slowest error mode next to bodies, over the length in which a deflection falls to a
tenth. Different foams and skins converged fastest from 1.5 to 2."""
TINY = 1e-30
TRACED_RTOL = 1e-3
"""Tolerance of the factor anywhere by triangles, for comparison with lattices."""
POINTS = 24
"""Sample points along each side of a cell, for that comparison."""
NOBODY = Bodies.by_depth(np.zeros((0, 4)), np.zeros(0), np.zeros(0))


def raised(lattice: Lattice, bodies: Bodies) -> TouchedCells:
    """Cells that a press changes, and the rise of c averaged over the skin in each."""
    return touched(pressed(lattice, bodies)[0])


def touched(rise: Real) -> TouchedCells:
    """Cells of more than a faint rise. rise: shape (row, column)."""
    cells = np.flatnonzero(rise > FAINT)
    return TouchedCells(cells, rise.ravel()[cells])


def pressed(lattice: Lattice, bodies: Bodies) -> tuple[Real, Real]:
    """Rise of c averaged over the skin in each cell, (row, column), and depth of each body, m.

    Bodies that do not influence each other are relaxed one by one. Raises ToleranceError if the
    relaxation does not converge.
    """
    rise, depth = np.zeros(lattice.grid), np.zeros(len(bodies.depth))
    for group in lattice.groups(bodies):
        own = bodies.some(group)
        if not own.depth.any():
            continue
        here = lattice.window(own)
        w, depth[group] = deflected(lattice, own, here)
        rise[here] += lattice.in_cells(lattice.rises(w), here)
    return rise, depth


def deflected(
    lattice: Lattice, bodies: Bodies, here: Window, still: float = STILL
) -> tuple[Real, Real]:
    """Deflection at the nodes of a window, m, shape (row, column), and depth of each body, m.

    Bodies by force that overlap are not rigid: each is a load, with the pressure that foam without
    tension returns, and pressures add. still: see STILL. Raises as `pressed` does.
    """
    nodes = lattice.nodes_of(here)
    if np.isfinite(bodies.force).any() and len(lattice.groups(bodies, 0.0)) < len(bodies.depth):
        w = under_pressure(lattice, _loads(lattice, bodies, nodes), here)
        (left, right, bottom, top) = bodies.boxes.T[..., None]
        row = np.abs(nodes.y - (bottom + top) / 2).argmin(axis=1)
        return w, w[row, np.abs(nodes.x - (left + right) / 2).argmin(axis=1)]
    bodies = bodies._replace(depth=bodies.depth.copy())
    w = _first(lattice, bodies, nodes)
    relax(lattice, nodes, bodies, w, np.zeros(w.shape), still)
    return w, bodies.depth


def under_pressure(lattice: Lattice, pressure: Real, here: Window) -> Real:
    """Deflection at the nodes of a window under a pressure in Pa there, m, shape (row, column).

    Raises as `pressed` does.
    """
    law = lattice.law
    w = law.strains_under(np.minimum(pressure, law.closed)) * law.thickness
    relax(lattice, lattice.nodes_of(here), NOBODY, w, pressure)
    return w


def relax(
    lattice: Lattice, nodes: Nodes, bodies: Bodies, w: Real, pressure: Real, still: float = STILL
) -> None:
    """Relax deflections w of nodes in m, and depths of bodies, in place.

    Deflections stay within the foam's largest. pressure: Pa, at nodes. nodes: changed as well.
    Raises as `pressed` does.
    """
    deepest = float(bodies.depth.max() if len(bodies.depth) else w.max())
    sides = max(np.ptp(nodes.x), np.ptp(nodes.y))
    slowest = min(SLOWEST * lattice.falls_within(deepest), sides)
    relaxed = 2 / (1 + np.pi * min(nodes.steps) / slowest)
    limits = relaxed, still * deepest, MAX_RELAXATION_SWEEPS
    swept = relaxed_in_place(w, pressure, nodes, lattice.law, bodies, *limits)
    if swept > MAX_RELAXATION_SWEEPS:
        raise ToleranceError(
            f"a press by {deepest:g} m: the relaxation of the foam next to it does not converge"
        )
    np.minimum(w, lattice.law.deepest, out=w)


def _first(lattice: Lattice, bodies: Bodies, nodes: Nodes) -> Real:
    """Deflection as if each body's edge were straight, m, shape (row, column)."""
    x, y = nodes.x, nodes.y[:, None]
    found = np.zeros(nodes.load.shape)
    for (left, right, bottom, top), radius, depth in zip(
        bodies.boxes, bodies.radius, bodies.depth, strict=True
    ):
        if radius:
            away = np.hypot(x - (left + right) / 2, y - (bottom + top) / 2) - radius
        else:
            along = np.maximum(left - x, x - right).clip(0.0)
            away = np.hypot(along, np.maximum(bottom - y, y - top).clip(0.0))
        found = np.maximum(found, lattice.edge_profile(depth, away.clip(0.0)))
    return found


def _loads(lattice: Lattice, bodies: Bodies, nodes: Nodes) -> Real:
    """Sum of the pressures of bodies by force, each as foam without tension returns it, Pa."""
    area, pressure = nodes.load * nodes.tension, np.zeros(nodes.load.shape)
    for (left, right, bottom, top), radius, curvature, depth, force in zip(*bodies, strict=True):
        along = nodes.x - (left + right) / 2
        across = (nodes.y - (bottom + top) / 2)[:, None]
        far = along**2 + across**2
        flat = (abs(along) <= (right - left) / 2) & (abs(across) <= (top - bottom) / 2)
        under = far <= radius**2 if radius else flat
        strain = (depth - far / (2 * curvature)) / lattice.law.thickness
        load = np.where(under, lattice.mechanics.elastic.stress(strain.clip(0.0)), 0.0)
        pressure += load * (force / max((load * area).sum(), TINY))
    return pressure


def traced(skin: Skin, lattice: Lattice, bodies: Bodies) -> TouchedCells:
    """Rises as `raised` returns them, by the membrane on triangles: the reference for lattices.

    Their tolerance is TRACED_RTOL. A press takes some tenths of a second.
    """
    from .indentation import deformation

    if not len(bodies.depth):
        return NOTHING
    here, grid = lattice.window(bodies), lattice.grid
    y, x = (
        (np.arange(cells.start * POINTS, cells.stop * POINTS) + 0.5) * side / count / POINTS
        for cells, side, count in zip(here, skin.sides[::-1], grid, strict=True)
    )
    at = np.stack(np.broadcast_arrays(x, y[:, None]))
    part = covers(skin, at).astype(np.float64)
    rise = part * (deformation(skin, as_press(bodies), TRACED_RTOL).factor(at) - 1)
    shape = len(y) // POINTS, POINTS, len(x) // POINTS, POINTS
    area, total = (each.reshape(shape).sum(axis=(1, 3)) for each in (part, rise))
    every: Real = np.zeros(grid)
    every[here] = np.divide(total, area, out=np.zeros_like(total), where=area > 0)
    cells = np.flatnonzero(every)
    return TouchedCells(cells, every.ravel()[cells])


def as_press(bodies: Bodies) -> Press:
    """Press by these flat bodies of given depth, for the mechanics on triangles."""
    touches = []
    each = zip(bodies.boxes.tolist(), bodies.radius.tolist(), bodies.depth.tolist(), strict=True)
    for (left, right, bottom, top), radius, depth in each:
        x, y = (left + right) / 2, (bottom + top) / 2
        box = Rectangle(x, y, right - left, top - bottom, 1.0)
        place = Disc(x, y, radius, 1.0) if radius else box
        touches.append(Indentation(place, Depth(depth)))
    return Press(tuple(sorted(touches, key=order)))

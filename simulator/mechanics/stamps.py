"""Applicators on foam that no tension spreads: each presses what it covers, and nothing else."""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import root_scalar

from simulator.elastic_foam import Elastic
from simulator.foam_properties import Mechanics
from simulator.grid import SAME_EDGE
from simulator.mechanics.ground import ground
from simulator.mechanics.limit import check_reached
from simulator.mechanics.pressed import Pressed
from simulator.planar import area, inside
from simulator.press import Depth, Press, order, touch_at
from simulator.scene import Scene
from simulator.sweeps import InputError

ROUNDING = 1e-15
Polygons = tuple[NDArray[np.float64], ...]


def stamped(
    scene: Scene,
    press: Press,
    mechanics: Mechanics,
    thickness: float,
    kinks: Polygons,
) -> Pressed:
    """A press of which each touch presses what it covers; raises InputError as `pressed`."""
    apart = not any(meet(one, other) for one, other in combinations(kinks, 2))
    by_depth = all(isinstance(touch.by, Depth) for touch in press.indented)
    if not apart and not by_depth:
        raise InputError(f"press {press}: touches of a given force must lie apart from the others")
    area = _areas(scene, press, kinks, apart)
    strain = np.array(
        [
            touch.by.value / thickness
            if isinstance(touch.by, Depth)
            else strain_at(touch.by.value / own, mechanics.elastic)
            for touch, own in zip(press.indented, area, strict=True)
        ]
    )
    depth = tuple((strain * thickness).tolist())
    check_reached(press, depth, mechanics, thickness)
    force = tuple((mechanics.elastic.stress(strain) * area).tolist())
    sharp = _sharp(press, mechanics.factor(strain)) if apart else None
    w = Stamps(kinks, depth)
    return Pressed(mechanics, thickness, w, depth, force, 0.0, kinks, sharp)


class Stamps:
    """Deflection [m] by applicators of known depth: of those over a place the deepest counts."""

    def __init__(self, polygons: Polygons, depth: tuple[float, ...]) -> None:
        self.polygons, self.depth = polygons, depth

    def __call__(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """At flat positions x (2, ...) in m, shape (...)."""
        found = np.zeros(x.shape[1:])
        for polygon, depth in zip(self.polygons, self.depth, strict=True):
            found = np.maximum(found, np.where(inside(polygon, x), depth, 0.0))
        return found


def strain_at(pressure: float, elastic: Elastic) -> float:
    """Of foam under a pressure in Pa; infinite where that closes its cells."""
    top = elastic.greatest_strain

    def excess(strain: float) -> float:
        return float(elastic.stress(np.array(strain))) - pressure

    if excess(top) < 0:
        return math.inf
    return float(root_scalar(excess, bracket=(0.0, top), xtol=ROUNDING).root)


def meet(one: NDArray[np.float64], other: NDArray[np.float64]) -> bool:
    """Whether the boxes around two polygons (point, 2) share more than an edge."""
    low = np.maximum(one.min(axis=0), other.min(axis=0))
    high = np.minimum(one.max(axis=0), other.max(axis=0))
    return bool((high - low > SAME_EDGE * np.abs(high)).all())


def _areas(scene: Scene, press: Press, polygons: Polygons, apart: bool) -> NDArray[np.float64]:
    """Of the skin that each applicator presses, m²; where they overlap that of the deepest."""
    if apart and scene.skin.outline is None and scene.skin.mesh is None:
        return np.array([abs(area(polygon)) for polygon in polygons])
    under = ground(scene, [touch.place for touch in press.indented])
    depth = [touch.by.value if isinstance(touch.by, Depth) else 1.0 for touch in press.indented]
    holds = np.where(under.covered, np.array(depth)[:, None], 0.0).argmax(axis=0)
    alone = under.covered & (holds == np.arange(len(depth))[:, None])
    return alone @ under.domain.areas


def _sharp(press: Press, factor: NDArray[np.float64]) -> Press:
    """The press with factors in place of depths and forces."""
    by_factor = [touch_at(t.place, float(f)) for t, f in zip(press.indented, factor, strict=True)]
    return Press(tuple(sorted([*press.sharp.touches, *by_factor], key=order)))

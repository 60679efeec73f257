"""Applicators on foam without tension: each presses only the area that it covers."""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np

from ...arrays import Real
from ...mesh.drawing import shape_of
from ...press.capacitance import touched_box
from ...press.press import Press, order
from ...press.touch import Box, Depth, Place, Touch, touch_at
from ...scene.foam.foam_mechanics import Elastic, Mechanics, strains_under
from ...scene.parts import Skin
from ...scene.planar import SAME_EDGE, Circle, area, inside, ring
from ...sweeps import InputError
from .contact_mesh import contact_mesh
from .deformation import Deformation, check_reached

Shapes = tuple[Circle | Real, ...]
"""Circles, and polygons by their corners (corner, 2); m."""


def deformation_without_tension(
    skin: Skin, press: Press, mechanics: Mechanics, thickness: float
) -> Deformation:
    """Deformation if each touch presses only the area that it covers.

    Raises what `deformation` raises.
    """
    places = [touch.place for touch in press.indented]
    shapes = tuple(shape_of(skin, place) for place in places)
    boxes = [_box(skin, place) for place in places]
    separated = not any(meet(one, other) for one, other in combinations(boxes, 2))
    by_depth = all(isinstance(touch.by, Depth) for touch in press.indented)
    if not separated and not by_depth:
        raise InputError(f"press {press}: a touch of given force must not meet another touch")
    area = _areas(skin, press, shapes, separated)
    strain = np.array(
        [
            touch.by.value / thickness
            if isinstance(touch.by, Depth)
            else _strain_at(touch.by.value / own, mechanics.elastic)
            for touch, own in zip(press.indented, area, strict=True)
        ]
    )
    depth = tuple((strain * thickness).tolist())
    check_reached(press, depth, mechanics, thickness)
    force = tuple((mechanics.elastic.stress(strain) * area).tolist())
    sharp = _sharp(press, mechanics.factor(strain)) if separated else None
    kinks = tuple(each if isinstance(each, Circle) else ring(each) for each in shapes)
    w = FootprintDeflection(shapes, depth)
    return Deformation(mechanics, thickness, w, depth, force, 0.0, kinks, sharp)


class FootprintDeflection:
    """Deflection [m] by applicators of known depth; where they overlap the deepest counts."""

    def __init__(self, shapes: Shapes, depth: tuple[float, ...]) -> None:
        self.shapes, self.depth = shapes, depth

    def __call__(self, x: Real) -> Real:
        """Deflection at flat positions x (2, ...) in m, shape (...)."""
        found = np.zeros(x.shape[1:])
        for shape, depth in zip(self.shapes, self.depth, strict=True):
            within = shape.holds(x) if isinstance(shape, Circle) else inside(shape, x)
            found = np.maximum(found, np.where(within, depth, 0.0))
        return found


def _strain_at(pressure: float, elastic: Elastic) -> float:
    """Strain of foam under a pressure in Pa; infinite if that closes its cells."""
    if pressure > elastic.stress(np.array(elastic.greatest_strain)):
        return math.inf
    return float(strains_under(elastic, np.array(pressure)))


def meet(one: Box, other: Box) -> bool:
    """True if two boxes share more than an edge."""
    low = np.maximum([one.left, one.bottom], [other.left, other.bottom])
    high = np.minimum([one.right, one.top], [other.right, other.top])
    return bool((high - low > SAME_EDGE * np.abs(high)).all())


def _box(skin: Skin, place: Place) -> Box:
    return touched_box(skin, place) if isinstance(place, Touch) else place.box


def _areas(skin: Skin, press: Press, shapes: Shapes, separated: bool) -> Real:
    """Area of the skin under each applicator, m²; where they overlap it counts for the deepest."""
    if separated and skin.outline is None and skin.mesh is None:
        return np.array(
            [
                np.pi * each.radius**2 if isinstance(each, Circle) else abs(area(each))
                for each in shapes
            ]
        )
    under = contact_mesh(skin, [touch.place for touch in press.indented])
    depth = [touch.by.value if isinstance(touch.by, Depth) else 1.0 for touch in press.indented]
    holds = np.where(under.covered, np.array(depth)[:, None], 0.0).argmax(axis=0)
    alone = under.covered & (holds == np.arange(len(depth))[:, None])
    return alone @ under.domain.areas


def _sharp(press: Press, factor: Real) -> Press:
    """Press with factors in place of depths and forces."""
    by_factor = [
        touch_at(t.place, float(f), t.finger) for t, f in zip(press.indented, factor, strict=True)
    ]
    return press.of(sorted([*press.sharp.touches, *by_factor], key=order))

"""Strain of the foam and factor on its capacitance by the depth or force of a press.

Electrode skins of tension T lie on foam of thickness d as on an elastic foundation (a Winkler
foundation with a Pasternak layer): div(T grad w) = p(w/d). Rigid flat applicators clamp them at
their depth; away from these the deflection falls off over the length sqrt(T d / E). Without tension
each presses only the area that it covers.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from itertools import combinations

import numpy as np

from ...arrays import Real
from ...mesh.drawing import polygon_of, polygonal, shape_of
from ...press.capacitance import touched_box
from ...press.press import Press, check_press, order
from ...press.touch import Box, Depth, Disc, Place, Touch, touch_at
from ...progress import ProgressCallback, silent
from ...scene.foam_mechanics import Elastic, Mechanics, strains_under
from ...scene.parts import Skin
from ...scene.planar import SAME_EDGE, Circle, area, inside, ring
from ...sweeps import InputError
from .adaptive import DeflectionCache, adaptive_deflection, deflection_uncertainty
from .contact_mesh import contact_mesh, straight_contact_mesh
from .deformation import Deformation, check_depths, check_reached

DISC_SIDES = 128
"""Sides of the polygon of the same area that replaces a disc."""
OUT_OF_ROUND = 0.02 * (np.pi / DISC_SIDES) ** 3
"""Relative error of Rs and Cp by that polygon. It falls with the cube of the sides; a third of this
bound was observed, all of it far above cut-off."""

Shapes = tuple[Circle | Real, ...]
"""Circles, and polygons by their corners (corner, 2); m."""


def deformation(
    skin: Skin,
    press: Press,
    rtol: float,
    progress: ProgressCallback = silent,
    again: DeflectionCache | None = None,
) -> Deformation:
    """Deformation by the touches of given depth or force, the factor within `rtol` anywhere.

    progress: see `ProgressCallback`. again: cache of presses at the same places. Raises InputError
    as `check_press` does, if the foam cannot be compressed so far, if a touch of given force meets
    another, and if a touch lies outside the skin. Raises ToleranceError if `rtol` is out of reach.
    """
    touches = press.indented
    if not touches:
        return Deformation(None, 1.0, _flat, (), (), 0.0, (), press)
    check_press(press, skin)
    mechanics, thickness = skin.foam.mechanics, skin.foam.thickness
    assert mechanics is not None and thickness is not None
    check_depths(press, mechanics, thickness)
    if not mechanics.tension:
        return _sharp_deformation(skin, press, mechanics, thickness)
    again = again or DeflectionCache()
    return _spread(skin, press, mechanics, thickness, rtol, progress, again)


def _spread(
    skin: Skin,
    press: Press,
    mechanics: Mechanics,
    thickness: float,
    rtol: float,
    progress: ProgressCallback,
    again: DeflectionCache,
) -> Deformation:
    """Deformation if a tension spreads the press."""
    places = [touch.place for touch in press.indented]
    kinks = tuple(ring(polygon_of(skin, polygonal(each, DISC_SIDES))) for each in places)
    contact = again.contact or straight_contact_mesh(skin, places, DISC_SIDES)
    found, error = adaptive_deflection(press, contact, mechanics, thickness, rtol, progress, again)
    return Deformation(
        mechanics,
        thickness,
        found.surface,
        tuple(found.solution.depth.tolist()),
        tuple(found.solution.force.tolist()),
        error,
        kinks,
        None,
        out_of_round=OUT_OF_ROUND * any(isinstance(each, Disc) for each in places),
        within_error=partial(deformation, skin, press, again=again),
        uncertainty=found.surface.in_triangles(
            deflection_uncertainty(found.membrane, found.solution.w)
        ),
    )


def _flat(x: Real) -> Real:
    return np.zeros(x.shape[1:])


def _sharp_deformation(
    skin: Skin, press: Press, mechanics: Mechanics, thickness: float
) -> Deformation:
    """Deformation if each touch presses only the area that it covers."""
    places = [touch.place for touch in press.indented]
    shapes = tuple(shape_of(skin, place) for place in places)
    boxes = [_box(skin, place) for place in places]
    separated = not any(_meet(one, other) for one, other in combinations(boxes, 2))
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
    w = _footprints(shapes, depth)
    return Deformation(mechanics, thickness, w, depth, force, 0.0, kinks, sharp)


def _footprints(shapes: Shapes, depth: tuple[float, ...]) -> Callable[[Real], Real]:
    """Deflection [m] by applicators of known depth; where they overlap the deepest counts."""

    def deflection(x: Real) -> Real:
        found = np.zeros(x.shape[1:])
        for shape, own in zip(shapes, depth, strict=True):
            within = shape.holds(x) if isinstance(shape, Circle) else inside(shape, x)
            found = np.maximum(found, np.where(within, own, 0.0))
        return found

    return deflection


def _strain_at(pressure: float, elastic: Elastic) -> float:
    """Strain of foam under a pressure in Pa; infinite if that closes its cells."""
    if pressure > elastic.stress(np.array(elastic.greatest_strain)):
        return math.inf
    return float(strains_under(elastic, np.array(pressure)))


def _meet(one: Box, other: Box) -> bool:
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

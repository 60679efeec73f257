"""Corners at which the potential of a sheet varies as a fractional power of the distance.

There the error falls slowly with the order unless cells shrink towards the corner. Such corners
occur where conductance jumps (under a touch on a piezoresistive sheet) and where an anisotropic
sheet meets a foil at the skin's corner. The power follows from the quadrants there: stretched so
that it conducts equally along all directions, each is a wedge of one conductance.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ...arrays import Mask, Real
from ...fem.circuit import Circuit
from ...fem.quadrature import rule_at
from ...fem.unknowns import TRIANGLES
from ...mesh.corner_exponents import SheetAtCorners, around, between, stretched
from ...mesh.domain import Domain
from ...mesh.quadrilaterals import RATIO
from ...press.capacitance import touched_box
from ...press.press import Press
from ...scene.contacts import Contact
from ...scene.parts import Skin
from ...scene.planar import distinct
from ...scene.skin import Electrode
from ..resolution import all_lines
from .coefficients import ELECTRODES, PressCoefficients
from .elements import on_triangles
from .materials import Materials, gauged, gauges

STRENGTH = 1e-2
"""Largest error of Rs and Cp by a corner in elements of low order, over (1 - p)²."""
SHARE = 0.03
"""Share of the tolerance that one corner may use."""
BESIDE = 1e-6
"""Distance from a corner at which coefficients are evaluated, over a side."""
QUADRANTS = np.array([[1, -1, -1, 1], [1, 1, -1, -1]])
TOWARDS = np.array([[1, 0], [0, 1], [-1, 0], [0, -1]])
"""Directions at which the quadrants begin, anticlockwise."""
Corner = tuple[float, float, int]
"""x and y in m, and the number of rings of cells that shrink towards it."""


def ringed_corners(
    materials: Materials, contacts: Sequence[Contact], press: Press, rtol: float
) -> tuple[Corner, ...]:
    """Corners whose error exceeds a share of the tolerance. press: of rectangles."""
    found = []
    if not (gauged(materials.skin) or any(map(materials.directed, ELECTRODES))):
        return ()
    for place in _places(materials.skin, press):
        power = power_at(materials, contacts, press, place)
        taken = STRENGTH * (1 - power) ** 2 / (SHARE * rtol)
        if taken > 1:
            found.append((*place, math.ceil(-math.log(taken) / math.log(RATIO) / (2 * power))))
    return tuple(found)


def power_at(
    materials: Materials, contacts: Sequence[Contact], press: Press, place: tuple[float, float]
) -> float:
    """Power of the distance from a position in m by which a sheet's potential goes.

    It is 1 where the field is smooth; of both sheets the power farther from 1 counts. It may exceed
    1 where a foil meets the skin's corner alone: the field is weak there.
    """
    skin, at = materials.skin, np.array(place)
    away = BESIDE * np.array(skin.sides)
    around_corner = at[:, None] + away[:, None] * QUADRANTS
    sides = np.array(skin.sides)[:, None]
    within: Mask = np.all((around_corner > 0) & (around_corner < sides), axis=0)
    found = gauges(skin, _factors(skin, press, around_corner))
    powers = [1.0]
    for sheet, conductances in zip(ELECTRODES, found, strict=True):
        jumps = np.ptp(conductances[within]) > 0
        if not jumps and (within.sum() > 1 or not materials.directed(sheet)):
            continue
        xx, yy, xy = materials.conductance(sheet, at[:, None])[:, 0]
        cosine = -xy / math.sqrt(xx * yy)
        angles = np.arccos([cosine, -cosine] * 2)
        if within.all():
            powers.append(around(list(zip(angles, conductances, strict=True))))
            continue
        first = next(k for k in range(4) if within[k] and not within[k - 1])
        run = (first + np.arange(within.sum())) % 4
        ends = (at + away * TOWARDS[k] for k in (first, (run[-1] + 1) % 4))
        begins, stops = (_foil_fixes_potential(contacts, sheet, end, skin) for end in ends)
        if len(run) > 1:
            wedges = list(zip(angles[run], conductances[run], strict=True))
            powers.append(min(between(wedges, begins, stops), 1.0))
        elif begins != stops:
            powers.append(np.pi / 2 / angles[first])
    return max(powers, key=lambda power: abs(power - 1))


def _places(skin: Skin, press: Press) -> list[tuple[float, float]]:
    """Corners of the skin and of touches, and intersections of their lines."""
    lines = all_lines(press, skin)
    x, y = (
        distinct([0.0, side, *each]).tolist() for side, each in zip(skin.sides, lines, strict=True)
    )
    return [(a, b) for a in x for b in y]


def _factors(skin: Skin, press: Press, x: Real) -> Real:
    """c over its unpressed value at positions in m, shape (2, place)."""
    found = np.ones(x.shape[1])
    for touch in press.touches:
        left, right, bottom, top = touched_box(skin, touch)
        inside = (left < x[0]) & (x[0] < right) & (bottom < x[1]) & (x[1] < top)
        found[inside] *= touch.factor
    return found


def _foil_fixes_potential(
    contacts: Sequence[Contact], sheet: Electrode, place: Real, skin: Skin
) -> bool:
    """True if a foil without contact resistance fixes that sheet's potential at a position of the
    edge, m."""
    ends = [
        np.array(each.ends(skin)) for each in contacts if each.electrode == sheet and each.ideal
    ]
    same = BESIDE * max(skin.sides) / 10
    return any(
        bool((place > each.min(0) - same).all() and (place < each.max(0) + same).all())
        for each in ends
    )


CORNERS = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])


def sheets(circuit: Circuit, mesh: Domain, coefficients: PressCoefficients) -> list[SheetAtCorners]:
    """Sheet of each field at the corners of triangles.

    A film whose resistance is below that of the sheet along one edge counts as an ideal foil.
    """
    found = []
    for field in range(circuit.fields):
        own = [t for t in circuit.terminals if t.field == field]
        contacts = [contact for terminal in own for contact in terminal.contacts]
        films = [c.name for c in contacts if _resists(c, mesh, circuit.conductance[field])]
        foils = [c.name for c in contacts if c.name not in films]
        angle = conductance = None
        if _jumps_or_turns(field, coefficients):
            corners = rule_at(TRIANGLES[0](), CORNERS, np.zeros(3))
            at = on_triangles(mesh)(corners, slice(None))
            edges = (
                (at.along[..., 0], at.across[..., 0]),
                (at.across[..., 1] - at.along[..., 1], -at.along[..., 1]),
                (-at.across[..., 2], at.along[..., 2] - at.across[..., 2]),
            )
            S = coefficients.conductance(field, at.x)
            of_corners = [stretched(u, v, S[..., k]) for k, (u, v) in enumerate(edges)]
            angle, conductance = (np.stack(each) for each in zip(*of_corners, strict=True))
        found.append(SheetAtCorners(foils, films, angle, conductance))
    return found


def crossed(coefficients: PressCoefficients) -> bool:
    """True if a sheet's conductance jumps, or is larger along one direction than along another."""
    return any(_jumps_or_turns(field, coefficients) for field in range(coefficients.fields))


def _resists(contact: Contact, mesh: Domain, conductance: float) -> bool:
    start, stop = (mesh.p[:, end] for end in mesh.foils[contact.name])
    shortest = np.linalg.norm(stop - start, axis=0).min()
    return contact.resistance * conductance > shortest


def _jumps_or_turns(field: int, coefficients: PressCoefficients) -> bool:
    """True if a sheet is piezoresistive and touched with sharp edges, or is anisotropic."""
    materials, electrode = coefficients.materials, ELECTRODES[field]
    gauge = materials.skin.sheet(electrode).piezoresistance
    return bool(gauge and np.ptp(coefficients.factors) > 0) or materials.directed(electrode)

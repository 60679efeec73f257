"""Patches under contacts, compiled: their area on the skin, their faults, and discs of rises."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...compiled import compiled
from ...models.mechanics.foam_law import (
    FoamTables,
    edge_strain,
    indenter_force,
    indenter_strain,
    patch_radius,
    rise_at,
    strain_under,
    stress,
)
from ...press.cell_kernel import Box, box_cells, covered_part
from ...press.pixels import GridCells
from ...sweeps.press_text import MAX_FACTOR, MIN_FACTOR

X, Y, STRENGTH, RADIUS, CURVATURE, WIDTH, HEIGHT = range(7)
"""Columns of a contact's numbers, see `contact_types.COLUMNS`."""
FINE, BAD_PLACE, BAD_STRENGTH, BAD_PATCH, OFF_SKIN = range(5)
FORCE, DEPTH, FACTOR, ADDED = range(4)
"""How a contact is given; ADDED: factors of touches that add a capacitance to earth."""
ROUNDING = 1e-9

Fault = tuple[int, int, int]
"""Press, contact and reason of the first invalid contact; the reason is FINE if there is none."""


class Stacks(NamedTuple):
    """Discs of rises under contacts, of many presses or of one.

    radii [m], rises: of each disc; a rectangle has the radius 0; shape (press, contact, disc).
    discs: their number, 0 leaves a contact out; strain: in the middle; shape (press, contact).
    """

    radii: NDArray[np.float64]
    rises: NDArray[np.float64]
    discs: NDArray[np.int64]
    strain: NDArray[np.float64]


@compiled()
def of_press(stacks: Stacks, press: int) -> Stacks:
    """Stacks of one press, without the first axis."""
    radii, rises = stacks.radii[press], stacks.rises[press]
    return Stacks(radii, rises, stacks.discs[press], stacks.strain[press])


@compiled()
def patch_box(contact: NDArray, radius: float) -> Box:
    """Rectangle around a patch. radius: of a disc, 0 for a rectangle, m."""
    wide, high = radius, radius
    if radius == 0.0:
        wide, high = contact[WIDTH] / 2, contact[HEIGHT] / 2
    return contact[X] - wide, contact[X] + wide, contact[Y] - high, contact[Y] + high


@compiled()
def skin_of_cell(i: int, j: int, cells: GridCells) -> float:
    """Area of the skin in a cell, m²."""
    x, y = cells.x, cells.y
    return (x[j + 1] - x[j]) * (y[i + 1] - y[i]) * cells.part[i, j]


@compiled()
def area_on_skin(contact: NDArray, radius: float, cells: GridCells) -> float:
    """Area of the skin under a patch, m²."""
    box, area = patch_box(contact, radius), 0.0
    left, right, bottom, top = box_cells(box, cells)
    for i in range(bottom, top):
        for j in range(left, right):
            area += skin_of_cell(i, j, cells) * covered_part(box, radius, i, j, cells)
    return area


@compiled()
def within_borders(contact: NDArray, radius: float, cells: GridCells) -> bool:
    """True if a patch lies within the length and width of the skin."""
    box, length, width = patch_box(contact, radius), cells.x[-1], cells.y[-1]
    return box[0] >= 0.0 and box[1] <= length and box[2] >= 0.0 and box[3] <= width


@compiled()
def within_skin(contact: NDArray, radius: float, cells: GridCells) -> bool:
    """True if a patch lies on the skin entirely; also False where that is not certain."""
    return cells.whole and within_borders(contact, radius, cells)


@compiled()
def reason_invalid(contact: NDArray, by: int, cells: GridCells) -> int:
    """Number of the reason why a contact is invalid; FINE if it is not."""
    length, width = cells.x[-1], cells.y[-1]
    near_x, near_y = ROUNDING * length, ROUNDING * width
    if not (-near_x <= contact[X] <= length + near_x and -near_y <= contact[Y] <= width + near_y):
        return BAD_PLACE
    strength = contact[STRENGTH]
    if not 0.0 <= strength < np.inf:
        return BAD_STRENGTH
    if by >= FACTOR and not MIN_FACTOR <= strength <= MAX_FACTOR:
        return BAD_STRENGTH
    if contact[WIDTH] != 0.0 or contact[HEIGHT] != 0.0:
        known = 0.0 < contact[WIDTH] < np.inf and 0.0 < contact[HEIGHT] < np.inf
        return FINE if known else BAD_PATCH
    if not (contact[RADIUS] > 0.0 and contact[CURVATURE] > 0.0):
        return BAD_PATCH
    if contact[RADIUS] == np.inf and (contact[CURVATURE] == np.inf or by >= FACTOR):
        return BAD_PATCH
    return FINE


WEIGHTS = np.polynomial.legendre.leggauss(6)[1] / 2
"""Parts of the squared radius of a sphere's patch, of which each falls on one disc."""
RINGS = len(WEIGHTS) + 1
SHARED_STEPS = 50
SHARED = 1e-9
"""Steps, and relative error, of the force on an indenter that reaches beyond the skin's edge."""


@compiled()
def winkler_stacks(
    values: NDArray, counts: NDArray, by: int, foam: FoamTables, cells: GridCells
) -> tuple[Stacks, NDArray, NDArray, Fault]:
    """Stacks under contacts, and faults.

    values: see `contact_types.COLUMNS`, shape (press, contact, 7). counts: contacts of each press.
    Returned as well: True for presses whose foam would be compressed further than it can, shape
    (press,); and radius of each patch, m, 0 for a rectangle, shape (press, contact).
    """
    presses, most = values.shape[0], values.shape[1]
    radii, rises = np.zeros((presses, most, RINGS)), np.zeros((presses, most, RINGS))
    discs, strain = np.zeros((presses, most), np.int64), np.zeros((presses, most))
    stacks, pressures = Stacks(radii, rises, discs, strain), np.zeros(RINGS)
    patches, limited = np.zeros((presses, most)), np.zeros(presses, np.bool_)
    for press in range(presses):
        for k in range(counts[press]):
            contact = values[press, k]
            reason = reason_invalid(contact, by, cells)
            if reason == FINE:
                own = radii[press, k]
                if by >= FACTOR:
                    discs[press, k], rises[press, k, 0] = 1, contact[STRENGTH] - 1
                    own[0] = 0.0 if contact[WIDTH] > 0.0 else contact[RADIUS]
                else:
                    reached = winkler_strain(contact, by, foam, cells)
                    limited[press] |= reached > foam.greatest
                    strain[press, k] = min(reached, foam.greatest)
                    discs[press, k] = stack_of_discs(
                        contact, strain[press, k], foam, own, rises[press, k], pressures
                    )
                outer = patches[press, k] = own[discs[press, k] - 1]
                if not within_skin(contact, outer, cells) and not (
                    area_on_skin(contact, outer, cells) > 0.0
                ):
                    reason = OFF_SKIN
            if reason != FINE:
                return stacks, limited, patches, (press, k, reason)
    return stacks, limited, patches, (0, 0, FINE)


@compiled()
def winkler_strain(contact: NDArray, by: int, foam: FoamTables, cells: GridCells) -> float:
    """Strain under the middle of a contact; infinite if the foam cannot be compressed so far."""
    strength, radius, curvature = contact[STRENGTH], contact[RADIUS], contact[CURVATURE]
    if by == DEPTH:
        return strength / foam.thickness
    if contact[WIDTH] > 0.0 or curvature == np.inf:
        own = 0.0 if contact[WIDTH] > 0.0 else radius
        area = contact[WIDTH] * contact[HEIGHT] if own == 0.0 else np.pi * own * own
        if not within_skin(contact, own, cells):
            area = area_on_skin(contact, own, cells)
        if area == 0.0:
            return 0.0
        pressure = strength / area
        return np.inf if pressure > foam.closed else strain_under(foam, pressure)
    force, most = strength, indenter_force(foam, foam.greatest, radius, curvature)
    found = indenter_strain(foam, force, radius, curvature)
    if within_skin(contact, patch_radius(foam, found, radius, curvature), cells):
        return np.inf if force > most else found
    for _ in range(SHARED_STEPS):
        returned = force_on_skin(contact, found, foam, cells)
        if returned == 0.0:
            return found
        force *= strength / returned
        if force > most:
            return np.inf
        found = indenter_strain(foam, force, radius, curvature)
        if abs(returned - strength) <= SHARED * strength:
            break
    return found


@compiled()
def force_on_skin(contact: NDArray, strain: float, foam: FoamTables, cells: GridCells) -> float:
    """Force that the foam returns to a sphere that reaches beyond the skin's edge, N."""
    radii, rises, pressures = np.zeros(RINGS), np.zeros(RINGS), np.zeros(RINGS)
    discs = stack_of_discs(contact, strain, foam, radii, rises, pressures)
    on_skin, whole = 0.0, 0.0
    for k in range(discs):
        on_skin += pressures[k] * area_on_skin(contact, radii[k], cells)
        whole += pressures[k] * np.pi * radii[k] * radii[k]
    if whole == 0.0:
        return 0.0
    return on_skin / whole * indenter_force(foam, strain, contact[RADIUS], contact[CURVATURE])


@compiled()
def stack_of_discs(
    contact: NDArray,
    strain: float,
    foam: FoamTables,
    radii: NDArray,
    rises: NDArray,
    pressures: NDArray,
) -> int:
    """Discs whose rises and pressures add up to those under an indenter; returns their number.

    The rise falls along the squared distance from the middle; its fall over each weight of a Gauss
    rule is one disc, whose area keeps the volume, by Simpson's rule. Radii ascend, m; a rectangle
    has the radius 0.
    """
    if contact[WIDTH] > 0.0 or contact[CURVATURE] == np.inf:
        radii[0] = 0.0 if contact[WIDTH] > 0.0 else contact[RADIUS]
        rises[0] = rise_at(foam, strain)
        return 1
    patch = patch_radius(foam, strain, contact[RADIUS], contact[CURVATURE])
    low = edge_strain(foam, strain, contact[RADIUS], contact[CURVATURE])
    inner, at_inner = 0.0, rise_at(foam, strain)
    for k in range(len(WEIGHTS)):
        outer = inner + WEIGHTS[k]
        at_outer = rise_at(foam, strain - (strain - low) * outer)
        middle = rise_at(foam, strain - (strain - low) * (inner + outer) / 2)
        volume = (outer - inner) * (at_inner + 4 * middle + at_outer) / 6
        fall = at_inner - at_outer
        area = (inner + outer) / 2
        if fall > 0.0:
            area = min(max((inner * at_inner - outer * at_outer + volume) / fall, inner), outer)
        radii[k], rises[k] = patch * np.sqrt(area), fall
        if foam.modulus > 0.0:
            pressures[k] = stress(foam, strain - (strain - low) * inner)
            pressures[k] -= stress(foam, strain - (strain - low) * min(outer, 1.0))
        inner, at_inner = outer, at_outer
    last = len(WEIGHTS)
    radii[last], rises[last] = patch, at_inner
    pressures[last] = stress(foam, low) if foam.modulus > 0.0 else 0.0
    return last + 1 if low > 0.0 else last


@compiled()
def winkler_patch(
    contact: NDArray, by: int, foam: FoamTables, cells: GridCells
) -> tuple[float, float]:
    """Strain under a contact, at most the largest, and the patch's radius, m; 0 for a rectangle."""
    strain = min(winkler_strain(contact, by, foam, cells), foam.greatest)
    if contact[WIDTH] > 0.0:
        return strain, 0.0
    return strain, patch_radius(foam, strain, contact[RADIUS], contact[CURVATURE])

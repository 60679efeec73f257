"""Point contacts on the cells of a grid, compiled: foam that each patch presses alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...compiled import compiled
from .cell_samples import SAMPLES
from .foam_kernel import indenter_force, indenter_strain, rise_at, strain_under, stress
from .patch_kernel import (
    CURVATURE,
    HEIGHT,
    RADIUS,
    STRENGTH,
    WIDTH,
    X,
    Y,
    area_on_skin,
    box_cells,
    covered_part,
    patch_box,
    stack_of_discs,
)

RINGS = 8
FORCE, DEPTH, FACTOR, ADDED = range(4)
"""How a contact is given; ADDED: factors of touches that add a capacitance to earth."""
FINE, BAD_PLACE, BAD_STRENGTH, BAD_PATCH, OFF_SKIN = range(5)
ROUNDING, FAINT = 1e-9, 1e-12
SHARED_STEPS = 50
SHARED = 1e-9
"""Steps, and relative error, of the force on an indenter that reaches beyond the skin's edge."""


@compiled()
def pressed_cells(
    values: NDArray,
    counts: NDArray,
    by: int,
    law: NDArray,
    relative: NDArray,
    strains: NDArray,
    x: NDArray,
    y: NDArray,
    cut: NDArray,
    mask: NDArray,
    part: NDArray,
    whole: bool,
) -> tuple[NDArray, NDArray, NDArray, NDArray, NDArray, NDArray]:  # pragma: no cover
    """Cells that contacts press, the rises of c there, starts of presses, and faults.

    values: see `contact_types.COLUMNS`, shape (press, contact, 7). counts: contacts of each press.
    whole: True if all cells are skin. Returned as well: True for presses whose foam would be
    compressed further than it can, shape (press,); radius of each patch in m, 0 for a rectangle,
    shape (press, contact); and press, contact and reason of the first
    invalid contact, shape (3,). Forces of overlapping patches add their pressures; of depths the
    deeper counts; factors multiply.
    """
    presses, most = values.shape[0], values.shape[1]
    rows, columns = len(y) - 1, len(x) - 1
    cells, rises = np.empty(presses * 16, np.int64), np.empty(presses * 16)
    starts, clamped = np.zeros(presses + 1, np.int64), np.zeros(presses, np.bool_)
    fault = np.zeros(3, np.int64)
    total, shared_cell = np.zeros((rows, columns)), np.zeros((rows, columns), np.bool_)
    if by == FACTOR:
        total += 1.0
    patches = np.zeros((presses, most))
    radii, stacked = np.zeros((most, RINGS)), np.zeros((most, RINGS))
    pressures, strain = np.zeros((most, RINGS)), np.zeros(most)
    discs, spans = np.zeros(most, np.int64), np.zeros((most, 4), np.int64)
    found, span = 0, np.zeros(4, np.int64)
    for press in range(presses):
        count = counts[press]
        for k in range(count):
            contact = values[press, k]
            reason = _reason(contact, by, x[columns], y[rows])
            if reason != FINE:
                fault[0], fault[1], fault[2] = press, k, reason
                return cells[:0], rises[:0], starts, clamped, patches, fault
            if by >= FACTOR:
                strain[k], discs[k], stacked[k, 0] = 0.0, 1, contact[STRENGTH] - 1
                radii[k, 0] = 0.0 if contact[WIDTH] > 0.0 else contact[RADIUS]
            else:
                strain[k] = _strain(contact, by, law, strains, x, y, cut, mask, part, whole)
                if strain[k] > law[4]:
                    strain[k], clamped[press] = law[4], True
                discs[k] = stack_of_discs(
                    contact, strain[k], law, relative, radii[k], stacked[k], pressures[k]
                )
            outer = radii[k, discs[k] - 1]
            patches[press, k] = outer
            box_cells(patch_box(contact, outer), x, y, spans[k])
            if not _within(contact, outer, x[columns], y[rows], whole) and not (
                area_on_skin(contact, outer, x, y, cut, mask, part) > 0.0
            ):
                fault[0], fault[1], fault[2] = press, k, OFF_SKIN
                return cells[:0], rises[:0], starts, clamped, patches, fault
        left, right, bottom, top = columns, 0, rows, 0
        for k in range(count):
            left, right = min(left, spans[k, 0]), max(right, spans[k, 1])
            bottom, top = min(bottom, spans[k, 2]), max(top, spans[k, 3])
            for disc in range(discs[k]):
                box, radius = patch_box(values[press, k], radii[k, disc]), radii[k, disc]
                box_cells(box, x, y, span)
                for i in range(span[2], span[3]):
                    for j in range(span[0], span[1]):
                        covered = covered_part(box, radius, i, j, x, y, cut, mask)
                        if by == FACTOR:
                            total[i, j] *= (1 - covered) + (1 + stacked[k, disc]) * covered
                        else:
                            total[i, j] += stacked[k, disc] * covered
        if by < FACTOR and count > 1:
            for k in range(count):
                for m in range(k):
                    if not _meet(values[press], radii, discs, k, m):
                        continue
                    for i in range(max(spans[k, 2], spans[m, 2]), min(spans[k, 3], spans[m, 3])):
                        for j in range(
                            max(spans[k, 0], spans[m, 0]), min(spans[k, 1], spans[m, 1])
                        ):
                            if shared_cell[i, j]:
                                continue
                            shared_cell[i, j] = True
                            total[i, j], beyond = _sampled(
                                values[press],
                                count,
                                strain,
                                by,
                                law,
                                relative,
                                strains,
                                i,
                                j,
                                x,
                                y,
                                cut,
                                mask,
                            )
                            clamped[press] |= beyond
        if found + max(right - left, 0) * max(top - bottom, 0) > len(cells):
            more = 2 * len(cells) + rows * columns
            cells, rises = _longer(cells, rises, found, more)
        for i in range(bottom, top):
            for j in range(left, right):
                rise = total[i, j] - (by == FACTOR)
                shared_cell[i, j], total[i, j] = False, 1.0 if by == FACTOR else 0.0
                if abs(rise) > FAINT:
                    cells[found], rises[found] = i * columns + j, rise
                    found += 1
        starts[press + 1] = found
    return cells[:found], rises[:found], starts, clamped, patches, fault


@compiled()
def _longer(
    cells: NDArray, rises: NDArray, found: int, more: int
) -> tuple[NDArray, NDArray]:  # pragma: no cover
    new_cells, new_rises = np.empty(more, np.int64), np.empty(more)
    for k in range(found):
        new_cells[k], new_rises[k] = cells[k], rises[k]
    return new_cells, new_rises


@compiled()
def _reason(contact: NDArray, by: int, length: float, width: float) -> int:  # pragma: no cover
    """Number of the reason why a contact is invalid; FINE if it is not."""
    near_x, near_y = ROUNDING * length, ROUNDING * width
    if not (-near_x <= contact[X] <= length + near_x and -near_y <= contact[Y] <= width + near_y):
        return BAD_PLACE
    strength = contact[STRENGTH]
    if not 0.0 <= strength < np.inf or (by >= FACTOR and strength == 0.0):
        return BAD_STRENGTH
    if contact[WIDTH] != 0.0 or contact[HEIGHT] != 0.0:
        known = 0.0 < contact[WIDTH] < np.inf and 0.0 < contact[HEIGHT] < np.inf
        return FINE if known else BAD_PATCH
    if not (contact[RADIUS] > 0.0 and contact[CURVATURE] > 0.0):
        return BAD_PATCH
    if contact[RADIUS] == np.inf and (contact[CURVATURE] == np.inf or by >= FACTOR):
        return BAD_PATCH
    return FINE


@compiled()
def _strain(
    contact: NDArray,
    by: int,
    law: NDArray,
    strains: NDArray,
    x: NDArray,
    y: NDArray,
    cut: NDArray,
    mask: NDArray,
    part: NDArray,
    whole: bool,
) -> float:  # pragma: no cover
    """Strain under the middle of a contact; infinite if the foam cannot be compressed so far."""
    strength, radius, curvature = contact[STRENGTH], contact[RADIUS], contact[CURVATURE]
    if by == DEPTH:
        return strength / law[5]
    flat = contact[WIDTH] > 0.0 or curvature == np.inf
    length, width = x[len(x) - 1], y[len(y) - 1]
    if flat:
        own = 0.0 if contact[WIDTH] > 0.0 else radius
        area = contact[WIDTH] * contact[HEIGHT] if own == 0.0 else np.pi * own * own
        if not _within(contact, own, length, width, whole):
            area = area_on_skin(contact, own, x, y, cut, mask, part)
        if area == 0.0:
            return 0.0
        pressure = strength / area
        return np.inf if pressure > law[6] else strain_under(law, strains, pressure)
    force, most = strength, indenter_force(law, law[4], radius, curvature)
    found = indenter_strain(law, force, radius, curvature)
    outer = min(radius, np.sqrt(2 * curvature * found * law[5]))
    if _within(contact, outer, length, width, whole):
        return np.inf if force > most else found
    for _ in range(SHARED_STEPS):
        held = force_on_skin(contact, found, law, x, y, cut, mask, part)
        if held == 0.0:
            return found
        force *= strength / held
        if force > most:
            return np.inf
        found = indenter_strain(law, force, radius, curvature)
        if abs(held - strength) <= SHARED * strength:
            break
    return found


@compiled()
def force_on_skin(
    contact: NDArray,
    strain: float,
    law: NDArray,
    x: NDArray,
    y: NDArray,
    cut: NDArray,
    mask: NDArray,
    part: NDArray,
) -> float:  # pragma: no cover
    """Force of a spherical indenter that reaches beyond the skin's edge, N."""
    radii, rises, pressures = np.zeros(RINGS), np.zeros(RINGS), np.zeros(RINGS)
    discs = stack_of_discs(contact, strain, law, np.ones(2), radii, rises, pressures)
    force = 0.0
    for k in range(discs):
        force += pressures[k] * area_on_skin(contact, radii[k], x, y, cut, mask, part)
    return force


@compiled()
def _within(
    contact: NDArray, radius: float, length: float, width: float, whole: bool
) -> bool:  # pragma: no cover
    """True if a patch lies on the skin entirely; also False where that is not certain."""
    box = patch_box(contact, radius)
    inside = box[0] >= 0.0 and box[1] <= length and box[2] >= 0.0 and box[3] <= width
    return whole and inside


@compiled()
def _meet(
    contacts: NDArray, radii: NDArray, discs: NDArray, one: int, other: int
) -> bool:  # pragma: no cover
    """True if two patches may overlap: discs do, boxes around them do if one is a rectangle."""
    own, its = radii[one, discs[one] - 1], radii[other, discs[other] - 1]
    along, across = contacts[one, X] - contacts[other, X], contacts[one, Y] - contacts[other, Y]
    if own > 0.0 and its > 0.0:
        return along * along + across * across < (own + its) * (own + its) * (1 - ROUNDING)
    first, second = patch_box(contacts[one], own), patch_box(contacts[other], its)
    wide = min(first[1], second[1]) - max(first[0], second[0])
    high = min(first[3], second[3]) - max(first[2], second[2])
    return wide > ROUNDING * (first[1] - first[0]) and high > ROUNDING * (first[3] - first[2])


@compiled()
def _strain_at(
    contact: NDArray, strain: float, law: NDArray, at_x: float, at_y: float
) -> float:  # pragma: no cover
    """Strain that a contact alone causes at a position, `strain` in its middle."""
    along, across = at_x - contact[X], at_y - contact[Y]
    if contact[WIDTH] > 0.0:
        under = abs(along) <= contact[WIDTH] / 2 and abs(across) <= contact[HEIGHT] / 2
        return strain if under else 0.0
    far = along * along + across * across
    if far > contact[RADIUS] * contact[RADIUS]:
        return 0.0
    return max(strain - far / (2 * contact[CURVATURE] * law[5]), 0.0)


@compiled()
def _sampled(
    contacts: NDArray,
    count: int,
    strain: NDArray,
    by: int,
    law: NDArray,
    relative: NDArray,
    strains: NDArray,
    i: int,
    j: int,
    x: NDArray,
    y: NDArray,
    cut: NDArray,
    mask: NDArray,
) -> tuple[float, bool]:  # pragma: no cover
    """Mean rise of a cell under overlapping patches, from samples; True if it was limited."""
    own, there, total, beyond = cut[i, j], 0, 0.0, False
    for k in range(SAMPLES):
        at_y = y[i] + (k + 0.5) / SAMPLES * (y[i + 1] - y[i])
        for m in range(SAMPLES):
            if own >= 0 and not mask[own, k, m]:
                continue
            there += 1
            at_x = x[j] + (m + 0.5) / SAMPLES * (x[j + 1] - x[j])
            deepest, pressure, under = 0.0, 0.0, 0
            for contact in range(count):
                depth = _strain_at(contacts[contact], strain[contact], law, at_x, at_y)
                deepest = max(deepest, depth)
                if by == FORCE and depth > 0.0:
                    pressure += stress(law, depth)
                    under += 1
            if under > 1:
                beyond |= pressure > law[6]
                deepest = strain_under(law, strains, min(pressure, law[6]))
            total += rise_at(law, relative, deepest)
    return (total / there if there else 0.0), beyond

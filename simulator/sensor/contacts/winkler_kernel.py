"""Point contacts on foam that each patch presses alone, compiled: strain, and discs of rises."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...compiled import compiled
from .foam_kernel import (
    edge_strain,
    indenter_force,
    indenter_strain,
    patch_radius,
    rise_at,
    strain_under,
    stress,
)
from .patch_kernel import (
    CURVATURE,
    DEPTH,
    FACTOR,
    FINE,
    HEIGHT,
    OFF_SKIN,
    RADIUS,
    STRENGTH,
    WIDTH,
    area_on_skin,
    reason_invalid,
    within_skin,
)

WEIGHTS = np.polynomial.legendre.leggauss(6)[1] / 2
"""Parts of the squared radius of a sphere's patch, of which each falls on one disc."""
RINGS = len(WEIGHTS) + 1
SHARED_STEPS = 50
SHARED = 1e-9
"""Steps, and relative error, of the force on an indenter that reaches beyond the skin's edge."""


@compiled()
def winkler_stacks(
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
) -> tuple[NDArray, NDArray, NDArray, NDArray, NDArray, NDArray, NDArray]:  # pragma: no cover
    """Discs of rises under contacts: their radii, rises and number, strains, and faults.

    values: see `contact_types.COLUMNS`, shape (press, contact, 7). counts: contacts of each press.
    whole: True if all cells are skin. The first four results are those that `cells_of_stacks`
    takes. Returned as well: True for presses whose foam would be compressed further than it can,
    shape (press,); radius of each patch, m, 0 for a rectangle, shape (press, contact); and press,
    contact and reason of the first invalid contact, shape (3,).
    """
    presses, most = values.shape[0], values.shape[1]
    radii, stacked = np.zeros((presses, most, RINGS)), np.zeros((presses, most, RINGS))
    discs, strain = np.zeros((presses, most), np.int64), np.zeros((presses, most))
    patches, limited = np.zeros((presses, most)), np.zeros(presses, np.bool_)
    fault, pressures = np.zeros(3, np.int64), np.zeros(RINGS)
    length, width = x[len(x) - 1], y[len(y) - 1]
    for press in range(presses):
        for k in range(counts[press]):
            contact = values[press, k]
            reason = reason_invalid(contact, by, length, width)
            if reason == FINE:
                if by >= FACTOR:
                    discs[press, k], stacked[press, k, 0] = 1, contact[STRENGTH] - 1
                    radii[press, k, 0] = 0.0 if contact[WIDTH] > 0.0 else contact[RADIUS]
                else:
                    own = winkler_strain(contact, by, law, strains, x, y, cut, mask, part, whole)
                    limited[press] |= own > law[4]
                    strain[press, k] = min(own, law[4])
                    discs[press, k] = stack_of_discs(
                        contact,
                        strain[press, k],
                        law,
                        relative,
                        radii[press, k],
                        stacked[press, k],
                        pressures,
                    )
                outer = radii[press, k, discs[press, k] - 1]
                patches[press, k] = outer
                if not within_skin(contact, outer, length, width, whole) and not (
                    area_on_skin(contact, outer, x, y, cut, mask, part) > 0.0
                ):
                    reason = OFF_SKIN
            if reason != FINE:
                fault[0], fault[1], fault[2] = press, k, reason
                return radii, stacked, discs, strain, limited, patches, fault
    return radii, stacked, discs, strain, limited, patches, fault


@compiled()
def winkler_strain(
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
    length, width = x[len(x) - 1], y[len(y) - 1]
    if contact[WIDTH] > 0.0 or curvature == np.inf:
        own = 0.0 if contact[WIDTH] > 0.0 else radius
        area = contact[WIDTH] * contact[HEIGHT] if own == 0.0 else np.pi * own * own
        if not within_skin(contact, own, length, width, whole):
            area = area_on_skin(contact, own, x, y, cut, mask, part)
        if area == 0.0:
            return 0.0
        pressure = strength / area
        return np.inf if pressure > law[6] else strain_under(law, strains, pressure)
    force, most = strength, indenter_force(law, law[4], radius, curvature)
    found = indenter_strain(law, force, radius, curvature)
    if within_skin(contact, patch_radius(law, found, radius, curvature), length, width, whole):
        return np.inf if force > most else found
    for _ in range(SHARED_STEPS):
        returned = force_on_skin(contact, found, law, x, y, cut, mask, part)
        if returned == 0.0:
            return found
        force *= strength / returned
        if force > most:
            return np.inf
        found = indenter_strain(law, force, radius, curvature)
        if abs(returned - strength) <= SHARED * strength:
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
    """Force that the foam returns to a sphere that reaches beyond the skin's edge, N."""
    radii, rises, pressures = np.zeros(RINGS), np.zeros(RINGS), np.zeros(RINGS)
    discs = stack_of_discs(contact, strain, law, np.ones(2), radii, rises, pressures)
    on_skin, whole = 0.0, 0.0
    for k in range(discs):
        on_skin += pressures[k] * area_on_skin(contact, radii[k], x, y, cut, mask, part)
        whole += pressures[k] * np.pi * radii[k] * radii[k]
    if whole == 0.0:
        return 0.0
    return on_skin / whole * indenter_force(law, strain, contact[RADIUS], contact[CURVATURE])


@compiled()
def stack_of_discs(
    contact: NDArray,
    strain: float,
    law: NDArray,
    relative: NDArray,
    radii: NDArray,
    rises: NDArray,
    pressures: NDArray,
) -> int:  # pragma: no cover
    """Discs whose rises and pressures add up to those under an indenter; returns their number.

    The rise falls along the squared distance from the middle; its fall over each weight of a Gauss
    rule is one disc, whose area keeps the volume, by Simpson's rule. Radii ascend, m; a rectangle
    has the radius 0.
    """
    if contact[WIDTH] > 0.0 or contact[CURVATURE] == np.inf:
        radii[0] = 0.0 if contact[WIDTH] > 0.0 else contact[RADIUS]
        rises[0] = rise_at(law, relative, strain)
        return 1
    patch = patch_radius(law, strain, contact[RADIUS], contact[CURVATURE])
    low = edge_strain(law, strain, contact[RADIUS], contact[CURVATURE])
    inner, at_inner = 0.0, rise_at(law, relative, strain)
    for k in range(len(WEIGHTS)):
        outer = inner + WEIGHTS[k]
        at_outer = rise_at(law, relative, strain - (strain - low) * outer)
        middle = rise_at(law, relative, strain - (strain - low) * (inner + outer) / 2)
        volume = (outer - inner) * (at_inner + 4 * middle + at_outer) / 6
        fall = at_inner - at_outer
        area = (inner + outer) / 2
        if fall > 0.0:
            area = min(max((inner * at_inner - outer * at_outer + volume) / fall, inner), outer)
        radii[k], rises[k] = patch * np.sqrt(area), fall
        if law[1] > 0.0:
            pressures[k] = stress(law, strain - (strain - low) * inner)
            pressures[k] -= stress(law, strain - (strain - low) * min(outer, 1.0))
        inner, at_inner = outer, at_outer
    last = len(WEIGHTS)
    radii[last], rises[last] = patch, at_inner
    pressures[last] = stress(law, low) if law[1] > 0.0 else 0.0
    return last + 1 if low > 0.0 else last


@compiled()
def winkler_patch(
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
) -> tuple[float, float]:  # pragma: no cover
    """Strain under a contact, at most the largest, and the patch's radius, m; 0 for a rectangle."""
    strain = min(winkler_strain(contact, by, law, strains, x, y, cut, mask, part, whole), law[4])
    if contact[WIDTH] > 0.0:
        return strain, 0.0
    return strain, patch_radius(law, strain, contact[RADIUS], contact[CURVATURE])

"""Contacts of a MuJoCo model that press a mounted skin."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Integer, Real
from ..compiled import compiled
from ..models.mechanics.foam_law import FoamTables
from .contact_curvature import POINT, GeomNumbers, PatchRule
from .contact_patches import (
    DEPTH,
    FORCE,
    MOST_DISCS,
    NORMAL,
    POINT_COLUMNS,
    TRIANGLE,
    X,
    Y,
    press_of_geom,
)
from .engine import MjData, MjModel, engine
from .skin_mount import SkinMount
from .skin_polygons import ROUNDING, SkinArea
from .skin_surface_in_space import SurfaceNumbers, place_of

MIN_COSINE = 0.5
"""Smallest cosine between the normals of a contact and of the skin: 60°; steeper ones press an edge
or another side of the geom that carries the skin."""
NOTABLE = 0.01
"""Part of a force beside the skin from which it is worth a warning, which comes once."""


class SkinContacts(NamedTuple):
    """Touching geoms, each with its patch on a skin, and what a skin does not feel of them.

    x: middle of the patch on the unrolled skin, m, (2, contact). force: normal to the skin, N,
    (contact,). geom: number of the touching geom, that of a soft body behind all geoms, (contact,).
    normals: outward from the skin in the world, (3, contact). points: middle of the engine's points
    in the world, m, (3, contact). area: of the patch, m², (contact,). depth: largest one in the
    engine, m, (contact,). beside: force on the geoms that carry the skin, which it does not feel,
    N; overhang: part of it beside the skin's edge, and overhanging: geom with the largest one, or
    -1.
    """

    x: Real
    force: Real
    geom: Integer
    normals: Real
    points: Real
    area: Real
    depth: Real
    beside: float
    overhang: float
    overhanging: int

    @property
    def count(self) -> int:
        """Number of touching geoms that the skin feels."""
        return self.force.size

    @property
    def overhangs(self) -> bool:
        """True if a notable part of the force lies beside the skin."""
        return self.overhang > NOTABLE * (self.overhang + self.force.sum())


class EngineContacts(NamedTuple):
    """Contacts of the engine as it has them; see `mjContact` and `mjData.efc_force`."""

    geom: NDArray[np.int32]
    flex: NDArray[np.int32]
    pos: NDArray[np.float64]
    frame: NDArray[np.float64]
    dist: NDArray[np.float64]
    dim: NDArray[np.int32]
    address: NDArray[np.int32]
    efc_force: NDArray[np.float64]
    pyramids: bool


NONE = np.zeros(0)
NO_CONTACTS = SkinContacts(
    *(np.zeros((2, 0)), NONE, NONE.astype(int), np.zeros((3, 0)), np.zeros((3, 0)), NONE),
    *(NONE, 0.0, 0.0, -1),
)
NO_PATCHES = np.zeros((0, 5))


def skin_contacts(
    model: MjModel, data: MjData, mount: SkinMount, rule: PatchRule, foam: FoamTables
) -> tuple[SkinContacts, Real]:
    """Touching geoms on a skin now, and their patches: x, y, force, radius and curvature radius.

    The force is that along the normal of the contact; friction is not felt. Patches that are deeper
    in the engine than the foam is thick compress it as far as it goes.
    """
    if not data.ncon:
        return NO_CONTACTS, NO_PATCHES
    every = data.contact
    pyramids = int(model.opt.cone) == int(engine().mjtCone.mjCONE_PYRAMIDAL)
    given = EngineContacts(
        *(every.geom, every.flex, every.pos, every.frame, every.dist, every.dim),
        *(every.efc_address, data.efc_force, pyramids),
    )
    geoms = mount.geom_numbers(data)
    on = mount.pose(data), mount.numbers, mount.area, rule, foam
    table, geom, patches, beside, overhang, worst = _pressed_by_geoms(given, geoms, *on)
    x, normals, points, (force, area, depth) = np.split(table.T, [2, 5, 8])
    contacts = SkinContacts(x, force, geom, normals, points, area, depth, beside, overhang, worst)
    return contacts, patches


@compiled()
def _pressed_by_geoms(
    contacts: EngineContacts,
    geoms: GeomNumbers,
    pose: tuple[NDArray, NDArray],
    surface: SurfaceNumbers,
    area: SkinArea,
    rule: PatchRule,
    foam: FoamTables,
) -> tuple[NDArray, NDArray, NDArray, float, float, int]:
    """Touching geoms, their numbers, patches, and forces that are not felt.

    A row of the first is x, y, normal, point, force, area and depth, (contact, 11).
    """
    points, pairs, beside = _pressing_points(contacts, geoms, pose, surface, foam.thickness)
    patches, found = np.empty((MOST_DISCS * len(points), 5)), 0
    table, others, touching = np.zeros((len(points), 11)), np.empty(len(points), np.int64), 0
    overhang, worst, most = 0.0, -1, 0.0
    for k in range(len(points)):
        own, count, force, depth = np.empty((len(points), POINT_COLUMNS)), 0, 0.0, 0.0
        if pairs[k, 0] < 0:
            continue
        first, other = pairs[k, 0], pairs[k, 1]
        for m in range(k, len(points)):
            if pairs[m, 0] == first and pairs[m, 1] == other:
                pairs[m, 0] = -1
                force, depth = force + points[m, FORCE], max(depth, points[m, DEPTH])
                for column in range(POINT_COLUMNS):
                    own[count, column] = points[m, column]
                count += 1
        press = press_of_geom(
            own[:count], first, other, geoms, pose, surface, area, rule, foam, patches, found
        )
        found = press.found
        left = force - press.force if press.force < (1 - ROUNDING) * force else 0.0
        overhang += left
        if left > most:
            worst, most = other, left
        if press.force > 0.0:
            row, others[touching] = table[touching], other
            row[0], row[1] = press.x, press.y
            row[8], row[9], row[10] = press.force, press.area, depth
            for axis in range(3):
                row[5 + axis] = pose[0][axis]
                for m in range(count):
                    for j in range(3):
                        row[2 + axis] += pose[1][axis, j] * own[m, NORMAL + j] / count
                        row[5 + axis] += pose[1][axis, j] * own[m, POINT + j] / count
            touching += 1
    return table[:touching], others[:touching], patches[:found], beside + overhang, overhang, worst


@compiled()
def _pressing_points(
    contacts: EngineContacts,
    geoms: GeomNumbers,
    pose: tuple[NDArray, NDArray],
    surface: SurfaceNumbers,
    reach: float,
) -> tuple[NDArray, NDArray, float]:
    """Contact points on the skin's side of its geoms, and on their planes beside it.

    Returned as well: numbers of the geom that carries the skin and of the other, and the force on
    other sides, N. reach: largest distance between the surfaces of the skin and of its geom, m.
    """
    count, found, beside = len(contacts.dist), 0, 0.0
    points, pairs = np.empty((count, POINT_COLUMNS)), np.empty((count, 2), np.int64)
    origin, axes = pose
    normal, at = np.zeros(3), np.zeros(3)
    for k in range(count):
        one, two = contacts.geom[k, 0], contacts.geom[k, 1]
        first, second = one >= 0 and geoms.own[one], two >= 0 and geoms.own[two]
        force = _normal_force(contacts, k)
        if first == second or not force > 0.0:
            continue
        other = two if first else one
        if other < 0:
            other = len(geoms.kind) + contacts.flex[k, 1 if first else 0]
        depth, outward = max(-contacts.dist[k], 0.0), 1.0 if first else -1.0
        for i in range(3):
            normal[i], at[i] = 0.0, 0.0
            for j in range(3):
                way = outward * contacts.frame[k, j]
                normal[i] += axes[j, i] * way
                at[i] += axes[j, i] * (contacts.pos[k, j] + depth / 2 * way - origin[j])
        place = place_of(surface, at[0], at[1], at[2])
        up = place.normal
        cosine = normal[0] * up[0] + normal[1] * up[1] + normal[2] * up[2]
        if cosine < MIN_COSINE or abs(place.height) > reach:
            beside += force
            continue
        row, pairs[found, 0], pairs[found, 1] = points[found], one if first else two, other
        row[X], row[Y], row[FORCE], row[DEPTH] = place.x, place.y, force, depth
        row[TRIANGLE] = place.triangle
        for i in range(3):
            row[POINT + i], row[NORMAL + i] = at[i], up[i]
        found += 1
    return points[:found], pairs[:found], beside


@compiled()
def _normal_force(contacts: EngineContacts, k: int) -> float:
    """Force along the normal of a contact, N, as `mj_contactForce` adds it up."""
    first, force = contacts.address[k], 0.0
    if first < 0:
        return 0.0
    sides = 2 * (contacts.dim[k] - 1) if contacts.pyramids and contacts.dim[k] > 1 else 1
    for side in range(sides):
        force += contacts.efc_force[first + side]
    return force  # pyright: ignore[reportReturnType]

"""Contacts of a MuJoCo model that press a mounted skin."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Integer, Mask, Real
from .engine import MjData, MjModel, engine
from .skin_mount import SkinMount

MIN_COSINE = 0.5
"""Smallest cosine between the normals of a contact and of the skin: 60°; steeper ones press an edge
or another side of the geom that carries the skin."""


class SkinContacts(NamedTuple):
    """Contact points on a skin, as the engine gives them.

    x: on the unrolled skin, m, (2, contact). force: normal to the skin, N, (contact,). geom: number
    of the touching geom, (contact,). normals: outward from the skin in the world, (3, contact).
    points: in the world, m, (3, contact).
    """

    x: Real
    force: Real
    geom: Integer
    normals: Real
    points: Real

    @property
    def count(self) -> int:
        """Number of contact points."""
        return self.force.size

    def where(self, mask: Mask) -> SkinContacts:
        """Contact points where a mask is True."""
        x, normals, points = (each[:, mask] for each in (self.x, self.normals, self.points))
        return SkinContacts(x, self.force[mask], self.geom[mask], normals, points)


def skin_contacts(model: MjModel, data: MjData, mount: SkinMount, reach: float) -> SkinContacts:
    """Contact points that press a skin now.

    Friction counts by its part along the skin's normal. reach: largest distance of a contact point
    from the skin's surface, m.
    """
    pairs = np.asarray(data.contact.geom).reshape(-1, 2)[: data.ncon]
    own = np.isin(pairs, mount.geoms)
    which = np.flatnonzero(own.any(axis=1) & ~own.all(axis=1) & (pairs >= 0).all(axis=1))
    origin, axes = mount.pose(data)
    points = np.asarray(data.contact.pos).reshape(-1, 3)[which].T
    frames = np.asarray(data.contact.frame).reshape(-1, 3, 3)[which]
    outward = np.where(own[which, 0], 1.0, -1.0)
    places = mount.surface.places(axes.T @ (points - origin[:, None]))
    normals = axes @ places.normals
    along = outward[:, None] * np.einsum("kij,jk->ki", frames, normals)
    force = np.einsum("ki,ki->k", _forces(model, data, which), along)
    presses = (abs(places.height) <= reach) & (along[:, 0] >= MIN_COSINE) & places.on & (force > 0)
    geom = np.where(own[which, 0], pairs[which, 1], pairs[which, 0]).astype(np.int64)
    return SkinContacts(places.x, force, geom, normals, points).where(presses)


def _forces(model: MjModel, data: MjData, which: NDArray[np.intp]) -> Real:
    """Force of each contact in its own frame, N, (contact, 3)."""
    mujoco = engine()

    forces, found = np.zeros((which.size, 3)), np.zeros(6)
    for k, contact in enumerate(which):
        mujoco.mj_contactForce(model, data, int(contact), found)
        forces[k] = found[:3]
    return forces

"""Patches on the skin for the contact points of rigid geoms."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple, get_args

import numpy as np

from ..arrays import Real
from ..scene.foam.foam_mechanics import Elastic
from ..scene.planar import inside
from ..sweeps import InputError
from .engine import Geom, MjData, MjModel
from .skin_contacts import SkinContacts

PatchName = Literal["hertz", "applicator", "image"]
PATCHES = get_args(PatchName)
FLAT = 0.9
"""Smallest cosine between a cylinder's axis and the skin's normal for a contact by its flat end."""
PER_SIDE = 6
"""Discs along the longer side of a patch with several contact points."""
SAMPLES, HALVINGS = 16, 40
THIN = 0.05
"""Width over length of several contact points below which they lie on a line."""


class Patches(NamedTuple):
    """Round patches on the unrolled skin.

    x, y: m. force: N. radius: m. curvature_radius: of the indenter, inf if it is flat, m. All have
    the shape (patch,).
    """

    x: Real
    y: Real
    force: Real
    radius: Real
    curvature_radius: Real


class Indenter(NamedTuple):
    """End of a touching geom. radius: limit of its patch, m. curvature: inf if it is flat, m."""

    radius: float
    curvature: float


NO_PATCHES = Patches(*np.zeros((5, 0)))


@dataclass(frozen=True)
class PatchRule:
    """Rule that gives each contact point its patch.

    kind: "hertz" for a sphere of the geom's radius of curvature, pressed into the foam;
    "applicator" for a flat end as wide as the geom; or the radius of all patches, m. law,
    thickness: of the foam; edges and corners are as round as it is thick, m. curvature: radius of
    curvature of geoms by number, m.
    """

    kind: PatchName | float
    law: Elastic
    thickness: float
    curvature: dict[int, float]

    def patches(self, model: MjModel, data: MjData, contacts: SkinContacts) -> Patches:
        """Patches of contact points; those of one geom are spread over the area between them."""
        each = [
            self._of_geom(Geom(model, data, int(geom)), contacts.where(contacts.geom == geom))
            for geom in np.unique(contacts.geom)
        ]
        return Patches(*np.hstack([np.stack(one) for one in each])) if each else NO_PATCHES

    def _of_geom(self, geom: Geom, contacts: SkinContacts) -> Patches:
        if isinstance(self.kind, float):
            return _of(contacts.x, contacts.force, Indenter(self.kind, np.inf))
        normal = geom.axes.T @ contacts.normals.mean(axis=1)
        if geom.kind == "cylinder" and abs(normal[2]) > FLAT:
            disc = Indenter(float(geom.size[0]), np.inf)
            middle = np.average(contacts.x, axis=1, weights=contacts.force)[:, None]
            return _of(middle, contacts.force.sum(keepdims=True), disc)
        if contacts.count > 2 and _width(contacts.x) > THIN:
            return _spread(contacts.x, contacts.force)
        end = self._end(geom, normal, geom.axes.T @ (contacts.points[:, 0] - geom.place))
        if contacts.count == 1:
            return _of(contacts.x, contacts.force, end)
        return _strip(contacts.x, contacts.force, self._strip_width(contacts, end))

    def _strip_width(self, contacts: SkinContacts, end: Indenter) -> float:
        """Width of the strip under a geom that lies on the skin between its contact points, m."""
        if np.isinf(end.curvature):
            return 2 * end.radius
        offsets = contacts.x - contacts.x.mean(axis=1, keepdims=True)
        length = 2 * float(np.linalg.norm(offsets, axis=0).max())
        per_length = contacts.force.sum() / max(length, end.radius)
        return 2 * strip_half_width(self.law, self.thickness, end.curvature, per_length)

    def _end(self, geom: Geom, normal: Real, place: Real) -> Indenter:
        """End of a geom at a place, with the skin's normal there, both in the geom's frame."""
        kind, size, flat = geom.kind, geom.size, self.kind == "applicator"
        if geom.number in self.curvature:
            radius = self.curvature[geom.number]
        elif kind in ("sphere", "capsule", "cylinder"):
            radius = float(size[0])
        elif kind == "ellipsoid":
            squares = size**2
            shadow = np.sqrt(np.prod(squares) * (normal**2 / squares).sum())
            if flat:
                return Indenter(float(np.sqrt(shadow)), np.inf)
            gaussian = np.prod(squares) * (place**2 / squares**2).sum() ** 2
            radius = float(np.sqrt(gaussian))
        elif kind == "box":
            return Indenter(self.thickness, self.thickness)
        else:
            raise InputError(
                f"MujocoSkin: the radius of curvature of geom {geom.name} ({kind}) is not known;"
                ' give it in `curvature`, or patch="image", or the radius of the patch'
            )
        return Indenter(radius, np.inf if flat else radius)


def strip_half_width(law: Elastic, thickness: float, radius: float, load: float) -> float:
    """Half of the width of the contact with a long cylinder, m.

    Columns of foam that do not hold each other bear it: load = 2 int p((d - x²/2R)/h) dx over
    x = 0..a, a² = 2 R d. radius: of the cylinder, m. load: N/m.
    """
    part = (np.arange(SAMPLES) + 0.5) / SAMPLES
    low, high = 0.0, law.greatest_strain
    for _ in range(HALVINGS):
        strain = (low + high) / 2
        half = np.sqrt(2 * radius * strain * thickness)
        if 2 * half * law.stress(strain * (1 - part**2)).mean() > load:
            high = strain
        else:
            low = strain
    return float(min(np.sqrt(2 * radius * high * thickness), radius))


def _of(x: Real, force: Real, end: Indenter) -> Patches:
    """Patches of one indenter at places x, m, (2, n)."""
    same = np.ones(force.size)
    return Patches(x[0], x[1], force, end.radius * same, end.curvature * same)


def _width(x: Real) -> float:
    """Width of points (2, n) over their length."""
    values = np.linalg.svd(x - x.mean(axis=1, keepdims=True), compute_uv=False)
    return float(values[1] / values[0]) if values[0] > 0 else 0.0


def _strip(x: Real, force: Real, width: float) -> Patches:
    """Discs over a strip of a width, m, along the line through points x (2, n).

    They have the area of the strip, and forces of the same sum and moment.
    """
    middle = x.mean(axis=1, keepdims=True)
    direction = np.linalg.svd(x - middle)[0][:, 0]
    along = direction @ (x - middle)
    length = np.ptp(along)
    count = max(round(length / width), 1)
    at = along.min() + length * (np.arange(count) + 0.5) / count
    radius = max(np.sqrt(length * width / count / np.pi), width / 2 if count == 1 else 0.0)
    forces = _balanced(np.array([at]), np.array([along]), force)
    return _of(middle + np.outer(direction, at), forces, Indenter(float(radius), np.inf))


def _spread(x: Real, force: Real) -> Patches:
    """Discs over the convex hull of points x (2, n), with the same force and moments."""
    from scipy.spatial import ConvexHull

    hull = ConvexHull(x.T)
    corners = x[:, hull.vertices].T
    low, high = corners.min(axis=0), corners.max(axis=0)
    step = (high - low).max() / PER_SIDE
    counts = np.maximum(np.round((high - low) / step), 1).astype(int)
    sides = [low[k] + (high[k] - low[k]) * (np.arange(n) + 0.5) / n for k, n in enumerate(counts)]
    grid = np.stack(np.meshgrid(*sides)).reshape(2, -1)
    at = grid[:, inside(corners, grid)]
    if not at.size:
        at = x.mean(axis=1, keepdims=True)
    radius = float(np.sqrt(hull.volume / at.shape[1] / np.pi))
    return _of(at, _balanced(at, x, force), Indenter(radius, np.inf))


def _balanced(at: Real, x: Real, force: Real) -> Real:
    """Forces >= 0 at places `at` (axis, n), with the sum of `force` at x and nearly its moments.

    They are linear in the place; negative ones become 0, and the others are scaled.
    """
    total, middle = force.sum(), at.mean(axis=1, keepdims=True)
    away = at - middle
    moments = (x - middle) @ force
    slopes = np.linalg.lstsq(away @ away.T, moments, rcond=None)[0]
    shares = np.maximum(total / at.shape[1] + slopes @ away, 0.0)
    return shares * (total / shares.sum())

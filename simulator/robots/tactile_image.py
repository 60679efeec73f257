"""Tactile image of rigid geoms that press a skin: depth by the geoms' shape and the foam's law."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays import Mask, Real
from ..scene.foam_mechanics import Elastic
from ..scene.parts import Skin
from .engine import Geom, MjData, MjModel, engine
from .skin_contacts import SkinContacts
from .skin_mount import SkinMount


def entry(kind: str, size: Real, origins: Real, directions: Real) -> Real:
    """Distance along each ray at which it enters a convex geom, inf if it misses; shape (n,).

    It is negative if the ray begins inside. kind: "sphere", "ellipsoid", "capsule", "cylinder" or
    "box", of a size as MuJoCo has it. origins, directions: in the geom's frame, (3, n); directions
    have length 1.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        if kind == "plane":
            return np.where(directions[2] < 0, -origins[2] / directions[2], np.inf)
        if kind in ("sphere", "ellipsoid"):
            axes = np.full(3, size[0]) if kind == "sphere" else size
            return _sphere(origins / axes[:, None], directions / axes[:, None])
        if kind == "box":
            return _entered(*(_slab(origins[k], directions[k], size[k]) for k in range(3)))
        along = _slab(origins[2], directions[2], size[1])
        wall = _entered(_wall(size[0], origins, directions), along)
        if kind == "cylinder":
            return wall
        ends = [np.array([[0.0], [0.0], [side * size[1]]]) for side in (-1, 1)]
        balls = [_sphere((origins - end) / size[0], directions / size[0]) for end in ends]
        return np.minimum(wall, np.minimum(*balls))


def _sphere(origins: Real, directions: Real) -> Real:
    """Entry into the unit sphere around 0."""
    a, b, c = _products(origins, directions)
    return _entered(_roots(a, b, c - 1))


def _wall(radius: float, origins: Real, directions: Real) -> tuple[Real, Real]:
    """Entry to and exit from an infinite cylinder around z."""
    a, b, c = _products(origins[:2], directions[:2])
    start, stop = _roots(a, b, c - radius**2)
    parallel = a < 1e-24
    inside = np.where(c <= radius**2, np.inf, np.nan)
    return np.where(parallel, -inside, start), np.where(parallel, inside, stop)


def _products(origins: Real, directions: Real) -> tuple[Real, Real, Real]:
    pairs = ((directions, directions), (origins, directions), (origins, origins))
    a, b, c = (np.einsum("kn,kn->n", p, q) for p, q in pairs)
    return a, b, c


def _roots(a: Real, b: Real, c: Real) -> tuple[Real, Real]:
    """Roots of a t² + 2 b t + c, NaN if there are none."""
    root = np.sqrt(b * b - a * c)
    return (-b - root) / a, (-b + root) / a


def _slab(origins: Real, directions: Real, half: float) -> tuple[Real, Real]:
    """Entry to and exit from the space between two planes at ± half; NaN for a ray outside it."""
    ends = (-half - origins) / directions, (half - origins) / directions
    return np.minimum(*ends), np.maximum(*ends)


def _entered(*spans: tuple[Real, Real]) -> Real:
    """Entry into the intersection of convex bodies from entries and exits of each."""
    start = np.max([first for first, _ in spans], axis=0)
    stop = np.min([last for _, last in spans], axis=0)
    return np.where(start <= stop, start, np.inf)


MAX_SIDE = 96
"""Largest number of image cells along a side of the skin."""
PER_THICKNESS = 3
"""Image cells over the thickness of the foam."""
HALVINGS = 40
ANALYTIC = ("sphere", "ellipsoid", "capsule", "cylinder", "box", "plane")
TAKEN = (*ANALYTIC, "mesh", "hfield")
"""Kinds of geoms whose shape is known."""


@dataclass(frozen=True)
class TactileImager:
    """Depth image of a skin under the geoms that touch it.

    Each geom sinks in along the skin's normal until the foam under it, as columns that do not hold
    each other, bears the force of its contacts. points, normals: of the image cells in the frame
    of the mount, (3, cell). on: True for those on the skin. shape: rows and columns. cell: area,
    m².
    """

    mount: SkinMount
    law: Elastic
    thickness: float
    points: Real
    normals: Real
    on: Mask
    shape: tuple[int, int]
    cell: float

    @classmethod
    def of(cls, skin: Skin, mount: SkinMount) -> TactileImager:
        """Imager of a scene whose foam has a thickness and mechanics."""
        foam, sides = skin.foam, np.array(skin.sides)
        assert foam.mechanics is not None and foam.thickness is not None
        counts = np.clip(np.ceil(PER_THICKNESS * sides / foam.thickness), 1, MAX_SIDE).astype(int)
        along, across = (
            (np.arange(n) + 0.5) / n * side for n, side in zip(counts, sides, strict=True)
        )
        x = np.stack(np.meshgrid(along, across)).reshape(2, -1)
        points, normals, on = mount.surface.points(x)
        area = float(np.prod(skin.stretched_sides)) / x.shape[1]
        shape = (int(counts[1]), int(counts[0]))
        return cls(mount, foam.mechanics.elastic, foam.thickness, points, normals, on, shape, area)

    def depth(self, model: MjModel, data: MjData, contacts: SkinContacts) -> Real:
        """Depth of each image cell, m, shape (row, column)."""
        found = np.zeros(self.points.shape[1])
        for number in np.unique(contacts.geom):
            own = contacts.geom == number
            force, deep = float(contacts.force[own].sum()), float(contacts.depth[own].max())
            if deep >= self.thickness:
                force = np.inf
            near, gap = self._gaps(Geom(model, data, int(number)), self.thickness + deep)
            if not near.size:
                continue
            found[near] = np.maximum(found[near], self._sunk(gap, force))
        return found.reshape(self.shape)

    def _gaps(self, geom: Geom, deepest: float) -> tuple[NDArray[np.intp], Real]:
        """Image cells under a geom, and its height above each, m; at most `deepest` below it."""
        origin, axes = self.mount.pose(geom.data)
        turned = geom.axes.T
        points = (turned @ (origin - geom.place))[:, None] + turned @ axes @ self.points
        reach = float(geom.model.geom_rbound[geom.number]) or np.inf  # a plane has none
        near = np.flatnonzero(self.on & (np.linalg.norm(points, axis=0) <= reach + self.thickness))
        gap = self._entries(geom, points[:, near], turned @ axes @ self.normals[:, near])
        under = np.isfinite(gap) & (gap > -deepest)
        return near[under], gap[under]

    def _entries(self, geom: Geom, points: Real, normals: Real) -> Real:
        """Height of a geom over points in its frame, m, inf where it is not above them."""
        kind = geom.kind
        if kind in ANALYTIC:
            return entry(kind, geom.size, points, normals)
        back = float(geom.model.geom_rbound[geom.number]) + self.thickness
        start = (geom.place[:, None] + geom.axes @ (points - back * normals)).T
        each = zip(*map(np.ascontiguousarray, (start, (geom.axes @ normals).T)), strict=True)
        ray = engine().mj_rayMesh if kind == "mesh" else engine().mj_rayHfield
        distance = np.array([ray(*geom, *pair) for pair in each])
        return np.where(distance < 0, np.inf, distance - back)

    def _sunk(self, gap: Real, force: float) -> Real:
        """Depth under a geom that is `gap` above the skin, m, by a force, N.

        It is all of the foam's thickness if the foam cannot bear the force.
        """
        low, high = 0.0, self.law.greatest_strain * self.thickness
        if self.cell * self.law.stress(self._strain(gap, high)).sum() < force:
            return self.thickness * self._strain(gap, self.thickness)
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            if self.cell * self.law.stress(self._strain(gap, middle)).sum() > force:
                high = middle
            else:
                low = middle
        return self.thickness * self._strain(gap, high)

    def _strain(self, gap: Real, sunk: float) -> Real:
        """Strain under a geom whose lowest point is `sunk` below the skin."""
        return np.maximum(sunk - (gap - gap.min()), 0.0) / self.thickness

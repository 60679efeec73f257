"""Mounting of a skin on a MuJoCo model: by a site, or by the texture coordinates of a mesh."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..arrays import Real
from ..scene.parts import Skin
from ..scene.skin import SheetsAndFoam
from ..sweeps import InputError
from .contact_curvature import GeomNumbers
from .engine import MjData, MjModel, engine
from .skin_polygons import SkinArea
from .skin_surface_in_space import (
    MountedSurface,
    ShapedSurface,
    SurfaceNumbers,
    TriangleSurface,
)

MAX_AREA_DEVIATION = 0.1
"""Largest relative deviation of the area of a mesh under texture coordinates from the skin's."""


MASK_CELLS = 192
"""Cells along each side of a skin that is no rectangle, for what there is of it."""


@dataclass(frozen=True, eq=False)
class SkinMount:
    """A skin's surface in the frame of a site or of a geom of a model.

    frame: number of the site, or of the geom if by_geom. geoms: numbers of the geoms that carry the
    skin; contacts with others do not reach it. curvature: radii of geoms by number, m.
    """

    model: MjModel
    skin: SheetsAndFoam
    surface: MountedSurface
    frame: int
    by_geom: bool
    geoms: tuple[int, ...]
    curvature: Mapping[int, float]

    def pose(self, data: MjData) -> tuple[Real, Real]:
        """Origin (3,) and axes (3, 3), as columns, of the frame in the world."""
        if self.by_geom:
            return data.geom_xpos[self.frame], data.geom_xmat[self.frame].reshape(3, 3)
        return data.site_xpos[self.frame], data.site_xmat[self.frame].reshape(3, 3)

    def geom_numbers(self, data: MjData) -> GeomNumbers:
        """The geoms at the moment of some data, as kernels take them."""
        kind, size, own, curvature = self._fixed
        return GeomNumbers(kind, size, data.geom_xpos, data.geom_xmat, curvature, own)

    @cached_property
    def _fixed(self) -> tuple[Any, ...]:
        own, curvature = np.zeros(self.model.ngeom, dtype=bool), np.full(self.model.ngeom, np.nan)
        own[list(self.geoms)] = True
        curvature[list(self.curvature)] = list(self.curvature.values())
        return self.model.geom_type, self.model.geom_size, own, curvature

    @cached_property
    def numbers(self) -> SurfaceNumbers:
        """The surface as kernels take it."""
        return self.surface.numbers

    @cached_property
    def area(self) -> SkinArea:
        """What there is of the unrolled skin."""
        sides, by_shape = self.skin.sides, isinstance(self.surface, ShapedSurface)
        if by_shape and self.skin.rectangular:
            return SkinArea(*sides, np.zeros((0, 0), dtype=bool))
        at = [(np.arange(MASK_CELLS) + 0.5) / MASK_CELLS * side for side in sides]
        on = self.surface.holds(np.stack(np.meshgrid(*at)).reshape(2, -1))
        mask = on.reshape(MASK_CELLS, MASK_CELLS)
        return SkinArea(*sides, np.zeros((0, 0), dtype=bool) if mask.all() else mask)


def mounted(
    model: MjModel,
    skin: Skin,
    site: str | None,
    uv: str | None,
    geoms: Sequence[str] | None,
    curvature: Mapping[int, float] | None = None,
) -> SkinMount:
    """Mount of a scene's skin by a site, or by the texture coordinates of a mesh geom `uv`.

    geoms: names of the geoms that carry the skin; by default all of the site's body, or the mesh.
    curvature: radii of curvature of geoms by number, m.
    Raises InputError for a name that the model lacks, and for a mesh that the skin does not fit.
    """
    mujoco = engine()

    if (site is None) == (uv is None):
        raise InputError("MujocoSkin: takes `site` or `uv`, the name of a site or of a mesh geom")
    if site is not None:
        frame = numbered(model, mujoco.mjtObj.mjOBJ_SITE, site)
        body = model.site_bodyid[frame]
        own = np.flatnonzero(model.geom_bodyid == body)
        surface = _surface_at_site(skin)
    else:
        assert uv is not None
        frame = numbered(model, mujoco.mjtObj.mjOBJ_GEOM, uv)
        own, surface = np.array([frame]), _surface_by_uv(model, skin, frame, uv)
    if geoms is not None:
        own = np.array([numbered(model, mujoco.mjtObj.mjOBJ_GEOM, name) for name in geoms])
    if not own.size:
        raise InputError(f"MujocoSkin: the body of site {site!r} has no geom that could be touched")
    which = tuple(own.tolist())
    return SkinMount(model, skin, surface, frame, site is None, which, curvature or {})


def numbered(model: MjModel, kind: Any, name: str) -> int:
    """Number of a named object of a model. Raises InputError with the names that there are."""
    mujoco = engine()

    number = mujoco.mj_name2id(model, kind, name)
    if number < 0:
        label = kind.name.removeprefix("mjOBJ_").lower()
        counts = {"site": model.nsite, "geom": model.ngeom, "sensor": model.nsensor}
        names = [mujoco.mj_id2name(model, kind, k) for k in range(counts[label])]
        known = ", ".join(each for each in names if each) or "none with a name"
        raise InputError(f"MujocoSkin: the model has no {label} {name!r}; there are: {known}")
    return number


def _surface_at_site(skin: Skin) -> MountedSurface:
    mesh = skin.mesh
    if mesh is None or len(mesh.surface.p) == 2:
        return ShapedSurface(skin)
    p, t = mesh.surface.p, mesh.surface.t
    (ax, ay), (bx, by), (cx, cy) = p[:2, t].transpose(1, 0, 2)
    clockwise = (bx - ax) * (cy - ay) < (cx - ax) * (by - ay)
    corners = p[:, np.where(clockwise, t[[0, 2, 1]], t)].transpose(1, 0, 2)
    return TriangleSurface(corners, corners[:, :2])


def _surface_by_uv(model: MjModel, skin: Skin, geom: int, name: str) -> MountedSurface:
    """Triangles of a mesh geom whose texture coordinates lie within 0..1.

    u runs along the skin's length, v along its width. Raises InputError if there are none, or if
    their area is not that of the skin.
    """
    mesh = int(model.geom_dataid[geom])
    if mesh < 0 or model.mesh_texcoordadr[mesh] < 0:
        raise InputError(f"MujocoSkin: geom {name!r} must be a mesh with texture coordinates")
    first, count = model.mesh_faceadr[mesh], model.mesh_facenum[mesh]
    faces = slice(first, first + count)
    vertices = model.mesh_vert[model.mesh_vertadr[mesh] :][model.mesh_face[faces]]
    uv = model.mesh_texcoord[model.mesh_texcoordadr[mesh] :][model.mesh_facetexcoord[faces]]
    within = ((uv >= 0) & (uv <= 1)).all(axis=(1, 2))
    spread = np.ptp(uv, axis=1).min(axis=1) > 0
    within &= spread
    if not within.any():
        raise InputError(
            f"MujocoSkin: no triangle of geom {name!r} has texture coordinates within 0..1"
        )
    sides = np.array(skin.sides)
    corners, flat = vertices[within].astype(float), uv[within].astype(float) * sides
    surface = TriangleSurface(corners.transpose(1, 2, 0), flat.transpose(1, 2, 0))
    expected = float(np.prod(skin.stretched_sides))
    if abs(surface.area / expected - 1) > MAX_AREA_DEVIATION:
        raise InputError(
            f"MujocoSkin: the part of geom {name!r} with texture coordinates within 0..1 has "
            f"{surface.area:.4g} m², the skin {skin.name} {expected:.4g} m²; they must agree to "
            f"{100 * MAX_AREA_DEVIATION:g} %"
        )
    return surface

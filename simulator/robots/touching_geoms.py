"""Geoms that may touch a mounted skin, and what a rule for patches does not take of them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..sweeps import InputError
from .contact_curvature import PatchName
from .engine import Geom, MjModel, engine, named_geom
from .skin_mount import SkinMount
from .tactile_image import TAKEN

NEED_CURVATURE = ("mesh", "sdf")
LEAST_CORNERS, OUT_OF_ROUND = 30, 0.02
"""A mesh is a sphere if it has at least this number of vertices, and if their distances from its
middle differ by at most this part."""


def check_geoms(mount: SkinMount, patch: PatchName | float) -> None:
    """Raise InputError for the first geom that may touch the skin and that `patch` does not take.

    "hertz" and "applicator" need the curvature of meshes; "image" takes no soft body.
    """
    model = mount.model
    for number in _touching(mount):
        if patch == "image":
            kind = "flex" if number >= model.ngeom else Geom(model, None, number).kind
            if kind not in TAKEN:
                raise InputError(
                    f'MujocoSkin: patch="image" does not take geom {named_geom(model, number)} '
                    f"({kind}), which may touch the skin; give another `patch`"
                )
        elif isinstance(patch, str) and number < model.ngeom and number not in mount.curvature:
            geom = Geom(model, None, number)
            if geom.kind in NEED_CURVATURE:
                raise InputError(
                    f"MujocoSkin: the radius of curvature of geom {geom.name} ({geom.kind}) is not "
                    'known; give it in `curvature`, or patch="image", or the radius of the patch'
                )


def round_meshes(model: MjModel) -> dict[int, float]:
    """Radius of each mesh geom whose vertices lie on a sphere, m, by number."""
    found, mesh = {}, int(engine().mjtGeom.mjGEOM_MESH)
    for number in np.flatnonzero(model.geom_type == mesh).tolist():
        which = int(model.geom_dataid[number])
        first = int(model.mesh_vertadr[which])
        corners = model.mesh_vert[first : first + model.mesh_vertnum[which]].astype(float)
        if len(corners) < LEAST_CORNERS:
            continue
        rows = np.column_stack([2 * corners, np.ones(len(corners))])
        *middle, rest = np.linalg.lstsq(rows, (corners**2).sum(axis=1), rcond=None)[0]
        radius = np.linalg.norm(corners - middle, axis=1)
        if np.ptp(radius) < OUT_OF_ROUND * radius.mean() and rest > 0:
            found[number] = float(radius.mean())
    return found


def _touching(mount: SkinMount) -> Iterator[int]:
    """Numbers of the geoms, and of soft bodies behind them, that may touch a skin's geoms.

    As MuJoCo has it: masks that match, bodies that are neither one, nor parent and child, nor
    excluded; or a pair that the model names.
    """
    model = mount.model
    own = np.array(mount.geoms)
    pairs = {*zip(model.pair_geom1.tolist(), model.pair_geom2.tolist(), strict=True)}
    excluded = {*model.exclude_signature.tolist()}
    no_parents = not model.opt.disableflags & engine().mjtDisableBit.mjDSBL_FILTERPARENT
    for number in range(model.ngeom):
        if number in mount.geoms:
            continue
        named = any((k, number) in pairs or (number, k) in pairs for k in mount.geoms)
        if named or any(_meet(mount, k, number, excluded, no_parents) for k in mount.geoms):
            yield number
    for flex in range(model.nflex):
        types, affinities = model.flex_contype[flex], model.flex_conaffinity[flex]
        if ((model.geom_contype[own] & affinities) | (types & model.geom_conaffinity[own])).any():
            yield model.ngeom + flex


def _meet(mount: SkinMount, own: int, other: int, excluded: set[int], no_parents: bool) -> bool:
    """True if two geoms collide by their masks and bodies."""
    model = mount.model
    types, affinities = model.geom_contype, model.geom_conaffinity
    if not (types[own] & affinities[other]) | (types[other] & affinities[own]):
        return False
    bodies = [int(model.geom_bodyid[each]) for each in (own, other)]
    if {(bodies[0] << 16) + bodies[1], (bodies[1] << 16) + bodies[0]} & excluded:
        return False
    welded = [int(model.body_weldid[body]) for body in bodies]
    parents = [int(model.body_weldid[model.body_parentid[body]]) for body in welded]
    related = welded[0] == parents[1] or welded[1] == parents[0]
    return welded[0] != welded[1] and not (no_parents and related and 0 not in welded)

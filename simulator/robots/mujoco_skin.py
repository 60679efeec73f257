"""A skin on a MuJoCo model: contacts of the engine in, readings of the skin's meter out."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Real
from ..models.mechanics.foam_law import foam_tables
from ..requests.argument_types import scene_of, typed
from ..scene.scene import Scene
from ..sensor.contacts.contact_types import DepthImage, KnownContacts, PointContacts, PressureImage
from ..sensor.sensor import Sensor
from ..sweeps import InputError
from ..sweeps.optional_packages import require_packages
from .contact_curvature import FIXED, PATCHES, PatchName, PatchRule
from .engine import Geom, MjData, MjModel, engine, named_geom
from .skin_contacts import SkinContacts, skin_contacts
from .skin_mount import SkinMount, mounted, numbered
from .tactile_image import TAKEN, TactileImager

if TYPE_CHECKING:
    import gymnasium

    from ..sensor.sensor_reading import SensorReading

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


EXTRA = "mujoco"
SAME_TIME = 1e-9
"""Largest difference of the times that environments advance, s."""


class MujocoSkin:
    """A skin on a MuJoCo model, or on one model in several environments.

    Call `step` after each `mujoco.mj_step`: it takes the contacts from the engine's data, and the
    time since the last call. Or call `install`: MuJoCo then fills a user sensor by itself. The
    contacts of each geom press an area; what of it lies beside the skin is not felt, with its share
    of the force. That force is `reading.beside`, and a warning says so once.

    model: a mujoco.MjModel. scene: the scene, its name or the path of its file. site: name of a
    site at the middle of the skin, with x along its length, y along its width and z outward; the
    skin is flat, or bent as `skin.shape` says; the origin of a mesh in space is at the site. uv:
    name of a mesh geom in place of a site, whose texture coordinates 0..1 are the length and the
    width of the skin. geoms: names of the geoms that carry the skin; default all of the site's
    body. patch: the area that a contact point presses. "hertz": by the foam's law and the
    curvatures of geom and skin. "applicator": a flat end as wide as the geom. "image": all of the
    geom's shape, sunk in until the foam bears the force. A number: the radius in m. curvature:
    radius of curvature of geoms by name, m; meshes that are no spheres need it for "hertz" and
    "applicator". sensor: name of a user sensor of the model that `install` fills. envs: number of
    environments. options: of `Sensor`. Raises InputError for a name that the model lacks, for a
    geom that may touch the skin and that `patch` does not take, and for what `Sensor` refuses.
    """

    @typed
    def __init__(
        self,
        model: MjModel,
        scene: Scene | str | Path,
        site: str | None = None,
        *,
        uv: str | None = None,
        geoms: Sequence[str] | None = None,
        patch: PatchName | float = "hertz",
        curvature: Mapping[str, float] | None = None,
        sensor: str | None = None,
        envs: int = 1,
        **options: Any,
    ) -> None:
        require_packages("MujocoSkin", EXTRA, "mujoco")
        mujoco = engine()

        self.model = model
        self.scene = scene_of(scene)
        foam = self.scene.skin.foam
        if foam.mechanics is None or foam.thickness is None:
            raise InputError(
                f"MujocoSkin: forces on {self.scene.name} need `skin.foam.thickness` and the table "
                "[skin.foam.mechanics]"
            )
        known = round_meshes(model) | {
            numbered(model, mujoco.mjtObj.mjOBJ_GEOM, name): _positive(f"curvature of {name!r}", r)
            for name, r in (curvature or {}).items()
        }
        self.mount = mounted(model, self.scene.parts.skin, site, uv, geoms, known)
        self._rule, self._foam = _rule_of(patch), foam_tables(foam)
        check_geoms(self.mount, patch)
        self.sensor = Sensor(self.scene, skins=envs, **options)
        self._imager = (
            TactileImager.of(self.scene.parts.skin, self.mount) if patch == "image" else None
        )
        self._slice = None if sensor is None else self._place_of(sensor)
        self._at = [0.0] * envs
        self._reading: SensorReading | None = None
        self._warned = False

    @property
    def envs(self) -> int:
        """Number of environments."""
        return self.sensor.skins

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the numbers in `reading.vector`."""
        return self.sensor.names

    @property
    def units(self) -> tuple[str, ...]:
        """Units of the numbers in `reading.vector`."""
        return self.sensor.units

    @property
    def reading(self) -> SensorReading | None:
        """Latest reading; None before the first step."""
        return self._reading

    def contacts(self, data: MjData) -> SkinContacts:
        """Geoms that touch the skin: places, forces and areas, and the force beside it."""
        return self._touching(data)[0]

    def patches(self, data: MjData | Sequence[MjData]) -> PointContacts | DepthImage | None:
        """Contacts for `Sensor.step`: patches or depth images of all environments."""
        found = self._known(self._environments(data)).contacts
        assert not isinstance(found, PressureImage)
        return found

    def known_contacts(self, each: Sequence[MjData]) -> KnownContacts | None:
        """Contacts of all environments, with their places; None if nothing touches any.

        It warns once of what lies beside the skin.
        """
        if not any(one.ncon for one in each):
            return None
        known = self._known(each, warn=True)
        return known if known.contacts is not None or any(known.beside) else None

    def _touching(self, data: MjData) -> tuple[SkinContacts, Real]:
        return skin_contacts(self.model, data, self.mount, self._rule, self._foam)

    def _known(self, each: Sequence[MjData], warn: bool = False) -> KnownContacts:
        """Contacts of all environments, and what the engine knows of them."""
        found, patches = zip(*map(self._touching, each), strict=True)
        touches = [np.stack([*one.x, one.force, one.area], axis=-1) for one in found]
        if warn and not self._warned and any(one.overhangs for one in found):
            self._warn(max(found, key=lambda one: one.overhang))
        contacts = None
        if any(one.count for one in found):
            contacts = _padded(patches) if self._imager is None else self._imaged(each, found)
        return KnownContacts(contacts, touches, [one.beside for one in found])

    def _imaged(self, each: Sequence[MjData], found: Sequence[SkinContacts]) -> DepthImage:
        assert self._imager is not None
        pairs = zip(each, found, strict=True)
        return DepthImage(np.stack([self._imager.depth(self.model, *one) for one in pairs]))

    def _warn(self, contacts: SkinContacts) -> None:
        """Warn once that a geom presses beside the skin."""
        self._warned = True
        whole = contacts.overhang + contacts.force.sum()
        warnings.warn(
            f"MujocoSkin: {contacts.overhang:.3g} of {whole:.3g} N lie beside the skin "
            f"{self.scene.name}, under geom {named_geom(self.model, contacts.overhanging)}, and "
            "are not felt; `reading.beside` has the force of each step (this is said once)",
            stacklevel=3,
        )

    def step(self, data: MjData | Sequence[MjData]) -> SensorReading:
        """Latest readings at the time of the engine, with its contacts since the last call.

        data: a mujoco.MjData, or a list of one for each environment. An environment whose time went
        back begins again with an unpressed skin; the others go on. Contacts are worked out only if
        a reading has its middle since the last call. Raises InputError if no time passed at the
        first call, or not the same time in all environments.
        """
        each = self._environments(data)
        now = [one.time for one in each]
        back = [k for k in range(len(now)) if now[k] < self._at[k]]
        if back:
            self._begin_again(back)
        passed = [
            time - before
            for k, (time, before) in enumerate(zip(now, self._at, strict=True))
            if k not in back or len(back) == len(now)
        ]
        if max(passed) - min(passed) > SAME_TIME:
            raise InputError(
                "MujocoSkin: all environments must advance by the same time, got "
                f"{min(passed):g} to {max(passed):g} s"
            )
        self._at = now
        if passed[0] > 0:
            self._reading = self.sensor.step(partial(self.known_contacts, each), passed[0])
        elif self._reading is None:
            raise InputError("MujocoSkin: no time has passed; call `step` after mujoco.mj_step")
        return self._reading

    def _begin_again(self, back: Sequence[int]) -> None:
        """Reset the skins of environments, at their time 0."""
        if len(back) == self.envs:
            self.sensor.reset()
            self._reading = None
        else:
            self.sensor.unpress(back)
        self._at = [0.0 if k in back else at for k, at in enumerate(self._at)]

    def reset(
        self,
        data: MjData | Sequence[MjData] | None = None,
        seed: int | None = None,
        env: int | None = None,
    ) -> None:
        """Start again with unpressed skins, at the time of `data`, by default 0 s.

        seed: a new one for the sensor, which draws other skins and errors of the meter. env: number
        of the only environment that starts again, from 0; `data` is then its own. Raises InputError
        for another number, or for a seed of one environment.
        """
        if env is not None:
            if not 0 <= env < self.envs or seed is not None:
                raise InputError(
                    f"MujocoSkin: `env` must be in 0..{self.envs - 1}, without `seed`, got {env} "
                    f"and {seed}"
                )
            self._begin_again([env])
            if data is not None:
                (self._at[env],) = [one.time for one in _listed(data)]
            return
        self.sensor.reset(seed)
        self._reading = None
        self._at = [0.0] * self.envs
        if data is not None:
            self._at = [one.time for one in self._environments(data)]

    def fill(self, data: MjData) -> None:
        """Write the readings at the time of `data` into its user sensor; NaN before the first."""
        assert self._slice is not None
        if data.time < self._at[0]:
            self._begin_again([0])
        started = self._reading is not None or data.time > 0
        data.sensordata[self._slice] = self.step(data).vector[0] if started else np.nan

    def install(self) -> None:
        """Let MuJoCo fill the user sensor in each step; see `user_sensor.install`."""
        from .user_sensor import install

        install(self)

    def uninstall(self) -> None:
        """End what `install` began."""
        from .user_sensor import uninstall

        uninstall(self)

    def observed(
        self, env: gymnasium.Env, key: str = "skin", changes: bool = False
    ) -> gymnasium.Env:
        """Environment whose observations contain the readings; see `SkinObservation`."""
        require_packages("MujocoSkin.observed", EXTRA, "gymnasium")
        from .skin_observation import SkinObservation

        return SkinObservation(env, self, key, changes)

    def _environments(self, data: MjData | Sequence[MjData]) -> Sequence[MjData]:
        each = _listed(data)
        if len(each) != self.envs:
            raise InputError(f"MujocoSkin: needs data of {self.envs} environments, got {len(each)}")
        return each

    def _place_of(self, name: str) -> slice:
        """Place of a user sensor in the engine's data. Raises InputError for another sensor."""
        mujoco = engine()

        number = numbered(self.model, mujoco.mjtObj.mjOBJ_SENSOR, name)
        first, size = int(self.model.sensor_adr[number]), int(self.model.sensor_dim[number])
        user = self.model.sensor_type[number] == mujoco.mjtSensor.mjSENS_USER
        last_stage = self.model.sensor_needstage[number] == mujoco.mjtStage.mjSTAGE_ACC
        if not (user and last_stage and size == len(self.names)) or self.envs > 1:
            raise InputError(
                f"MujocoSkin: sensor {name!r} must be "
                f'<user name="{name}" dim="{len(self.names)}" needstage="acc"/> of a skin in one '
                "environment"
            )
        return slice(first, first + size)


def _listed(data: MjData | Sequence[MjData]) -> Sequence[MjData]:
    return data if isinstance(data, list | tuple) else [data]


def _rule_of(patch: PatchName | float) -> PatchRule:
    if not isinstance(patch, str):
        return PatchRule(FIXED, _positive("patch", patch))
    if patch not in PATCHES:
        raise InputError(
            f"MujocoSkin: patch must be one of {', '.join(PATCHES)} or a radius in m, got {patch!r}"
        )
    return PatchRule(PATCHES.index(patch), 0.0)


def _positive(name: str, value: float) -> float:
    if not 0 < value < np.inf:
        raise InputError(f"MujocoSkin: {name} must be > 0 m and finite, got {value!r}")
    return float(value)


def _padded(each: Sequence[Real]) -> PointContacts:
    """Patches of environments, (patch, 5) each, as arrays of equal length."""
    count = np.array([len(one) for one in each])
    table = np.ones((len(each), int(count.max()), 5))
    for k, one in enumerate(each):
        table[k, : count[k]] = one
    x, y, force, radius, curvature = np.moveaxis(table, -1, 0)
    return PointContacts(x, y, force=force, radius=radius, curvature_radius=curvature, count=count)

"""A skin on a MuJoCo model: contacts of the engine in, readings of the skin's meter out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Real
from ..requests.argument_types import scene_of, typed
from ..scene.scene import Scene
from ..sensor.contacts.contact_types import DepthImage, PointContacts
from ..sensor.sensor import Sensor
from ..sweeps import InputError
from ..sweeps.optional_packages import require_packages
from .contact_patches import PATCHES, Patches, PatchName, PatchRule
from .engine import MjData, MjModel, engine
from .skin_contacts import SkinContacts, skin_contacts
from .skin_mount import mounted, numbered
from .tactile_image import TactileImager

if TYPE_CHECKING:
    import gymnasium

    from ..sensor.sensor_reading import SensorReading

EXTRA = "mujoco"
SAME_TIME = 1e-9
"""Largest difference of the times that environments advance, s."""


class MujocoSkin:
    """A skin on a MuJoCo model, or on one model in several environments.

    Call `step` after each `mujoco.mj_step`: it takes the contacts from the engine's data, and the
    time since the last call. Or call `install`: MuJoCo then fills a user sensor by itself.

    model: a mujoco.MjModel. scene: the scene, its name or the path of its file. site: name of a
    site at the middle of the skin, with x along its length, y along its width and z outward; the
    skin is flat, or bent as `skin.shape` says; the origin of a mesh in space is at the site. uv:
    name of a mesh geom in place of a site, whose texture coordinates 0..1 are the length and the
    width of the skin. geoms: names of the geoms that carry the skin; default all of the site's
    body. patch: the area that a contact point presses. "hertz": that of a sphere of the geom's
    radius of curvature, by the foam's law. "applicator": a flat end as wide as the geom. "image":
    all of the geom's shape, sunk in until the foam bears the force. A number: the radius in m.
    curvature: radius of curvature of geoms by name, m; meshes need it for "hertz". sensor: name of
    a user sensor of the model that `install` fills. envs: number of environments. options: of
    `Sensor`. Raises InputError for a name that the model lacks, and for what `Sensor` refuses.
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
        self.mount = mounted(model, self.scene, site, uv, geoms)
        foam = self.scene.skin.foam
        if foam.mechanics is None or foam.thickness is None:
            raise InputError(
                f"MujocoSkin: forces on {self.scene.name} need `skin.foam.thickness` and the table "
                "[skin.foam.mechanics]"
            )
        self._reach = foam.thickness
        known = {
            numbered(model, mujoco.mjtObj.mjOBJ_GEOM, name): _positive(f"curvature of {name!r}", r)
            for name, r in (curvature or {}).items()
        }
        self.sensor = Sensor(self.scene, skins=envs, **options)
        self._imager, self._rule = None, None
        if patch == "image":
            self._imager = TactileImager.of(self.scene, self.mount)
        else:
            law = foam.mechanics.elastic
            self._rule = PatchRule(_checked(patch), law, foam.thickness, known)
        self._slice = None if sensor is None else self._place_of(sensor)
        self._at = np.zeros(envs)
        self._reading: SensorReading | None = None

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
        """Contact points of the engine on the skin: places, forces and touching geoms."""
        return skin_contacts(self.model, data, self.mount, self._reach)

    def patches(self, data: MjData | Sequence[MjData]) -> PointContacts | DepthImage | None:
        """Contacts for `Sensor.step`: patches or depth images of all environments."""
        each = self._environments(data)
        found = [self.contacts(one) for one in each]
        if not any(one.count for one in found):
            return None
        if self._imager is not None:
            pairs = zip(each, found, strict=True)
            return DepthImage(np.stack([self._imager.depth(self.model, *one) for one in pairs]))
        assert self._rule is not None
        pairs = zip(each, found, strict=True)
        return _padded([self._rule.patches(self.model, *one) for one in pairs])

    def step(self, data: MjData | Sequence[MjData]) -> SensorReading:
        """Latest readings at the time of the engine, with its contacts since the last call.

        data: a mujoco.MjData, or a list of one for each environment. Where the time went back, it
        begins again at 0; a single environment also resets the sensor. Raises InputError if no time
        passed at the first call, or not the same time in all environments.
        """
        each = self._environments(data)
        now = np.array([one.time for one in each])
        back = now < self._at
        if back.any() and self.envs == 1:
            self.sensor.reset()
            self._reading = None
        passed = now - np.where(back, 0.0, self._at)
        if np.ptp(passed) > SAME_TIME:
            raise InputError(
                "MujocoSkin: all environments must advance by the same time, got "
                f"{passed.min():g} to {passed.max():g} s"
            )
        self._at = now
        if passed[0] > 0:
            self._reading = self.sensor.step(self.patches(each), float(passed[0]))
        elif self._reading is None:
            raise InputError("MujocoSkin: no time has passed; call `step` after mujoco.mj_step")
        return self._reading

    def reset(self, data: MjData | Sequence[MjData] | None = None, seed: int | None = None) -> None:
        """Start again with unpressed skins, at the time of `data`, by default 0 s.

        seed: a new one for the sensor, which draws other skins and errors of the meter.
        """
        self.sensor.reset(seed)
        self._reading = None
        self._at = np.zeros(self.envs)
        if data is not None:
            self._at = np.array([one.time for one in self._environments(data)])

    def fill(self, data: MjData) -> None:
        """Write the readings at the time of `data` into its user sensor; NaN before the first."""
        assert self._slice is not None
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
        each = data if isinstance(data, list | tuple) else [data]
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


def _checked(patch: PatchName | float) -> PatchName | float:
    if isinstance(patch, str):
        if patch not in PATCHES:
            raise InputError(
                f"MujocoSkin: patch must be one of {', '.join(PATCHES)} or a radius in m, "
                f"got {patch!r}"
            )
        return patch
    return _positive("patch", patch)


def _positive(name: str, value: float) -> float:
    if not 0 < value < np.inf:
        raise InputError(f"MujocoSkin: {name} must be > 0 m and finite, got {value!r}")
    return float(value)


def _padded(each: Sequence[Patches]) -> PointContacts:
    """Patches of environments as arrays of equal length."""
    count = np.array([one.x.size for one in each])
    columns: Real = np.ones((5, len(each), max(int(count.max()), 1)))
    for k, one in enumerate(each):
        columns[:, k, : count[k]] = one
    x, y, force, radius, curvature = columns
    return PointContacts(x, y, force=force, radius=radius, curvature_radius=curvature, count=count)

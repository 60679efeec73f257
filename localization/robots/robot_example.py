"""A robot with skins: a localizer trained on simulation reads where it is touched."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...simulator.arrays import Real
from ..api.localizer import localize, train
from ..api.simulation import dataset, load

if TYPE_CHECKING:
    from ...simulator.robots.mujoco_skin import MujocoSkin
    from ...simulator.scene.scene import Scene
    from ..model.localizer_model import Model
    from .touch_film import FilmCamera

RTOL = 1e-2
SWEEPS = 1500
BASELINE = 0.2
"""Time for which the unpressed skins are read before the robot moves, s."""
TOUCHED = "1"
"""Answer of a localizer of positions to a sweep with one touch."""
MIN_FORCE = 0.2
"""Force from which a touch is compared, N."""


@dataclass(frozen=True)
class RobotExample:
    """A robot and its motion.

    xml: model of MuJoCo. sites: of the skins. control: sets the controls of the engine's data at a
    time in s. duration: s. changes: of the keys of palm.toml. camera: name in the model.
    """

    name: str
    xml: str
    sites: tuple[str, ...]
    control: Callable[[Any, float], None]
    duration: float = 4.0
    changes: Mapping[str, object] = field(default_factory=dict)
    camera: str = "film"

    def load_scene(self) -> Scene:
        """Scene of the skins."""
        return load(Path(__file__).with_name("palm.toml")).with_(self.changes)


class TouchRecord(NamedTuple):
    """Touches of one skin, one row a sweep of its meter.

    time: middle of the sweep, s. true, read: places on the skin, m, (sweep, 2), NaN where nothing
    presses, or nothing was found. force: N.
    """

    time: Real
    true: Real
    read: Real
    force: Real

    @property
    def error(self) -> Real:
        """Distances of read from true places, m, for the touches that were found."""
        both = np.isfinite(self.true).all(axis=1) & np.isfinite(self.read).all(axis=1)
        return np.linalg.norm(self.true[both] - self.read[both], axis=1)

    @property
    def touched(self) -> int:
        """Number of sweeps under a touch."""
        return int(np.isfinite(self.true).all(axis=1).sum())


def trained(example: RobotExample, sweeps: int = SWEEPS) -> Model:
    """Localizer of positions, trained on simulated sweeps of random skins and touches."""
    return train(dataset(example.load_scene(), sweeps, rtol=RTOL), "position")


def simulate(
    example: RobotExample,
    model: Model,
    duration: float | None = None,
    camera: FilmCamera | None = None,
) -> list[TouchRecord]:
    """Touches of each skin while the robot moves, true and as read by the localizer."""
    import mujoco

    from ...simulator.robots.mujoco_skin import MujocoSkin

    robot: Any = mujoco
    engine = robot.MjModel.from_xml_string(example.xml)
    data = robot.MjData(engine)
    skins = [
        MujocoSkin(engine, example.load_scene(), site, seed=seed, rtol=RTOL, session="drawn")
        for seed, site in enumerate(example.sites, 11)
    ]
    for skin in skins:
        skin.sensor.step(None, BASELINE)
    unpressed = [skin.sensor.sweeps() for skin in skins]
    history: list[list[Real]] = [[] for _ in skins]
    while data.time < (duration or example.duration):
        example.control(data, data.time)
        robot.mj_step(engine, data)
        for skin, known in zip(skins, history, strict=True):
            skin.step(data)
            known.append(_resultant(skin, data))
        if camera is not None:
            camera.take(engine, data, example.camera)
    each = zip(skins, unpressed, history, strict=True)
    return [_record(model, skin, rest, np.array(known)) for skin, rest, known in each]


def _resultant(skin: MujocoSkin, data: Any) -> Real:
    """Time, place and force of all contacts together: s, m, m, N."""
    contacts = skin.contacts(data)
    force = contacts.force.sum()
    place = contacts.x @ contacts.force / force if force > MIN_FORCE else np.full(2, np.nan)
    return np.array([data.time, *place, force])


def _record(model: Model, skin: MujocoSkin, rest: Any, known: Real) -> TouchRecord:
    sweeps = skin.sensor.sweeps()
    sweeps = sweeps.isel(sweep=slice(rest.sizes["sweep"], None))
    answers = localize(model, sweeps, rest)
    time = sweeps["time"].values - BASELINE
    rows = np.abs(known[:, :1] - time).argmin(axis=0)
    places, _ = model.positions(sweeps, rest)
    read = np.where((answers.labels == TOUCHED)[:, None], 1e-3 * places[:, :2], np.nan)
    return TouchRecord(time, known[rows, 1:3], read, known[rows, 3])

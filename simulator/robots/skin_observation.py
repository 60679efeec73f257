"""Gymnasium: readings of a skin as a part of the observations of an environment."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import gymnasium
import numpy as np
from gymnasium import spaces

from ..arrays import Real
from ..sweeps import InputError

if TYPE_CHECKING:
    from .mujoco_skin import MujocoSkin

FIRST_STEP = 0.05
"""Time by which the meter reads on at a reset until all readings are there, s."""
OBSERVATION = "observation"
"""Name of the observations of an environment whose own space has no names."""


class SkinObservation(gymnasium.Wrapper, gymnasium.utils.RecordConstructorArgs):
    """An environment of MuJoCo with the readings of a skin in its observations.

    The space becomes a Dict: that of the environment, with a Box `key` of float64, shape (n,). A
    space that is not a Dict is named "observation" in it. Number k is `names[k]` in `units[k]`,
    without bounds; after `changes`, it is the change relative to the reading at the reset, without
    unit. There is no NaN: at a reset the meter reads until it has each reading once, with the
    contacts of that moment, while the robot stands still. The seed of the skin is drawn by the
    environment's own generator. The environment needs `unwrapped.model` and `unwrapped.data`.
    """

    def __init__(
        self, env: gymnasium.Env, skin: MujocoSkin, key: str = "skin", changes: bool = False
    ) -> None:
        gymnasium.utils.RecordConstructorArgs.__init__(self, skin=skin, key=key, changes=changes)
        gymnasium.Wrapper.__init__(self, env)
        if getattr(env.unwrapped, "model", None) is not skin.model or skin.envs != 1:
            raise InputError(
                "SkinObservation: the skin must be on `env.unwrapped.model`, in one environment"
            )
        self.skin, self.key, self.changes = skin, key, changes
        self.names = skin.names
        self.units = ("1",) * len(skin.names) if changes else skin.units
        own = env.observation_space
        parts = dict(own.spaces) if isinstance(own, spaces.Dict) else {OBSERVATION: own}
        if key in parts:
            raise InputError(f"SkinObservation: the observations have a {key!r} already")
        box = spaces.Box(-np.inf, np.inf, (len(self.names),), np.float64)
        self.observation_space = spaces.Dict(parts | {key: box})
        self._reference = np.ones(len(self.names))

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Reset environment and skin; the meter reads until each reading is there."""
        observation, info = self.env.reset(seed=seed, options=options)
        data, skin = self.env.unwrapped.data, self.skin  # pyright: ignore[reportAttributeAccessIssue]
        skin.reset(data, seed=int(self.np_random.integers(2**31)))
        contacts = skin.known_contacts([data])
        reading = skin.sensor.step(contacts, FIRST_STEP)
        while np.isnan(reading.vector).any():
            reading = skin.sensor.step(contacts, FIRST_STEP)
        self._reference = reading.vector[0]
        return self._with(observation, self._reference), info

    def step(self, action: Any) -> tuple[Any, Any, bool, bool, dict[str, Any]]:
        """Step environment and skin."""
        observation, reward, terminated, truncated, info = self.env.step(action)
        reading = self.skin.step(self.env.unwrapped.data)  # pyright: ignore[reportAttributeAccessIssue]
        shown = self._with(observation, reading.vector[0])
        return shown, reward, terminated, truncated, info

    def _with(self, observation: Any, vector: Real) -> dict[str, Any]:
        own = observation if isinstance(observation, dict) else {OBSERVATION: observation}
        shown = vector / self._reference - 1 if self.changes else vector.copy()
        return own | {self.key: shown}

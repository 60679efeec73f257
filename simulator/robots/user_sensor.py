"""User sensors of MuJoCo models, filled with the readings of skins while the engine steps."""

from __future__ import annotations

import ctypes
import threading
from typing import TYPE_CHECKING, Any

import numpy as np

from ..sweeps import InputError
from .engine import engine

if TYPE_CHECKING:
    from .mujoco_skin import MujocoSkin

INSTALLED: list[MujocoSkin] = []
"""Skins whose sensors are filled; MuJoCo has one callback for all models."""


class SeveralThreadsError(InputError):
    """MuJoCo steps a model with an installed skin in threads of its own."""

    def __init__(self) -> None:
        super().__init__(
            "MujocoSkin: an installed skin has one MjData; `mujoco.rollout` steps several in "
            "threads, and their user sensors are NaN: give it one, or `uninstall` the skin"
        )


class SensorCallback:
    """Callback that fills the sensors of installed skins, after an earlier callback.

    An error in a thread of MuJoCo's own would end the process. There it is raised in the thread
    that installed the skin, as soon as that runs again.
    """

    def __init__(self, earlier: Any) -> None:
        self.earlier, self.thread = earlier, threading.get_ident()

    def __call__(self, model: Any, data: Any, stage: Any) -> None:
        """Fill the user sensors of a model after its forces are known."""
        mujoco = engine()

        if self.earlier is not None:
            self.earlier(model, data, stage)
        if int(stage) == int(mujoco.mjtStage.mjSTAGE_ACC):
            own = threading.get_ident()
            of_python = any(each.ident == own for each in threading.enumerate())
            for skin in INSTALLED:
                if skin.model is model and of_python:
                    skin.fill(data)
                elif skin.model is model:
                    data.sensordata[skin._slice] = np.nan
                    ctypes.pythonapi.PyThreadState_SetAsyncExc(
                        ctypes.c_ulong(self.thread), ctypes.py_object(SeveralThreadsError)
                    )


def install(skin: MujocoSkin) -> None:
    """Fill the user sensor of a skin in every `mj_step` and `mj_forward` of its model.

    The callback `mjcb_sensor` of the process is set; one that was set before is still called. Only
    one MjData of the model may be stepped. Raises InputError if the skin has no user sensor.
    """
    mujoco = engine()

    if skin._slice is None:
        raise InputError(
            "MujocoSkin: `install` needs the name of a user sensor of the model: "
            'MujocoSkin(..., sensor="NAME")'
        )
    if not INSTALLED:
        mujoco.set_mjcb_sensor(SensorCallback(mujoco.get_mjcb_sensor()))
    if skin not in INSTALLED:
        INSTALLED.append(skin)


def uninstall(skin: MujocoSkin) -> None:
    """Stop filling the user sensor of a skin; without any, the earlier callback is set again."""
    mujoco = engine()

    if skin in INSTALLED:
        INSTALLED.remove(skin)
        if not INSTALLED:
            callback = mujoco.get_mjcb_sensor()
            mujoco.set_mjcb_sensor(getattr(callback, "earlier", None))

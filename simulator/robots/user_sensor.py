"""User sensors of MuJoCo models, filled with the readings of skins while the engine steps."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..sweeps import InputError
from .engine import engine

if TYPE_CHECKING:
    from .mujoco_skin import MujocoSkin

INSTALLED: list[MujocoSkin] = []
"""Skins whose sensors are filled; MuJoCo has one callback for all models."""


class SensorCallback:
    """Callback that fills the sensors of installed skins, after an earlier callback."""

    def __init__(self, earlier: Any) -> None:
        self.earlier = earlier

    def __call__(self, model: Any, data: Any, stage: Any) -> None:
        """Fill the user sensors of a model after its forces are known."""
        mujoco = engine()

        if self.earlier is not None:
            self.earlier(model, data, stage)
        if int(stage) == int(mujoco.mjtStage.mjSTAGE_ACC):
            for skin in INSTALLED:
                if skin.model is model:
                    skin.fill(data)


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

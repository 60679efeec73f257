"""MuJoCo, imported where it is needed; its compiled module has no types."""

from __future__ import annotations

from typing import Any

MjModel = Any
MjData = Any


def engine() -> Any:
    """The module `mujoco`."""
    import mujoco

    return mujoco

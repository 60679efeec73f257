"""MuJoCo, imported where it is needed; its compiled module has no types."""

from __future__ import annotations

from typing import Any, NamedTuple

from ..arrays import Real

MjModel = Any
MjData = Any


def engine() -> Any:
    """The module `mujoco`."""
    import mujoco

    return mujoco


class Geom(NamedTuple):
    """A geom of a model at the moment of its data."""

    model: MjModel
    data: MjData
    number: int

    @property
    def kind(self) -> str:
        """Kind, such as "sphere"."""
        kind = engine().mjtGeom(int(self.model.geom_type[self.number]))
        return kind.name.removeprefix("mjGEOM_").lower()

    @property
    def name(self) -> str:
        """Name in quotes, or the number."""
        mujoco = engine()
        name = mujoco.mj_id2name(self.model, mujoco.mjtObj.mjOBJ_GEOM, self.number)
        return repr(name) if name else str(self.number)

    @property
    def size(self) -> Real:
        """Sizes as the engine has them, m, (3,)."""
        return self.model.geom_size[self.number]

    @property
    def place(self) -> Real:
        """Origin of the geom's frame in the world, m, (3,)."""
        return self.data.geom_xpos[self.number]

    @property
    def axes(self) -> Real:
        """Axes of the geom's frame in the world, as columns, (3, 3)."""
        return self.data.geom_xmat[self.number].reshape(3, 3)

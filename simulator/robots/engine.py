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
        return named_geom(self.model, self.number)

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


def named_geom(model: MjModel, number: int) -> str:
    """Name in quotes, or the number, of a geom; of a soft body for numbers behind all geoms."""
    mujoco, kind = engine(), engine().mjtObj.mjOBJ_GEOM
    if number >= model.ngeom:
        number, kind = number - model.ngeom, mujoco.mjtObj.mjOBJ_FLEX
    name = mujoco.mj_id2name(model, kind, number)
    return repr(name) if name else str(number)

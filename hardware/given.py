"""What the meter's commands are given from outside: a scene as plain data, and its simulation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hardware.virtual.skin import Readout, Skin


@dataclass(frozen=True)
class SceneData:
    """A scene at one of its interfaces. text: the scene's TOML. frequencies: Hz, ascending."""

    name: str
    text: str
    frequencies: tuple[float, ...]
    rows: int
    columns: int
    interface: str


@dataclass(frozen=True)
class Simulation:
    """scene: by name or path and interface (None: the first). skin: of a scene. readout: by seed.

    Each raises InputError where it is given what does not exist.
    """

    scene: Callable[[str, str | None], SceneData]
    skin: Callable[[SceneData], Skin]
    readout: Callable[[SceneData, int], Readout]

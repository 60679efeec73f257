"""What the virtual meter is given from outside: scenes as plain data, and their simulation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..scene_data import SceneData

if TYPE_CHECKING:
    from .skin import Readout, Skin


@dataclass(frozen=True)
class Simulation:
    """scene: by name or path and interface (None: the first). skin: of a scene. readout: by seed.

    Each raises InputError where it is given what does not exist.
    """

    scene: Callable[[str, str | None], SceneData]
    skin: Callable[[SceneData], Skin]
    readout: Callable[[SceneData, int], Readout]

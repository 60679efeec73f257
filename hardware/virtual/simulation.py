"""What the virtual meter is given from outside: scenes as plain data, and their simulation."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..scene_data import SceneData

if TYPE_CHECKING:
    from ..page.document import MakeDocument
    from .skin import Readout, Skin


@dataclass(frozen=True)
class Simulation:
    """scene: by name or path, at interfaces (None: all). skins: of each. readout: by seed.

    document: of the page on which a skin is pressed. depths: that the forces of a press take, in
    words, empty where it has none.

    Each raises InputError where it is given what does not exist.
    """

    scene: Callable[[str, list[str] | None], SceneData]
    skins: Callable[[SceneData], Mapping[str, Skin]]
    readout: Callable[[SceneData, int], Readout]
    document: MakeDocument
    depths: Callable[[SceneData, str], str] = lambda scene, press: ""

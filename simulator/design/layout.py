"""What a design decides: material, readings and frequencies."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from ..scene.contacts import Interface
from ..scene.parts import Skin
from ..scene.scene import Scene

TENTH = 0.1


@dataclass(frozen=True)
class Material:
    """Sheet resistances in ohm/sq, and the foam's capacitance over that of the scene."""

    top: float
    bottom: float
    foam: float = 1.0

    def times(self, factor: float) -> Material:
        """Both sheets that many times as resistive."""
        return replace(self, top=factor * self.top, bottom=factor * self.bottom)


def material_of(skin: Skin) -> Material:
    """The material of a scene."""
    return Material(skin.top.sheet_resistance, skin.bottom.sheet_resistance)


@dataclass(frozen=True)
class Layout:
    """Material, readings and frequencies of a design.

    frequencies: Hz, ascending, for all readings without own frequencies.
    """

    material: Material
    readings: tuple[Interface, ...]
    frequencies: tuple[float, ...]

    @property
    def frequencies_of_each(self) -> list[tuple[float, ...]]:
        """Frequencies in Hz at which each reading is taken, ascending."""
        return [each.frequencies or self.frequencies for each in self.readings]

    @property
    def has_own_frequencies(self) -> bool:
        """True if readings have frequencies of their own."""
        return any(each.frequencies is not None for each in self.readings)

    @property
    def count(self) -> int:
        """Number of readings, each counted at all its frequencies."""
        return sum(map(len, self.frequencies_of_each))


def lowest_tenth(shares: Sequence[float]) -> float:
    """Merit that nine of ten samples reach at least."""
    return sorted(shares)[math.ceil(TENTH * len(shares)) - 1]


def designed(scene: Scene, layout: Layout) -> Scene:
    """The scene with a layout's material, readings and frequencies."""
    foam, factor = scene.skin.foam, layout.material.foam
    of_foam: dict[str, object] = {}
    if factor != 1 and foam.thickness is not None:
        of_foam = {"skin.foam.thickness": foam.thickness / factor}
    return scene.with_(
        {
            "skin.top.sheet_resistance": layout.material.top,
            "skin.bottom.sheet_resistance": layout.material.bottom,
            **of_foam,
            "interface": [each.model_dump(mode="json") for each in layout.readings],
            "sweep.frequencies": list(layout.frequencies),
        }
    )

"""A skin cut into equal rectangular cells: where the nodes are, and which lie under the foils."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from rcskin.simulator.press.capacitance import capacitance_map
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.contacts import Contact
from rcskin.simulator.scene.scene import Scene

TOUCHING = 1e-9


@dataclass(frozen=True)
class Cells:
    """How many equal cells there are along the length and along the width of a skin."""

    along: int
    across: int

    @classmethod
    def of_pixels(cls, scene: Scene, cells: int) -> Cells:
        """As many cells along either side of every pixel, so that they conform to the pixels."""
        return cls(cells * scene.pixels.columns, cells * scene.pixels.rows)

    @property
    def nodes(self) -> int:
        """How many nodes there are on a sheet."""
        return (self.along + 1) * (self.across + 1)

    @property
    def shape(self) -> tuple[int, int]:
        """(nodes across, nodes along): nodes are counted along the length first."""
        return self.across + 1, self.along + 1

    def sides(self, scene: Scene) -> tuple[float, float]:
        """Sides of a cell in m, along and across."""
        return scene.skin.length / self.along, scene.skin.width / self.across

    def capacitance(self, scene: Scene, press: Press) -> NDArray[np.float64]:
        """c in F/m² in the middle of every cell, shape (across, along)."""
        pixels = capacitance_map(scene.parts.skin, press)
        row, column = (
            ((np.arange(cells) + 0.5) / cells * count).astype(int)
            for cells, count in zip((self.across, self.along), pixels.shape, strict=True)
        )
        return pixels[np.ix_(row, column)]

    def under(self, contact: Contact) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Nodes under a foil in order, and their neighbours one cell inwards.

        A foil between two nodes takes the nearer one.
        """
        nodes = np.arange(self.nodes).reshape(self.shape)
        if contact.edge in ("bottom", "top"):
            nodes = nodes.T
        if contact.edge in ("right", "top"):
            nodes = nodes[:, ::-1]
        place = np.linspace(0, 1, len(nodes))
        low, high = contact.span
        covered = (low - TOUCHING <= place) & (place <= high + TOUCHING)
        if not covered.any():
            covered[np.argmin(abs(place - (low + high) / 2))] = True
        return nodes[covered, 0], nodes[covered, 1]


@dataclass(frozen=True)
class Fields:
    """What is solved for: one potential difference where both foils lie alike, else both sheets.

    resistances: sheet resistance of each field in ohm/sq, of the high foil's sheet first. high,
    low: the foil held at 1 V in the first field and the one held at 0 V in the second.
    """

    resistances: tuple[float, ...]
    high: Contact
    low: Contact

    @classmethod
    def of_scene(cls, scene: Scene) -> Fields:
        """The fields of the first interface."""
        interface = scene.interfaces[0]
        high, low = (
            scene.parts.skin.contact(names[0]) for names in (interface.high, interface.low)
        )
        sheets = [scene.skin.sheet(foil.electrode).sheet_resistance for foil in (high, low)]
        same = (high.edge, high.span) == (low.edge, low.span)
        return cls((sum(sheets),) if same else tuple(sheets), high, low)

    @property
    def coupling(self) -> NDArray[np.float64]:
        """How the capacitance enters between the fields."""
        one = len(self.resistances) == 1
        return np.ones((1, 1)) if one else np.array([[1.0, -1.0], [-1.0, 1.0]])

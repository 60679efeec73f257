"""Bilinear elements on equal cells, and three ways from the potentials to Z.

A skin is cut into equal rectangular cells: where the nodes are, and which lie under the foils.
(K + s M) u = 0 with 1 V and 0 V under the foils. Z is 1/Y of the current that the foil's nodes
draw; 1 V over the current by the potential's slope at the foil; or by the deviation from the driven
potential, of which no digits are lost: with g = 1 V all over the driven field, K g = 0 and
(K + s M) d = -s M g; then Y = s g'Mg + s (Mg)'d.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import DTypeLike, NDArray
from rcskin.simulator.press.capacitance import capacitance_map
from rcskin.simulator.press.press import Press
from rcskin.simulator.scene.contacts import Contact
from rcskin.simulator.scene.scene import Scene
from scipy.sparse import csc_matrix, kron
from scipy.sparse.linalg import spsolve

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


DIFFERENCE = np.array([[1.0, -1.0], [-1.0, 1.0]])
PRODUCT = np.array([[2.0, 1.0], [1.0, 2.0]]) / 6


@dataclass(frozen=True)
class System:
    """K in S, M in F over the nodes of all fields; nodes held at 1 V, at 0 V, and free ones."""

    K: csc_matrix
    M: csc_matrix
    high: NDArray[np.int64]
    low: NDArray[np.int64]
    free: NDArray[np.int64]

    def potential(self, s: complex) -> NDArray[np.complex128]:
        """u in V at every node; s in rad/s."""
        A = csc_matrix(self.K + s * self.M)
        u = np.zeros(len(self.free) + len(self.high) + len(self.low), dtype=complex)
        u[self.high] = 1.0
        u[self.free] = spsolve(A[self.free][:, self.free], -(A[self.free] @ u))
        return u


def build(scene: Scene, press: Press, cells: Cells) -> System:
    """The system of a press on a scene cut into these cells."""
    fields = Fields.of_scene(scene)
    along, across = cells.sides(scene)
    laplacian = across / along * np.kron(PRODUCT, DIFFERENCE)
    laplacian += along / across * np.kron(DIFFERENCE, PRODUCT)
    L = assembled(cells, laplacian, np.ones((cells.across, cells.along)))
    mass = along * across * np.kron(PRODUCT, PRODUCT)
    M = assembled(cells, mass, cells.capacitance(scene, press))
    nodes, last = cells.nodes, len(fields.resistances) - 1
    high = cells.under(fields.high)[0]
    low = nodes + cells.under(fields.low)[0] if last else np.array([], dtype=int)
    return System(
        csc_matrix(kron(np.diag(1 / np.array(fields.resistances)), L)),
        csc_matrix(kron(fields.coupling, M)),
        high,
        low,
        np.setdiff1d(np.arange(nodes * (last + 1)), np.concatenate([high, low])),
    )


def assembled(cells: Cells, element: NDArray, weight: NDArray) -> csc_matrix:
    """The sum over cells of weight times the element matrix, shape (node, node)."""
    nodes = np.arange(cells.nodes).reshape(cells.shape)
    corners = [nodes[:-1, :-1], nodes[:-1, 1:], nodes[1:, :-1], nodes[1:, 1:]]
    of_cell = np.stack([corner.ravel() for corner in corners], axis=1)
    rows, columns = np.repeat(of_cell, 4, axis=1), np.tile(of_cell, (1, 4))
    values = weight.reshape(-1, 1) * element.reshape(1, -1)
    return csc_matrix((values.ravel(), (rows.ravel(), columns.ravel())), shape=(cells.nodes,) * 2)


def by_current(scene: Scene, press: Press, frequencies: NDArray, cells: Cells) -> NDArray:
    """Z = 1/Y, Y = the sum of (K + s M) u over the nodes held at 1 V."""
    system = build(scene, press, cells)

    def admittance(s: complex) -> complex:
        drawn = (system.K + s * system.M) @ system.potential(s)
        return drawn[system.high].sum()

    return 1 / np.array([admittance(2j * np.pi * f) for f in frequencies])


def by_slope(scene: Scene, press: Press, frequencies: NDArray, cells: Cells) -> NDArray:
    """Z = 1 V / I, I = (mean fall of the potential over one cell) / h * width of the foil / R."""
    system, fields = build(scene, press, cells), Fields.of_scene(scene)
    foil = fields.high
    under, inside = cells.under(foil)
    into, along_foil = cells.sides(scene), (scene.skin.width, scene.skin.length)
    axis = 0 if foil.edge in ("left", "right") else 1
    width = (foil.span[1] - foil.span[0]) * along_foil[axis]
    u = np.stack([system.potential(2j * np.pi * f) for f in frequencies])
    slope = (u[:, under] - u[:, inside]).mean(axis=1) / into[axis]
    return fields.resistances[0] / (slope * width)


def by_deviation(
    scene: Scene,
    press: Press,
    frequencies: NDArray,
    cells: Cells,
    number: DTypeLike = np.complex128,
) -> NDArray:
    """Z = 1/Y with all arithmetic in `number`, complex64 or complex128."""
    system = build(scene, press, cells)
    free = system.free
    fields = len(Fields.of_scene(scene).resistances)
    g = np.arange(fields * cells.nodes) < cells.nodes
    charge = (system.M @ g).astype(number)
    at_once = charge[g].sum()
    K, M = (A[free][:, free].astype(number) for A in (system.K, system.M))

    def admittance(s: np.complexfloating) -> np.complexfloating:
        d = spsolve(K + s * M, -s * charge[free])
        return s * at_once + s * (charge[free] @ d)

    s = (2j * np.pi * np.asarray(frequencies)).astype(number)
    return np.reciprocal(np.array([admittance(each) for each in s], dtype=number))

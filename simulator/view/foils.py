"""Foils as they are drawn: ribbons along the edge of the skin, the bottom sheet's farther out."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from simulator.contour import curves, position, section

if TYPE_CHECKING:
    from simulator.press import Press
    from simulator.scene import Contact, Interface, Scene
    from simulator.view.surface import Surface

Real = NDArray[np.float64]
Role = Literal["high", "low", "floating"]

PIECES = 64
BAND = {"top": (0.012, 0.03), "bottom": (0.036, 0.054)}
"""Of the skin's size: from the edge outwards, where the foils of each sheet are drawn."""
NAME_GAP, NAME_STEP = 0.08, 0.04
"""Of the skin's size: from the edge to the name of a foil, and on to that of a foil beside it."""
BESIDE = 0.12
"""Of the skin's size: foils with middles nearer than that have their names stacked."""
STEP_INWARD = 1e-3
"""Of the skin's size: from an edge to where the surface is asked which way is out."""


@dataclass(frozen=True)
class Foil:
    """A foil as drawn.

    quads: corners of the pieces of its ribbon in space, m, (3, 4, piece). middle: of the edge that
    it lies along, (3,). out: from there off the skin, to where its name stands.
    """

    name: str
    role: Role
    quads: Real
    middle: Real
    out: Real

    @property
    def place(self) -> Real:
        """Where its name stands, (3,)."""
        return self.middle + self.out

    @property
    def closed(self) -> bool:
        """Whether it goes all around, and is named in its middle."""
        return bool(np.linalg.norm(self.along) < np.linalg.norm(self.out) / 2)

    @property
    def along(self) -> Real:
        """From its first to its last end, (3,)."""
        return self.quads[:, 1, -1] - self.quads[:, 0, 0]


def foils(scene: Scene, press: Press, interface: Interface, skin: Surface) -> tuple[Foil, ...]:
    """All foils of a scene, driven and floating."""
    edges = _facets(scene, press, skin) if scene.skin.mesh else _sides(scene, skin)
    drawn: list[Foil] = []
    for contact, (ends, out) in zip(scene.contacts, edges, strict=True):
        number = ends.shape[2] // 2
        middle = ends[:, :, number].mean(axis=1)
        before = sum(np.linalg.norm(middle - foil.middle) < BESIDE * skin.size for foil in drawn)
        gap = skin.size * (NAME_GAP + before * NAME_STEP)
        quads = _ribbon(ends, out, skin.size, BAND[contact.electrode])
        role = _role(contact, interface)
        drawn.append(Foil(contact.name, role, quads, middle, gap * out[:, :, number].mean(axis=1)))
    return tuple(drawn)


def _role(contact: Contact, interface: Interface) -> Role:
    if contact.name in interface.high:
        return "high"
    return "low" if contact.name in interface.low else "floating"


def _ribbon(ends: Real, out: Real, size: float, band: tuple[float, float]) -> Real:
    near, far = (ends + size * offset * out for offset in band)
    return np.stack([near[:, 0], near[:, 1], far[:, 1], far[:, 0]], axis=1)


def _sides(scene: Scene, skin: Surface) -> list[tuple[Real, Real]]:
    """Of each foil the ends of its pieces in space and the way out there, both (3, 2, piece)."""
    return [_side(_path(contact, scene), skin) for contact in scene.contacts]


def _path(contact: Contact, scene: Scene) -> Real:
    """A foil's line along a skin without mesh, flat (2, n)."""
    along = section(contact, scene.skin)
    corners = curves(scene.skin)[along.curve]
    marks = np.linspace(along.start, along.stop, PIECES + 1)
    return np.array([position(corners, mark) for mark in marks]).T


def _side(path: Real, skin: Surface) -> tuple[Real, Real]:
    places, _, _ = skin.carry(path)
    within, _, _ = skin.carry(path - STEP_INWARD * skin.size * skin.outward(path))
    out = (places - within) / np.linalg.norm(places - within, axis=0)
    pieces = list(pairwise(range(path.shape[1])))
    return places[:, pieces].transpose(0, 2, 1), out[:, pieces].transpose(0, 2, 1)


def _facets(scene: Scene, press: Press, skin: Surface) -> list[tuple[Real, Real]]:
    """The same on a mesh of a file: each facet a piece, its way out off the triangle it is of."""
    from simulator.domain import domain

    mesh = domain(scene, press, skin.size)
    p = mesh.p if len(mesh.p) == 3 else skin.carry(mesh.p)[0]
    owner = {
        (int(a), int(b)): int(apex)
        for first, second, third in mesh.t.T
        for a, b, apex in ((first, second, third), (first, third, second), (second, third, first))
    }
    found = []
    for contact in scene.contacts:
        facets = mesh.foils[contact.name]
        ends = p[:, facets]
        apex = p[:, [owner[int(a), int(b)] for a, b in facets.T]]
        out = _away(ends, apex)
        found.append((ends, np.stack([out, out], axis=1)))
    return found


def _away(ends: Real, apex: Real) -> Real:
    """Unit vectors (3, n) across the lines between ends (3, 2, n), away from apex (3, n)."""
    along = ends[:, 1] - ends[:, 0]
    back = ends[:, 0] - apex
    across = back - along * (back * along).sum(axis=0) / (along**2).sum(axis=0)
    return across / np.linalg.norm(across, axis=0)

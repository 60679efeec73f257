"""The foils of a skin as they are drawn, on rectangles and on meshes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from ..scene.contacts import path

if TYPE_CHECKING:
    from ..mesh.domain import Domain
    from ..press.press import Press
    from ..press.touch import Touch
    from ..scene.contacts import Contact, Interface
    from ..scene.scene import Scene
    from .camera import Camera
    from .surface import Surface

Real = NDArray[np.float64]

Role = Literal["high", "low", "floating"]

PIECES = 64
BAND = {"top": (0.012, 0.03), "bottom": (0.036, 0.054)}
"""Of the skin's size: from the edge outwards, where the foils of each sheet are drawn."""

NAME_GAP, NAME_STEP = 0.08, 0.04
"""Of the skin's size: from the edge to the name of a foil, and on to that of a foil beside it."""

BESIDE = 0.12
"""Of the skin's size: foils with middles nearer than that have their names stacked."""

HIDDEN = 0.6
"""Of its length: what is seen less of counts as along the line of sight."""

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
    def closed(self) -> bool:
        """Whether it goes all around, and is named in its middle."""
        return bool(np.linalg.norm(self.along) < np.linalg.norm(self.out) / 2)

    def named_at(self, camera: Camera) -> Real:
        """Where its name stands in the picture, m, (2,).

        Off the skin; away from the picture's middle where off is along the line of sight; in the
        middle of a foil that is closed.
        """
        if self.closed:
            return camera.project(self.quads.reshape(3, -1).mean(axis=1))
        middle, out = camera.project(self.middle), camera.project(self.out)
        gap = np.linalg.norm(self.out)
        if np.linalg.norm(out) < HIDDEN * gap:
            right = 2 * middle[0] > camera.low[0] + camera.high[0]
            out = np.array([1.0 if right else -1.0, 0.0])
        return middle + gap * out / np.linalg.norm(out)

    @property
    def along(self) -> Real:
        """From its first to its last end, (3,)."""
        return self.quads[:, 1, -1] - self.quads[:, 0, 0]


def foils(
    scene: Scene, interface: Interface, skin: Surface, mesh: Meshed | None = None
) -> tuple[Foil, ...]:
    """All foils of a scene, driven and floating. mesh: of a skin that a file brings."""
    drawn: list[Foil] = []
    for contact in scene.contacts:
        ends, out = mesh.foil(contact.name) if mesh else _along(contact, scene, skin)
        number = _middle(ends)
        middle = ends[:, :, number].mean(axis=1)
        before = sum(np.linalg.norm(middle - foil.middle) < BESIDE * skin.size for foil in drawn)
        gap = skin.size * (NAME_GAP + before * NAME_STEP)
        quads = _ribbon(ends, out, skin.size, BAND[contact.electrode])
        role = _role(contact, interface)
        drawn.append(Foil(contact.name, role, quads, middle, gap * out[:, :, number].mean(axis=1)))
    return tuple(drawn)


def _middle(ends: Real) -> int:
    """The number of the piece that is nearest to the mean of all."""
    middles = ends.mean(axis=1)
    off = np.linalg.norm(middles - middles.mean(axis=1, keepdims=True), axis=0)
    return int(np.argmin(off))


def _role(contact: Contact, interface: Interface) -> Role:
    if contact.name in interface.high:
        return "high"
    return "low" if contact.name in interface.low else "floating"


def _ribbon(ends: Real, out: Real, size: float, band: tuple[float, float]) -> Real:
    near, far = (ends + size * offset * out for offset in band)
    return np.stack([near[:, 0], near[:, 1], far[:, 1], far[:, 0]], axis=1)


def _along(contact: Contact, scene: Scene, skin: Surface) -> tuple[Real, Real]:
    return _side(path(contact, scene.skin, PIECES), skin)


def _side(line: Real, skin: Surface) -> tuple[Real, Real]:
    """Of a line the ends of its pieces in space and the way out there, both (3, 2, piece)."""
    places, _, _ = skin.carry(line)
    within, _, _ = skin.carry(line - STEP_INWARD * skin.size * skin.outward(line))
    out = (places - within) / np.linalg.norm(places - within, axis=0)
    pieces = list(pairwise(range(line.shape[1])))
    return places[:, pieces].transpose(0, 2, 1), out[:, pieces].transpose(0, 2, 1)


class Meshed:
    """The triangles of a scene's mesh, in space as the skin is drawn."""

    def __init__(self, scene: Scene, press: Press, skin: Surface) -> None:
        from ..mesh.skin_mesh import domain

        self._columns = scene.pixels.columns
        self._domain: Domain = domain(scene, press, skin.size)
        p = self._domain.p
        self._p = p if len(p) == 3 else skin.carry(p)[0]

    @cached_property
    def _edges(self) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
        """Edges (2, edge), and for each of both sides its triangle and the point across, (2, edge).

        -1 where there is no triangle.
        """
        a, b, c = self._domain.t
        ends = np.hstack([np.stack([a, b]), np.stack([a, c]), np.stack([b, c])])
        edges, number = np.unique(ends, axis=1, return_inverse=True)
        triangle = np.tile(np.arange(a.size), 3)
        found = np.full((2, 2, edges.shape[1]), -1)
        order = np.argsort(number.ravel(), kind="stable")
        first = np.append(True, np.diff(number.ravel()[order]) > 0)
        for side, chosen in enumerate((order[first], order[~first])):
            found[0, side, number.ravel()[chosen]] = triangle[chosen]
            found[1, side, number.ravel()[chosen]] = np.concatenate([c, b, a])[chosen]
        return edges, found[0], found[1]

    @property
    def _pixels(self) -> NDArray[np.int64]:
        """On both sides of each edge, (2, edge); -1 off the pixels and off the skin."""
        _, triangle, _ = self._edges
        return np.where(triangle < 0, -1, self._domain.pixel[triangle])

    def pixel_lines(self) -> Iterator[Real]:
        """Lines (3, 2) between pixels."""
        edges, triangle, _ = self._edges
        one, other = self._pixels
        yield from self._lines(edges[:, (one != other) & (triangle[1] >= 0)])

    def around(self, touch: Touch) -> Iterator[Real]:
        """Lines (3, 2) around a pixel."""
        edges, _, _ = self._edges
        number = (touch.row - 1) * self._columns + touch.column - 1
        one, other = self._pixels == number
        yield from self._lines(edges[:, one != other])

    def _lines(self, edges: NDArray[np.int64]) -> Iterator[Real]:
        yield from self._p[:, edges].transpose(2, 0, 1)

    def foil(self, name: str) -> tuple[Real, Real]:
        """Ends of a foil's facets in space and the way off the skin there, both (3, 2, facet)."""
        facets = self._domain.foils[name]
        edges, _, across = self._edges
        places = {(int(a), int(b)): number for number, (a, b) in enumerate(edges.T)}
        apex = self._p[:, across[0, [places[int(a), int(b)] for a, b in facets.T]]]
        ends = self._p[:, facets]
        out = _away(ends, apex)
        return ends, np.stack([out, out], axis=1)


def _away(ends: Real, apex: Real) -> Real:
    """Unit vectors (3, n) across the lines between ends (3, 2, n), away from apex (3, n)."""
    along = ends[:, 1] - ends[:, 0]
    back = ends[:, 0] - apex
    across = back - along * (back * along).sum(axis=0) / (along**2).sum(axis=0)
    return across / np.linalg.norm(across, axis=0)

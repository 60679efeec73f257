"""Foils of a skin as they are drawn, on rectangles and on meshes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Literal

import numpy as np

from ..arrays import Integer, Real
from ..scene.contacts import path

if TYPE_CHECKING:
    from ..mesh.domain import Domain
    from ..press.press import Press
    from ..press.touch import Touch
    from ..scene.contacts import Contact, Interface
    from ..scene.parts import Skin
    from .skin_surface import SkinSurface


Role = Literal["high", "low", "floating"]

PIECES = 64
BAND = {"top": (0.012, 0.03), "bottom": (0.036, 0.054)}
"""Band outside the edge, over the skin's size, for the foils of each sheet."""


@dataclass(frozen=True)
class Foil:
    """Foil as drawn.

    quads: corners of the pieces of its ribbon in space, m, (3, 4, piece).
    """

    name: str
    role: Role
    quads: Real

    @property
    def label(self) -> str:
        """Name of the foil and its role."""
        return f"{self.name} ({self.role})"

    @property
    def middle(self) -> Real:
        """Mean of the foil's corners, m, (3,)."""
        return self.quads.reshape(3, -1).mean(axis=1)


def foils(
    skin: Skin,
    interface: Interface,
    surface: SkinSurface,
    to_space: Callable[[Real], Real],
    mesh: SkinMesh | None = None,
) -> tuple[Foil, ...]:
    """All foils of a scene, driven and floating.

    to_space: maps flat places (2, n) to space, (3, n), on the skin and off its edges. mesh: that
    of a skin that a file describes.
    """
    drawn: list[Foil] = []
    for contact in skin.foils:
        near, far = (surface.size * offset for offset in BAND[contact.electrode])
        if mesh:
            ends, out = mesh.foil(contact.name)
            inner, outer = ends + near * out, ends + far * out
        else:
            along = path(contact, skin, PIECES)
            out = surface.outward(along)
            inner, outer = (_pieces(to_space(along + off * out)) for off in (near, far))
        quads = np.stack([inner[:, 0], inner[:, 1], outer[:, 1], outer[:, 0]], axis=1)
        drawn.append(Foil(contact.name, _role(contact, interface), quads))
    return tuple(drawn)


def _pieces(line: Real) -> Real:
    """Ends (3, 2, n) of the pieces of a line (3, n + 1)."""
    return np.stack([line[:, :-1], line[:, 1:]], axis=1)


def _role(contact: Contact, interface: Interface) -> Role:
    if contact.name in interface.high:
        return "high"
    return "low" if contact.name in interface.low else "floating"


class SkinMesh:
    """Triangles of a scene's mesh, in space as the skin is drawn."""

    def __init__(self, skin: Skin, press: Press, surface: SkinSurface) -> None:
        from ..mesh.skin_mesh import domain

        self._rows, self._columns = skin.pixels.rows, skin.pixels.columns
        self._domain: Domain = domain(skin, press, surface.size)
        p = self._domain.p
        self._p = p if len(p) == 3 else surface.carry(p)[0]

    @cached_property
    def _edges(self) -> tuple[Integer, Integer, Integer]:
        """Edges (2, edge), and the triangle and the opposite point on both sides of each.

        Both are of shape (2, edge); -1 where there is no triangle.
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
    def _pixels(self) -> Integer:
        """Pixels on both sides of each edge, (2, edge); -1 off pixels and skin."""
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

    def middles(self) -> Real:
        """Middles of pixels, weighted by the area of their triangles, m, (3, pixel)."""
        corners = self._p[:, self._domain.t]
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0], axis=0)
        area, pixel = np.linalg.norm(across, axis=0), self._domain.pixel
        inside, count = pixel >= 0, self._rows * self._columns
        total = np.bincount(pixel[inside], area[inside], count)
        weighed = (area * corners.mean(axis=1))[:, inside]
        sums = [np.bincount(pixel[inside], each, count) for each in weighed]
        return np.stack(sums) / total

    def _lines(self, edges: Integer) -> Iterator[Real]:
        yield from self._p[:, edges].transpose(2, 0, 1)

    def foil(self, name: str) -> tuple[Real, Real]:
        """Ends of a foil's facets, and unit vectors off the skin there.

        Both are in space, of shape (3, 2, facet).
        """
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

"""Where foils and pixels of a skin lie that a mesh file brings: along its triangles' edges."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from simulator.domain import Domain
    from simulator.press import Press, Touch
    from simulator.scene import Scene
    from simulator.view.surface import Surface

Real = NDArray[np.float64]


class Meshed:
    """The triangles of a scene's mesh, in space as the skin is drawn."""

    def __init__(self, scene: Scene, press: Press, skin: Surface) -> None:
        from simulator.domain import domain

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

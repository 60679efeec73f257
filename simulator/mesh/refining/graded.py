"""Triangles halved as often as their parts of an error ask for: what is left is told in advance.

Of the part of a triangle one within it, of A of its area, keeps A^(p + 1), where the field is
smooth and p is the order of the elements. At a corner the field goes like r^a, and the one there
keeps A^a.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..domain import Domain, areas
from .exponents import WHOLE
from .untangled import finer

LEFT = 0.7
"""Of the error that is enough: what lies in triangles that are not marked."""
STRENGTH = 0.12
"""Over (1 - a)^2: of Rs and Cp, what a corner takes of triangles as large as the skin."""
MOST_ROUNDS = 16
MOST_GROWN = 8.0
"""Triangles at most, over those before: what is told further in advance is not sure."""


def graded(
    mesh: Domain,
    parts: NDArray[np.float64],
    enough: float,
    order: int,
    exponents: NDArray[np.float64],
) -> tuple[Domain, NDArray[np.float64]]:
    """The mesh with triangles halved until about as much is left of each error as is enough, and
    the parts of its triangles then, as they are told in advance.

    parts: of each triangle in some errors, shape (error, triangle). order: of the elements.
    exponents: of points as of `corner_exponents`. Raises as `finer`.
    """
    pixel, found, most = mesh.pixel, mesh, MOST_GROWN * mesh.t.shape[1]
    for _ in range(MOST_ROUNDS):
        large = parts[parts.sum(axis=1) > enough]
        if not len(large) or found.t.shape[1] > most:
            break
        marked = [fewest(each, each.sum() - LEFT * enough) for each in large]
        numbers = np.arange(found.t.shape[1])
        cut = finer(replace(found, pixel=numbers), np.unique(np.concatenate(marked)))
        parts = parts[:, cut.pixel] * _kept(found, cut, order, exponents)
        pixel = pixel[cut.pixel]
        found = replace(cut, pixel=pixel)
    return found, parts


def corner_parts(mesh: Domain, exponents: NDArray[np.float64]) -> NDArray[np.float64]:
    """About what each corner takes of Rs and Cp on a coarse mesh, told before there is any answer.

    Of each triangle there, shape (corner, triangle). On 20 random skins half of the corners took
    between a third and three times that. exponents: of points as of `corner_exponents`.
    """
    area, corners = areas(mesh.p, mesh.t), np.flatnonzero(exponents < 1 - WHOLE)
    parts = np.zeros((len(corners), len(area)))
    for part, corner in zip(parts, corners.tolist(), strict=True):
        there, power = (mesh.t == corner).any(axis=0), float(exponents[corner])
        size = area[there].mean() / area.sum()
        part[there] = STRENGTH * (1 - power) ** 2 * size**power / np.count_nonzero(there)
    return parts


def fewest(parts: NDArray[np.float64], held: float) -> NDArray[np.int64]:
    """The fewest triangles whose parts are so much together, by number, ascending; one at least."""
    order = np.argsort(-parts, kind="stable")
    return np.sort(order[: int(np.searchsorted(np.cumsum(parts[order]), held)) + 1])


def _kept(
    before: Domain, after: Domain, order: int, exponents: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Of the part of the triangle that each lies in what it is told to keep, shape (triangle,)."""
    area, whole = areas(after.p, after.t), areas(before.p, before.t)
    of_corners = np.append(exponents, np.inf)[np.minimum(after.t, len(exponents))].min(axis=0)
    return np.minimum(area / whole[after.pixel], 1.0) ** np.minimum(of_corners, order + 1)

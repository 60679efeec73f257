"""Triangles halved as often as their parts of an error ask for: what is left is told in advance.

Of the part of a triangle one within it, of A of its area, keeps A^(p + 1), where the field is
smooth and p is the order of the elements. At a corner the field goes like r^a, and the one there
keeps A^a: a = pi / omega within an angle omega, half of that where a foil ends.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..arcs import EDGES, beside_chords
from ..domain import Domain, Points, areas
from ..triangles import edge_numbers, edges_of
from .untangled import finer

LEFT = 0.7
"""Of the error that is enough: what lies in triangles that are not marked."""
WHOLE = 0.02
"""Exponents nearer to a whole number are of smooth fields."""
MOST_ROUNDS = 16
MOST_GROWN = 8.0
"""Triangles at most, over those before: what is told further in advance is not sure."""


def graded(
    mesh: Domain,
    parts: NDArray[np.float64],
    enough: float,
    order: int,
    exponents: NDArray[np.float64],
) -> Domain:
    """The mesh with triangles halved until about as much is left of each error as is enough.

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
    return found


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


def corner_exponents(mesh: Domain, foils: Sequence[Sequence[str]]) -> NDArray[np.float64]:
    """The power of the distance that the field goes with from each point, inf where it is smooth.

    foils: the names of those that each field has. Shape (point,).
    """
    edges, of_triangle = edges_of(mesh.t)
    rim = edges[:, np.bincount(of_triangle.ravel()) == 1]
    angle = _angles(mesh)
    exponents = np.full(len(angle), np.inf)
    for names in foils:
        under = np.zeros(rim.shape[1], dtype=np.int64)
        for number, name in enumerate(names, 1):
            own = edge_numbers(mesh.foils[name], rim)
            under[own[own >= 0]] = number
        low, high = np.full(len(angle), len(names) + 1), np.zeros(len(angle), dtype=np.int64)
        for ends in rim:
            np.minimum.at(low, ends, under)
            np.maximum.at(high, ends, under)
        at = np.unique(rim)
        power = np.where((low[at] == 0) & (high[at] > 0), 0.5, 1.0) * np.pi / angle[at]
        smooth = np.abs(power - np.round(power)) < WHOLE
        exponents[at] = np.minimum(exponents[at], np.where(smooth & (power > 1 / 2), np.inf, power))
    return exponents


def _angles(mesh: Domain) -> NDArray[np.float64]:
    """Within the triangles around each point, together, shape (point,)."""
    at = np.zeros(mesh.t.shape)
    for corner in range(3):
        along, across = (
            mesh.p[:, mesh.t[(corner + turn) % 3]] - mesh.p[:, mesh.t[corner]] for turn in (1, 2)
        )
        at[corner] = _between(along, across)
    outward = np.sign(beside_chords(mesh.p, mesh.t, mesh.curvature))
    for (i, j), bend, side in zip(EDGES, mesh.curvature, outward, strict=True):
        chord = np.linalg.norm(mesh.p[:, mesh.t[j]] - mesh.p[:, mesh.t[i]], axis=0)
        turned = side * np.arcsin(np.abs(bend) * chord / 2)
        at[i] += turned
        at[j] += turned
    around = np.zeros(mesh.p.shape[1])
    np.add.at(around, mesh.t, at)
    return around


def _between(u: Points, v: Points) -> NDArray[np.float64]:
    shared = (u * v).sum(axis=0)
    area = np.sqrt(np.maximum((u**2).sum(axis=0) * (v**2).sum(axis=0) - shared**2, 0.0))
    return np.arctan2(area, shared)

"""Halves triangles until predicted errors are small enough.

Every triangle has a part of each error. A child with the fraction A of its parent's area keeps the
fraction A^(p + 1) of the parent's part where the field is smooth, p being the order of the
elements. At a corner, where the field varies as r^a, the child there keeps the fraction A^a.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...arrays import Integer, Real
from ..domain import Domain, areas
from .exponents import WHOLE
from .inverted_triangles import finer

LEFT = 0.7
"""Fraction of the sufficient error that lies in triangles that are not marked."""
STRENGTH = 0.12
"""Part of Rs and Cp due to a corner, over (1 - a)^2.

It is that with triangles as large as the skin.
"""
MAX_GRADING_ROUNDS = 16
MAX_GROWTH = 8.0
"""Largest ratio of triangles after and before; predictions beyond are unreliable."""


def graded(
    mesh: Domain, parts: Real, enough: float, order: int, exponents: Real
) -> tuple[Domain, Real]:
    """Mesh with triangles halved until about `enough` is left of each error.

    Also returns the predicted parts of its triangles. parts: those of each triangle in some errors,
    shape (error, triangle). order: that of the elements. exponents: at points, as from
    `corner_exponents`. Raises what `finer` raises.
    """
    pixel, found, most = mesh.pixel, mesh, MAX_GROWTH * mesh.t.shape[1]
    for _ in range(MAX_GRADING_ROUNDS):
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


def corner_parts(mesh: Domain, exponents: Real) -> Real:
    """Approximate part of each corner in Rs and Cp on a coarse mesh.

    It needs no solution. Shape (corner, triangle): the part is spread over the triangles at the
    corner. On 20 random skins half of the corners had between a third and three times that.
    exponents: at points, as from `corner_exponents`.
    """
    area, corners = areas(mesh.p, mesh.t), np.flatnonzero(exponents < 1 - WHOLE)
    parts = np.zeros((len(corners), len(area)))
    for part, corner in zip(parts, corners.tolist(), strict=True):
        there, power = (mesh.t == corner).any(axis=0), float(exponents[corner])
        size = area[there].mean() / area.sum()
        part[there] = STRENGTH * (1 - power) ** 2 * size**power / np.count_nonzero(there)
    return parts


def fewest(parts: Real, target: float) -> Integer:
    """Fewest triangles whose parts sum to `target`, by number, ascending.

    There is at least one.
    """
    order = np.argsort(-parts, kind="stable")
    return np.sort(order[: int(np.searchsorted(np.cumsum(parts[order]), target)) + 1])


def _kept(before: Domain, after: Domain, order: int, exponents: Real) -> Real:
    """Predicted fraction that each triangle keeps of its parent's part, (triangle,)."""
    area, whole = areas(after.p, after.t), areas(before.p, before.t)
    of_corners = np.append(exponents, np.inf)[np.minimum(after.t, len(exponents))].min(axis=0)
    return np.minimum(area / whole[after.pixel], 1.0) ** np.minimum(of_corners, order + 1)

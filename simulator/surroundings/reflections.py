"""Conducting planes that face a skin, as images of the skin's charges.

A layer of relative permittivity e and thickness h that begins at a sheet and ends at the plane
reflects a field exp(-k z) by -(b + exp(-2kh)) / (1 + b exp(-2kh)) with b = (e - 1)/(e + 1). This is
the series of images below; for e = 1 it is the one mirror image.

Between two planes with the reflections A at z = 0 and B at z = d, the field of all further
reflections is that of A X / (1 - X), B X / (1 - X) and X / (1 - X), X = A B exp(-2kd). Its images
are far and many. Fewer at given depths c have nearly the same field: the sums of w exp(-kc) are
fitted for all k that a skin has.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..arrays import Real
from ..scene.foam import VACUUM_PERMITTIVITY
from ..scene.surroundings import Body

MIN_IMAGE_WEIGHT = 1e-3
"""Smallest weight of an image: the rest of a series of weights b^n is at most as large."""
Image = tuple[float, float, float]
ITSELF: Image = (1.0, 0.0, 1.0)
DEEPEST, NEAR = 100.0, 8.0
"""Depth of the last images between two planes over the skin's size, and depth over the distance of
the planes up to which each has all images by a layer."""
FITTED, LOWEST, HIGHEST, POINTS, ROUNDING = 8, 0.01, 15.0, 8, 1e-9
DEEPEST_FIT = 10.0
"""Of the fit for layers that are not air: number of depths, smallest k times 2H and largest times
d, number of k for each depth, and smallest singular value."""


class Layer(NamedTuple):
    """Layer between a sheet and the plane that faces it: thickness in m, and permittivity."""

    thickness: float
    permittivity: float

    @property
    def per_area(self) -> float:
        """Capacitance between the sheet and the plane, F/m²."""
        return VACUUM_PERMITTIVITY * self.permittivity / self.thickness

    @property
    def step(self) -> float:
        """b = (e - 1) / (e + 1)."""
        return (self.permittivity - 1) / (self.permittivity + 1)

    @property
    def mirror(self) -> float:
        """Depth in m of the one image, of weight -1, that is seen from afar."""
        return 2 * self.thickness / self.permittivity

    def reflection(self, k: Real) -> Real:
        """Reflection of fields exp(-k z). k: 1/m."""
        there = np.exp(-2 * k * self.thickness)
        return -(self.step + there) / (1 + self.step * there)


def layer(body: Body) -> Layer:
    """Layer in front of a body; a body given by its capacitance is assumed to be in air."""
    if body.distance is not None:
        return Layer(body.distance, body.relative_permittivity)
    return Layer(VACUUM_PERMITTIVITY / body.per_area, 1.0)


def images(
    below: Layer | None, above: Layer | None = None, thickness: float = 0.0, size: float = 0.0
) -> Real:
    """Images of charges along z: sign, shift in m and weight, shape (image, 3).

    The charges themselves come first. They are used as in `influence_kernel.fill_influence`. The
    layer below begins at z = 0, that above at the thickness of the foam. size: longest distance on
    the skin, m. Thickness and size count between two planes only.
    """
    once = [(-1.0, -depth, weight) for depth, weight in _series(below)] if below else []
    if above:
        once += [(-1.0, 2 * thickness + depth, weight) for depth, weight in _series(above)]
    further = _further(once, below, above, thickness, size) if below and above else []
    return np.array([ITSELF, *once, *further])


def _further(
    once: list[Image], below: Layer, above: Layer, thickness: float, size: float
) -> list[Image]:
    """Images by more than one reflection between two planes. once: those by one reflection.

    With H = d + h / e of both layers, X is exp(-2kH) for small k, and in air for all. These images
    are at 2H, 4H, ...: half of each charge goes with the mirrors before it, half with those behind,
    so that sums over them converge fast. The rest of X / (1 - X) vanishes at k = 0 and is fitted.
    """
    step = 2 * thickness + below.mirror + above.mirror
    mirrors = [(-1.0, -below.mirror, -1.0), (-1.0, 2 * thickness + above.mirror, -1.0)]
    near = NEAR * (thickness + below.thickness + above.thickness)
    found = [(1.0, step, 0.5), (1.0, -step, 0.5)]
    for number, own in _grouped(DEEPEST * size / step):
        depth = number * step
        for shift in (depth, depth + step):
            found += [(1.0, shift, own / 2), (1.0, -shift, own / 2)]
        found += _behind(depth, own, once if depth < near else mirrors)
    if below.step or above.step:
        for depth, own in _fitted(below, above, thickness, step):
            found += [(1.0, depth, own), (1.0, -depth, own), *_behind(depth, own, once)]
    return found


def _behind(depth: float, weight: float, images: list[Image]) -> list[Image]:
    """Images that are farther away by a depth, with a weight."""
    return [
        (sign, shift + (depth if shift > 0 else -depth), weight * own)
        for sign, shift, own in images
    ]


def _series(layer: Layer) -> list[tuple[float, float]]:
    """Depth in m behind a layer's begin, and weight, of each image by one plane.

    The last one has the weights of those that are left out: all have the charge -1.
    """
    b = layer.step
    found = [(0.0, -b)] if b else []
    weight, depth = b * b - 1, 2 * layer.thickness
    while abs(weight) > MIN_IMAGE_WEIGHT:
        found.append((depth, weight))
        weight, depth = -b * weight, depth + 2 * layer.thickness
    depth, weight = found[-1]
    return [*found[:-1], (depth, weight - 1 - sum(own for _, own in found))]


def _fitted(below: Layer, above: Layer, thickness: float, step: float) -> list[tuple[float, float]]:
    """Depths in m and weights of exp(-kc) whose sum is X / (1 - X) less that for mirrors alone."""
    depths = np.geomspace(2 * thickness, DEEPEST_FIT * step, FITTED)
    k = np.geomspace(LOWEST / step, HIGHEST / thickness, POINTS * FITTED)
    X = below.reflection(k) * above.reflection(k) * np.exp(-2 * k * thickness)
    rest = X / (1 - X) + np.exp(-k * step) / np.expm1(-k * step)
    weights = np.linalg.lstsq(np.exp(-np.outer(k, depths)), rest, rcond=ROUNDING)[0]
    return list(zip(depths.tolist(), weights.tolist(), strict=True))


def _grouped(last: float) -> list[tuple[float, float]]:
    """Places and weights for sums over the whole numbers from 1 to about `last`.

    Groups of more than two numbers have two places each, with their mean and variance.
    """
    found, first = list[tuple[float, float]](), 1
    while first <= last:
        count = max(1, first // 2)
        mean, root = first + (count - 1) / 2, ((count**2 - 1) / 12) ** 0.5
        sides = (-root, root) if count > 1 else (0.0,)
        found += [(mean + side, count / len(sides)) for side in sides]
        first += count
    return found

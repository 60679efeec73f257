"""Where rays enter MuJoCo's geoms: spheres, ellipsoids, capsules, cylinders and boxes."""

from __future__ import annotations

import numpy as np

from ..arrays import Real


def entry(kind: str, size: Real, origins: Real, directions: Real) -> Real:
    """Distance along each ray at which it enters a convex geom, inf if it misses; shape (n,).

    It is negative if the ray begins inside. kind: "sphere", "ellipsoid", "capsule", "cylinder" or
    "box", of a size as MuJoCo has it. origins, directions: in the geom's frame, (3, n); directions
    have length 1.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        if kind == "plane":
            return np.where(directions[2] < 0, -origins[2] / directions[2], np.inf)
        if kind in ("sphere", "ellipsoid"):
            axes = np.full(3, size[0]) if kind == "sphere" else size
            return _sphere(origins / axes[:, None], directions / axes[:, None])
        if kind == "box":
            return _entered(*(_slab(origins[k], directions[k], size[k]) for k in range(3)))
        along = _slab(origins[2], directions[2], size[1])
        wall = _entered(_wall(size[0], origins, directions), along)
        if kind == "cylinder":
            return wall
        ends = [np.array([[0.0], [0.0], [side * size[1]]]) for side in (-1, 1)]
        balls = [_sphere((origins - end) / size[0], directions / size[0]) for end in ends]
        return np.minimum(wall, np.minimum(*balls))


def _sphere(origins: Real, directions: Real) -> Real:
    """Entry into the unit sphere around 0."""
    a, b, c = _products(origins, directions)
    return _entered(_roots(a, b, c - 1))


def _wall(radius: float, origins: Real, directions: Real) -> tuple[Real, Real]:
    """Entry to and exit from an infinite cylinder around z."""
    a, b, c = _products(origins[:2], directions[:2])
    start, stop = _roots(a, b, c - radius**2)
    parallel = a < 1e-24
    inside = np.where(c <= radius**2, np.inf, np.nan)
    return np.where(parallel, -inside, start), np.where(parallel, inside, stop)


def _products(origins: Real, directions: Real) -> tuple[Real, Real, Real]:
    pairs = ((directions, directions), (origins, directions), (origins, origins))
    a, b, c = (np.einsum("kn,kn->n", p, q) for p, q in pairs)
    return a, b, c


def _roots(a: Real, b: Real, c: Real) -> tuple[Real, Real]:
    """Roots of a t² + 2 b t + c, NaN if there are none."""
    root = np.sqrt(b * b - a * c)
    return (-b - root) / a, (-b + root) / a


def _slab(origins: Real, directions: Real, half: float) -> tuple[Real, Real]:
    """Entry to and exit from the space between two planes at ± half; NaN for a ray outside it."""
    ends = (-half - origins) / directions, (half - origins) / directions
    return np.minimum(*ends), np.maximum(*ends)


def _entered(*spans: tuple[Real, Real]) -> Real:
    """Entry into the intersection of convex bodies from entries and exits of each."""
    start = np.max([first for first, _ in spans], axis=0)
    stop = np.min([last for _, last in spans], axis=0)
    return np.where(start <= stop, start, np.inf)

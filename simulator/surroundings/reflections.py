"""Conducting plane that faces a skin, as images of the skin's charges.

A layer of relative permittivity e and thickness h that begins at a sheet and ends at the plane
reflects a field exp(-k z) by -(b + exp(-2kh)) / (1 + b exp(-2kh)) with b = (e - 1)/(e + 1). This is
the series of images below; for e = 1 it is the one mirror image.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..arrays import Real
from ..scene.foam.foam import VACUUM_PERMITTIVITY
from ..scene.surroundings import Body

MIN_IMAGE_WEIGHT = 1e-3
"""Smallest weight of an image: the rest of a series of weights b^n is at most as large."""
ITSELF = (1.0, 0.0, 1.0)


class Layer(NamedTuple):
    """Layer between the bottom sheet and the plane below: thickness in m, and permittivity."""

    thickness: float
    permittivity: float

    @property
    def per_area(self) -> float:
        """Capacitance between the sheet and the plane, F/m²."""
        return VACUUM_PERMITTIVITY * self.permittivity / self.thickness


def layer(body: Body) -> Layer:
    """Layer in front of a body; a body given by its capacitance is assumed to be in air."""
    if body.distance is not None:
        return Layer(body.distance, body.relative_permittivity)
    return Layer(VACUUM_PERMITTIVITY / body.per_area, 1.0)


def images(layer: Layer | None) -> Real:
    """Images of charges along z: sign, shift in m and weight, shape (image, 3).

    The charges themselves come first. They are used as in `influence_kernel.fill_influence`; the
    layer begins at z = 0.
    """
    found = [ITSELF]
    if layer is not None:
        b = (layer.permittivity - 1) / (layer.permittivity + 1)
        found += [(-1.0, 0.0, -b)] if b else []
        weight, depth = b * b - 1, 2 * layer.thickness
        while abs(weight) > MIN_IMAGE_WEIGHT:
            found.append((-1.0, -depth, weight))
            weight, depth = -b * weight, depth + 2 * layer.thickness
    return np.array(found)

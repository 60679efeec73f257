"""The foam's law of one strain or pressure, compiled; see `foam_tables` for its numbers."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...compiled import compiled
from ...scene.foam.foam_mechanics import DENSIFICATION

LINEAR_BELOW = 1e-6
"""Difference of strains below which the mean pressure between them is that of their middle."""
MAX_STEPS = 200
CONVERGED = 1e-12


@compiled()
def stress(law: NDArray, strain: float) -> float:  # pragma: no cover
    """Pressure at a strain from 0 to the largest, Pa."""
    if law[0] == 0.0:
        return law[1] * strain
    r = strain / law[3]
    return law[2] * (-np.expm1(-law[1] * strain / law[2]) + r * r / (1 - r) / DENSIFICATION)


@compiled()
def energy(law: NDArray, strain: float) -> float:  # pragma: no cover
    """Integral of the pressure from zero strain, J per m³ of uncompressed foam."""
    if law[0] == 0.0:
        return law[1] * strain * strain / 2
    r = strain / law[3]
    buckled = strain + np.expm1(-law[1] * strain / law[2]) * law[2] / law[1]
    closed = law[3] * (-r - r * r / 2 - np.log1p(-r)) / DENSIFICATION
    return law[2] * (buckled + closed)


@compiled()
def mean_stress(law: NDArray, low: float, high: float) -> float:  # pragma: no cover
    """Mean pressure over the strains between two, Pa."""
    if high - low < LINEAR_BELOW:
        return stress(law, (low + high) / 2)
    return (energy(law, high) - energy(law, low)) / (high - low)


@compiled()
def rise_at(law: NDArray, relative: NDArray, strain: float) -> float:  # pragma: no cover
    """Rise of c at a strain over the unpressed c, from the table `relative`."""
    last = len(relative) - 1
    at = strain / law[4] * last
    k = min(int(at), last - 1)
    return (relative[k] + (at - k) * (relative[k + 1] - relative[k])) / (1 - strain) - 1


@compiled()
def strain_under(law: NDArray, strains: NDArray, pressure: float) -> float:  # pragma: no cover
    """Strain under a pressure up to that of the largest strain, from the table `strains`."""
    if law[0] == 0.0:
        return pressure / law[1]
    last = len(strains) - 1
    at = np.log1p(pressure / law[7]) / np.log1p(law[6] / law[7]) * last
    k = min(int(at), last - 1)
    return strains[k] + (at - k) * (strains[k + 1] - strains[k])


@compiled()
def edge_strain(
    law: NDArray, strain: float, radius: float, curvature: float
) -> float:  # pragma: no cover
    """Strain at the edge of the patch under a spherical indenter; `strain` is that in its middle.

    radius: of the indenter, m; the patch is smaller if the foam leaves the sphere earlier.
    """
    return max(strain - radius * radius / (2 * curvature * law[5]), 0.0)


@compiled()
def patch_radius(
    law: NDArray, strain: float, radius: float, curvature: float
) -> float:  # pragma: no cover
    """Radius of the patch under a spherical indenter, m."""
    return min(radius, np.sqrt(2 * curvature * strain * law[5]))


@compiled()
def indenter_force(
    law: NDArray, strain: float, radius: float, curvature: float
) -> float:  # pragma: no cover
    """Force of a spherical indenter on a Winkler foundation at a strain under its middle, N.

    The area of the patch times the mean pressure over the strains under it: 2 pi R d times the
    energy between the strains in the middle and at the edge, which is pi R k depth² for a linear
    foundation of stiffness k per area (K. L. Johnson, Contact Mechanics, 1985, 4.3).
    """
    patch = patch_radius(law, strain, radius, curvature)
    low = edge_strain(law, strain, radius, curvature)
    return np.pi * patch * patch * mean_stress(law, low, strain)


@compiled()
def indenter_strain(
    law: NDArray, force: float, radius: float, curvature: float
) -> float:  # pragma: no cover
    """Inverse of `indenter_force`, by Newton steps within a bracket; at most the largest strain."""
    low, high = 0.0, law[4]
    if force >= indenter_force(law, high, radius, curvature):
        return high
    if force <= 0.0:
        return 0.0
    at = high / 2
    for _ in range(MAX_STEPS):
        excess = indenter_force(law, at, radius, curvature) - force
        if excess > 0:
            high = at
        else:
            low = at
        slope = _force_slope(law, at, radius, curvature)
        step = at - excess / slope
        if not low < step < high:
            step = (low + high) / 2
        if abs(step - at) <= CONVERGED:
            return step
        at = step
    return at


@compiled()
def _force_slope(
    law: NDArray, strain: float, radius: float, curvature: float
) -> float:  # pragma: no cover
    """Derivative of `indenter_force` by the strain: 2 pi R d (p in the middle - p at the edge)."""
    low = edge_strain(law, strain, radius, curvature)
    if strain - low < LINEAR_BELOW:
        half = LINEAR_BELOW / 2
        ahead, behind = min(strain + half, law[4]), max(strain - half, 0.0)
        slope = (stress(law, ahead) - stress(law, behind)) / (ahead - behind)
        return np.pi * radius * radius * slope
    return 2 * np.pi * curvature * law[5] * (stress(law, strain) - stress(law, low))

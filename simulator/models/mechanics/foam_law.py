"""The foam's law as numbers and tables for kernels, and the law itself, compiled.

`scene.foam_mechanics` states the law for arrays; tests compare the two.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...arrays import Real
from ...compiled import compiled
from ...scene.foam import Foam
from ...scene.foam_mechanics import DENSIFICATION, Elastomer, strains_under

STRAINS = 8192
PRESSURES = 8192
STRESSES = 4096
SMALL = 0.02
"""Pressure below which the table of pressures is linear and above which it is logarithmic, over the
plateau stress."""

LINEAR_BELOW = 1e-6
"""Difference of strains below which the mean pressure between them is that of their middle."""
MAX_STEPS = 200
CONVERGED = 1e-12


class FoamTables(NamedTuple):
    """Law of one foam, as kernels take it.

    elastomer: False for Hooke's law. modulus, plateau: Pa. densified: densification strain.
    greatest: largest strain. thickness: m. closed: pressure at the largest strain, Pa. relative: c
    times the thickness over its unpressed value, at equidistant strains from 0 to the largest.
    strains: at pressures equidistant in log(1 + p / scale); scale: Pa. stresses: Pa, at equidistant
    strains from 0 to the largest, for what is evaluated at very many nodes.
    """

    elastomer: bool
    modulus: float
    plateau: float
    densified: float
    greatest: float
    thickness: float
    closed: float
    scale: float
    relative: Real
    strains: Real
    stresses: Real

    @property
    def deepest(self) -> float:
        """Largest indentation, m."""
        return self.greatest * self.thickness

    def strains_under(self, pressure: Real) -> Real:
        """Strains under pressures in Pa, shape (...); at most the largest strain."""
        at = np.log1p(pressure / self.scale) / np.log1p(self.closed / self.scale)
        return np.interp(at, np.linspace(0.0, 1.0, len(self.strains)), self.strains)


def foam_tables(foam: Foam, highest: float = np.inf) -> FoamTables:
    """Law of a foam up to a factor on c. Without mechanics it is for depths alone.

    Without a thickness as well, its thickness is 0.
    """
    greatest, thickness = float(foam.greatest_strain), float(foam.thickness or 0.0)
    if np.isfinite(highest):
        greatest = min(greatest, float(foam.strain_at(np.array(highest))))
    at = np.linspace(0.0, greatest, STRAINS)
    relative = foam.factor_at(at) * (1 - at)
    if foam.mechanics is None:
        none = np.zeros(2)
        law = False, 0.0, 1.0, 1.0, greatest, thickness, 0.0, 1.0
        return FoamTables(*law, relative, none, none)
    elastic = foam.mechanics.elastic
    own = (False, elastic.modulus, elastic.modulus * greatest, 1.0)
    if isinstance(elastic, Elastomer):
        own = True, elastic.modulus, elastic.plateau_stress, elastic.densification_strain
    closed, scale = float(elastic.stress(np.array(greatest))), SMALL * own[2]
    pressure = scale * np.expm1(np.linspace(0.0, np.log1p(closed / scale), PRESSURES))
    strains = strains_under(elastic, pressure)
    stresses = elastic.stress(np.linspace(0.0, greatest, STRESSES))
    return FoamTables(*own, greatest, thickness, closed, scale, relative, strains, stresses)


@compiled()
def stress(foam: FoamTables, strain: float) -> float:
    """Pressure at a strain from 0 to the largest, Pa."""
    if not foam.elastomer:
        return foam.modulus * strain
    r = strain / foam.densified
    return foam.plateau * (
        -np.expm1(-foam.modulus * strain / foam.plateau) + r * r / (1 - r) / DENSIFICATION
    )


@compiled()
def energy(foam: FoamTables, strain: float) -> float:
    """Integral of the pressure from zero strain, J per m³ of uncompressed foam."""
    if not foam.elastomer:
        return foam.modulus * strain * strain / 2
    r = strain / foam.densified
    buckled = strain + np.expm1(-foam.modulus * strain / foam.plateau) * foam.plateau / foam.modulus
    closed = foam.densified * (-r - r * r / 2 - np.log1p(-r)) / DENSIFICATION
    return foam.plateau * (buckled + closed)


@compiled()
def mean_stress(foam: FoamTables, low: float, high: float) -> float:
    """Mean pressure over the strains between two, Pa."""
    if high - low < LINEAR_BELOW:
        return stress(foam, (low + high) / 2)
    return (energy(foam, high) - energy(foam, low)) / (high - low)


@compiled()
def rise_at(foam: FoamTables, strain: float) -> float:
    """Rise of c at a strain over the unpressed c."""
    last = len(foam.relative) - 1
    at = strain / foam.greatest * last
    k = min(int(at), last - 1)
    return (foam.relative[k] + (at - k) * (foam.relative[k + 1] - foam.relative[k])) / (
        1 - strain
    ) - 1


@compiled()
def strain_under(foam: FoamTables, pressure: float) -> float:
    """Strain under a pressure up to that of the largest strain."""
    if not foam.elastomer:
        return pressure / foam.modulus
    last = len(foam.strains) - 1
    at = np.log1p(pressure / foam.scale) / np.log1p(foam.closed / foam.scale) * last
    k = min(int(at), last - 1)
    return foam.strains[k] + (at - k) * (foam.strains[k + 1] - foam.strains[k])


@compiled()
def edge_strain(foam: FoamTables, strain: float, radius: float, curvature: float) -> float:
    """Strain at the edge of the patch under a spherical indenter; `strain` is that in its middle.

    radius: of the indenter, m; the patch is smaller if the foam leaves the sphere earlier.
    """
    return max(strain - radius * radius / (2 * curvature * foam.thickness), 0.0)


@compiled()
def patch_radius(foam: FoamTables, strain: float, radius: float, curvature: float) -> float:
    """Radius of the patch under a spherical indenter, m."""
    return min(radius, np.sqrt(2 * curvature * strain * foam.thickness))


@compiled()
def indenter_force(foam: FoamTables, strain: float, radius: float, curvature: float) -> float:
    """Force of a spherical indenter on a Winkler foundation at a strain under its middle, N.

    The area of the patch times the mean pressure over the strains under it: 2 pi R d times the
    energy between the strains in the middle and at the edge, which is pi R k depth² for a linear
    foundation of stiffness k per area (K. L. Johnson, Contact Mechanics, 1985, 4.3).
    """
    patch = patch_radius(foam, strain, radius, curvature)
    low = edge_strain(foam, strain, radius, curvature)
    return np.pi * patch * patch * mean_stress(foam, low, strain)


@compiled()
def indenter_strain(foam: FoamTables, force: float, radius: float, curvature: float) -> float:
    """Inverse of `indenter_force`, by Newton steps within a bracket; at most the largest strain."""
    low, high = 0.0, foam.greatest
    if force >= indenter_force(foam, high, radius, curvature):
        return high
    if force <= 0.0:
        return 0.0
    at = high / 2
    for _ in range(MAX_STEPS):
        excess = indenter_force(foam, at, radius, curvature) - force
        if excess > 0:
            high = at
        else:
            low = at
        slope = _force_slope(foam, at, radius, curvature)
        step = at - excess / slope
        if not low < step < high:
            step = (low + high) / 2
        if abs(step - at) <= CONVERGED:
            return step
        at = step
    return at


@compiled()
def _force_slope(foam: FoamTables, strain: float, radius: float, curvature: float) -> float:
    """Derivative of `indenter_force` by the strain: 2 pi R d (p in the middle - p at the edge)."""
    low = edge_strain(foam, strain, radius, curvature)
    if strain - low < LINEAR_BELOW:
        half = LINEAR_BELOW / 2
        ahead, behind = min(strain + half, foam.greatest), max(strain - half, 0.0)
        slope = (stress(foam, ahead) - stress(foam, behind)) / (ahead - behind)
        return np.pi * radius * radius * slope
    return 2 * np.pi * curvature * foam.thickness * (stress(foam, strain) - stress(foam, low))

"""Fit of the nearest passive network to a spectrum: a Kramers-Kronig test.

Every linear, causal and stable system obeys the Kramers-Kronig relations, and so does every sum of
such networks. A fit by such a sum therefore tests the data: no network explains what it cannot
follow (P. Agarwal, M. E. Orazem, L. H. Garcia-Rubio, J. Electrochem. Soc. 139, 1917, 1992;
B. A. Boukamp, J. Electrochem. Soc. 142, 1885, 1995). Residues >= 0 make the network passive too.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...arrays import Complex, Mask, Real
from ..errors import ToleranceError

INDUCTANCE = 1
"""Place of L among the terms of a network."""
PER_DECADE = 20
MARGIN = 100.0
"""Factor by which the time constants extend beyond those of the lowest and highest frequency."""
REFINEMENT = 8
"""Number of parts of each grid step next to a pole in the second fit."""
RESOLUTION = 3e-5
"""Relative error of Z by the grid of time constants, for an exact spectrum."""


@dataclass(frozen=True)
class MeasurementModel:
    """Z(s) = R + s L + 1/(s C) + sum of r/(1 + s tau), every term >= 0.

    resistance: ohm. inductance: H. elastance: 1/C in 1/F. residues: ohm, one for each of `tau`.
    tau: s, ascending.
    """

    resistance: float
    inductance: float
    elastance: float
    residues: Real
    tau: Real

    @property
    def parameters(self) -> int:
        """Number of non-zero terms."""
        terms = [self.resistance, self.inductance, self.elastance, *self.residues]
        return int(np.count_nonzero(terms))

    def impedance(self, frequency: Real) -> Complex:
        """Z in ohm. frequency: Hz."""
        terms = [self.resistance, self.inductance, self.elastance, *self.residues]
        return _basis(frequency, self.tau) @ np.array(terms)

    def residual(self, Z: Complex, frequency: Real) -> Complex:
        """(Z - model)/|Z|. Z: ohm. frequency: Hz."""
        return (Z - self.impedance(frequency)) / np.abs(Z)


def fit_passive(Z: Complex, frequency: Real) -> MeasurementModel:
    """The passive network nearest to a spectrum, by least squares of the relative error of Z.

    Z: ohm, nowhere 0, shape (frequency,). frequency: Hz, ascending.
    Raises ToleranceError if the least squares do not converge.
    """
    coarse = _time_constants(frequency)
    poles = _fit_on(coarse, Z, frequency).residues > 0
    return _fit_on(_refined(coarse, poles), Z, frequency)


def distance_from_rc(Z: Complex, frequency: Real) -> float:
    """Root mean square relative distance of Z from the nearest passive RC network, to about 1e-4.

    Inductance is left out, which would hide that a spectrum is not causal. Z, frequency, errors: as
    for `fit_passive`.
    """
    network = _fit_on(_time_constants(frequency), Z, frequency, inductive=False)
    return float(np.sqrt(np.mean(np.abs(network.residual(Z, frequency)) ** 2)))


def _fit_on(tau: Real, Z: Complex, frequency: Real, *, inductive: bool = True) -> MeasurementModel:
    from scipy.optimize import nnls

    relative = _basis(frequency, tau) / np.abs(Z)[:, None]
    relative[:, INDUCTANCE] *= inductive
    columns, wanted = _stacked(relative), _stacked(Z / np.abs(Z))
    lengths = np.maximum(np.linalg.norm(columns, axis=0), np.finfo(float).tiny)
    try:
        scaled, _ = nnls(columns / lengths, wanted)
    except RuntimeError as error:
        raise ToleranceError(f"the nearest passive network was not found: {error}") from error
    resistance, inductance, elastance, *residues = (scaled / lengths).tolist()
    return MeasurementModel(resistance, inductance, elastance, np.array(residues), tau)


def _time_constants(frequency: Real) -> Real:
    shortest = 1 / (2 * np.pi * frequency[-1] * MARGIN)
    longest = MARGIN / (2 * np.pi * frequency[0])
    points = 1 + int(np.ceil(PER_DECADE * np.log10(longest / shortest)))
    return np.geomspace(shortest, longest, points)


def _refined(tau: Real, poles: Mask) -> Real:
    """The grid with additional points around every pole, up to its neighbours."""
    fractions = np.arange(1 - REFINEMENT, REFINEMENT) / REFINEMENT
    around = tau[poles, None] * (tau[1] / tau[0]) ** fractions
    return np.unique(np.concatenate([tau[~poles], around.ravel()]))


def _basis(frequency: Real, tau: Real) -> Complex:
    """R, L, 1/C and every pole at unit strength; shape (frequency, 3 + tau)."""
    s = 2j * np.pi * frequency[:, None]
    return np.hstack([np.ones_like(s), s, 1 / s, 1 / (1 + s * tau)]).astype(np.complex128)


def _stacked(values: Complex) -> Real:
    return np.concatenate([values.real, values.imag])

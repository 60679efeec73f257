"""Fisher information of sweeps, with the meter's errors and an uncertain skin as unknowns."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..arrays import Complex, Real
from ..measure.readout import ErrorModel, Unpressed, errors_of, observed_slope
from ..scene.parts import Meter, Setup, Skin

RIDGE = 1e-12
"""Added to the information, scaled to a unit diagonal; smaller information counts as none."""


def summed(slopes: Real) -> Real:
    """Information of each frequency, shape (case, frequency, p, p).

    slopes: over the meter's noise, shape (case, interface, frequency, 2, p).
    """
    return np.einsum("cifqa,cifqb->cfab", slopes, slopes, optimize=True)


def covariances(information: Real, wanted: int) -> Real:
    """Bound on the covariance of the first `wanted` unknowns, shape (..., wanted, wanted).

    information: with priors, shape (..., p, p). An unknown without any information has an infinite
    variance.
    """
    diagonal = np.diagonal(information, axis1=-2, axis2=-1)
    none = diagonal <= 0
    scale = np.where(none, 1.0, np.sqrt(np.maximum(diagonal, 0.0)))
    scales = scale[..., :, None] * scale[..., None, :]
    ridge = RIDGE + np.where(none, 1.0, 0.0)
    inverse = np.linalg.inv(information / scales + _on_diagonal(ridge))
    found = (inverse / scales)[..., :wanted, :wanted]
    return found + _on_diagonal(np.where(none, np.inf, 0.0)[..., :wanted])


def variances(information: Real, wanted: int) -> Real:
    """The diagonals of `covariances`, shape (..., wanted)."""
    return np.diagonal(covariances(information, wanted), axis1=-2, axis2=-1)


def _on_diagonal(values: Real) -> Real:
    found = np.zeros((*values.shape, values.shape[-1]))
    along = np.arange(values.shape[-1])
    found[..., along, along] = values
    return found


def error_model(
    setup: Setup,
    meter: Meter,
    frequency: Real,
    against_rest: int = 0,
    unpressed: Unpressed | None = None,
) -> ErrorModel:
    """Error model of a sweep of a scene with all interfaces at all frequencies, Hz.

    It is evaluated at the reading of the unpressed skin, see `errors_of`. Raises InputError for a
    meter without noise.
    """
    every = tuple(each.model_copy(update={"frequencies": None}) for each in setup.interfaces)
    reading = Setup(every, frequency, setup.leads)
    return errors_of(reading, meter, against_rest, unpressed=unpressed)


def in_noise(Z: Complex, slopes: Sequence[Complex], model: ErrorModel) -> Real:
    """Slopes of ln |Z| and phase over the noise, shape (interface, frequency, 2, slope).

    They are 0 where nothing is read.
    """
    shape = 2, *model.read.shape
    columns = [observed_slope(Z, dZ).reshape(shape) / _deviation(model) for dZ in slopes]
    return np.moveaxis(np.stack(columns, axis=-1), 0, 2)


def session_errors(model: ErrorModel) -> tuple[Real, Real]:
    """Slopes by gain and phase error of each interface, (interface, frequency, 2, unknown).

    An unknown is the error at the reading where it is largest. Also returns 1/deviation² of each
    unknown. There are none where these errors cancel.
    """
    largest = model.accuracy.max(axis=(1, 2))
    quantities = np.flatnonzero(largest > 0).tolist()
    unknown = [(i, q) for i in range(len(model.read)) for q in quantities]
    slopes = np.zeros((*model.read.shape, 2, len(unknown)))
    deviation = _deviation(model)
    for number, (i, q) in enumerate(unknown):
        slopes[i, :, q, number] = model.accuracy[q, i] / largest[q] / deviation[q, i]
    return slopes, np.array([largest[q] ** -2 for _, q in unknown])


def _deviation(model: ErrorModel) -> Real:
    """Standard deviation of each reading, infinite for none, shape (2, interface, frequency)."""
    return np.where(model.values, model.noise, np.inf)


def pixel_maps(skin: Skin, cells: int) -> dict[str, Real]:
    """Map of each pixel on a grid with `cells` along each of its sides, (row, column) of cells."""
    rows, columns = skin.pixels.rows, skin.pixels.columns
    units = np.eye(rows * columns).reshape(-1, rows, columns)
    return {
        f"foam {k}": np.kron(unit, np.ones((cells, cells))).astype(np.float64)
        for k, unit in enumerate(units)
    }

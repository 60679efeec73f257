"""Fisher information of sweeps, with the meter's errors and an uncertain skin as unknowns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from ..arrays import Complex, Integer, Real
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


def _on_diagonal(values: Real) -> Real:
    found = np.zeros((*values.shape, values.shape[-1]))
    along = np.arange(values.shape[-1])
    found[..., along, along] = values
    return found


LowerTriangle = Mapping[tuple[int, int], Real]
"""Entries of symmetric matrices by (row, column), row >= column, each of shape (...)."""
NUMBERS_AT_ONCE = 4_000_000


def lower_triangle(found: Real) -> LowerTriangle:
    """Lower triangle of matrices of shape (..., p, p)."""
    return {(a, b): found[..., a, b] for a in range(found.shape[-1]) for b in range(a + 1)}


def remaining(found: LowerTriangle, known: Sequence[float], kept: int) -> LowerTriangle:
    """Information on the first `kept` unknowns, with the others marginalized.

    Eliminates the others one by one (Schur complements), for all cases at once. known: prior
    information on each unknown.
    """
    left = {(a, b): entry + known[a] if a == b else entry for (a, b), entry in found.items()}
    for last in range(len(known) - 1, kept - 1, -1):
        for a in range(last):
            share = left[last, a] / left[last, last]
            for b in range(a + 1):
                left[a, b] = left[a, b] - share * left[last, b]
    return {place: left[place] for place in left if place[0] < kept}


def variances(found: LowerTriangle, known: Sequence[float], wanted: int) -> Real:
    """Diagonals of `covariances` with this prior, fast for many; wanted: 1 or 2."""
    diagonal = [found[a, a] + known[a] for a in range(len(known))]
    scaled = [np.where(each > 0, (1 + RIDGE) * each, 1.0) for each in diagonal]
    left = remaining(
        {(a, b): scaled[a] if a == b else entry for (a, b), entry in found.items()},
        np.zeros(len(known)).tolist(),
        wanted,
    )
    if wanted == 1:
        each = [1 / left[0, 0]]
    else:
        size = left[0, 0] * left[1, 1] - left[1, 0] ** 2
        each = [left[1, 1] / size, left[0, 0] / size]
    none = np.stack(diagonal[:wanted], axis=-1) <= 0
    return np.where(none, np.inf, np.stack(each, axis=-1))


class SummedInformation:
    """Candidates whose information adds up, shape (case, candidate, p, p), symmetric."""

    def __init__(self, information: Real) -> None:
        cases, self._candidates, p, _ = information.shape
        self._shape = -1, cases
        self._lower = np.tril_indices(p)
        self._place = np.empty((p, p), dtype=np.int64)
        """Index of each entry of a matrix in its lower triangle, shape (p, p)."""
        self._place[self._lower] = self._place.T[self._lower] = range(len(self._lower[0]))
        entries = information.transpose(2, 3, 1, 0)[self._lower]
        self._entries = np.ascontiguousarray(entries.swapaxes(0, 1)).reshape(self._candidates, -1)
        """Entries of the lower triangles of all cases, shape (candidate, entry * case)."""

    def of(self, choices: Integer) -> Iterator[LowerTriangle]:
        """Information of choices, shape (choice, n), some at a time: entries (choice, case)."""
        rows, columns = (each.tolist() for each in self._lower)
        step = max(1, NUMBERS_AT_ONCE // max(self._entries.shape[1], 1))
        for part in (choices[k : k + step] for k in range(0, len(choices), step)):
            times = np.zeros((len(part), self._candidates))
            np.add.at(times, (np.arange(len(part))[:, None], part), 1.0)
            found = (times @ self._entries).reshape(len(part), *self._shape)
            yield dict(zip(zip(rows, columns, strict=True), found.swapaxes(0, 1), strict=True))

    def at(self, weights: Real) -> Real:
        """Information at weights of the candidates, shape (case, p, p)."""
        return np.moveaxis((weights @ self._entries).reshape(self._shape)[self._place], -1, 0)

    def slope(self, by: Real) -> Real:
        """Derivatives by the weights from those by the information, (case, p, p)."""
        rows, columns = self._lower
        both = np.where(rows == columns, 1.0, 2.0)[:, None]
        return self._entries @ (both * by.transpose(1, 2, 0)[self._lower]).ravel()


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

"""Fisher information, with unknowns marginalized, and its sum over chosen candidates."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from ..arrays import Integer, Real

RIDGE = 1e-12
"""Added to the information, scaled to a unit diagonal; smaller information counts as none."""


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


def remaining(found: LowerTriangle, kept: int) -> LowerTriangle:
    """Information on the first `kept` unknowns, with the others marginalized.

    Eliminates the others one by one (Schur complements), for all cases at once. found: with priors.
    """
    left = dict(found)
    for last in range(max(found)[0], kept - 1, -1):
        for a in range(last):
            share = left[last, a] / left[last, last]
            for b in range(a + 1):
                left[a, b] = left[a, b] - share * left[last, b]
    return {place: left[place] for place in left if place[0] < kept}


def variances(found: LowerTriangle, wanted: int) -> Real:
    """Diagonals of `covariances`, fast for many; wanted: 1 or 2."""
    diagonal = [found[a, a] for a in range(max(found)[0] + 1)]
    scaled = [np.where(each > 0, (1 + RIDGE) * each, 1.0) for each in diagonal]
    whole = {(a, b): scaled[a] if a == b else entry for (a, b), entry in found.items()}
    left = remaining(whole, wanted)
    own = [np.maximum(left[a, a], RIDGE * scaled[a]) for a in range(wanted)]
    each = [1 / own[0]]
    if wanted == 2:
        size = np.maximum(own[0] * own[1] - left[1, 0] ** 2, RIDGE * own[0] * own[1])
        each = [own[1] / size, own[0] / size]
    none = np.stack(diagonal[:wanted], axis=-1) <= 0
    return np.where(none, np.inf, np.stack(each, axis=-1))


class SummedInformation:
    """Candidates whose information adds up, but for what errors hide that they share."""

    def __init__(self, information: Real, prior: Real, shared: Real | None = None) -> None:
        """information: of each without shared errors, symmetric, shape (case, candidate, p, p).

        prior: 1/deviation² of each unknown, which counts once, shape (p,). shared: products of each
        shared error with the p unknowns, then with itself, shape (case, candidate, error, p + 1);
        the deviation of an error is 1. None without shared errors.
        """
        cases, self.candidates, p, _ = information.shape
        self._lower, self._prior = np.tril_indices(p), prior.tolist()
        parts = [information.transpose(2, 3, 1, 0)[self._lower].swapaxes(0, 1)]
        if shared is not None:
            parts.append(shared.transpose(1, 2, 3, 0).reshape(self.candidates, -1, cases))
        self._shape = -1, sum(part.shape[1] for part in parts), cases
        entries = np.ascontiguousarray(np.concatenate(parts, axis=1))
        self._entries = entries.reshape(self.candidates, -1)
        """Lower triangles, then products with errors, shape (candidate, entry * case)."""

    def of(self, choices: Integer) -> Iterator[LowerTriangle]:
        """Information of choices, shape (choice, n), some at a time: entries (choice, case)."""
        step = max(1, NUMBERS_AT_ONCE // max(self._entries.shape[1], 1))
        for part in (choices[k : k + step] for k in range(0, len(choices), step)):
            times = np.zeros((len(part), self.candidates))
            np.add.at(times, (np.arange(len(part))[:, None], part), 1.0)
            yield self._left(*self._sums(times))

    def at(self, weights: Real) -> Real:
        """Information at weights of the candidates, shape (case, p, p)."""
        left, p = self._left(*self._sums(weights[None])), range(self._lower[0][-1] + 1)
        each = [[left[max(a, b), min(a, b)][0] for b in p] for a in p]
        return np.moveaxis(np.array(each), -1, 0)

    def slope(self, weights: Real, by: Real) -> Real:
        """Derivatives by the weights from those by the information, (case, p, p)."""
        rows, columns = self._lower
        both = np.where(rows == columns, 1.0, 2.0)[:, None]
        of_lower = both * by.transpose(1, 2, 0)[self._lower]
        product, size = (each[0] for each in self._sums(weights[None])[1:])
        mean = product / (1 + size)
        of_product = -2 * np.einsum("kab,ebk->eak", by, mean)
        of_size = -(of_product * mean).sum(axis=1, keepdims=True) / 2
        hidden = np.concatenate([of_product, of_size], axis=1).reshape(-1, len(by))
        return self._entries @ np.concatenate([of_lower, hidden]).ravel()

    def _sums(self, weights: Real) -> tuple[Real, Real, Real]:
        """Sums at weights (choice, candidate) over the candidates.

        Of the lower triangles (choice, entry, case), of the products of errors with the unknowns
        (choice, error, p, case), and of those with themselves (choice, error, 1, case).
        """
        found = (weights @ self._entries).reshape(len(weights), *self._shape[1:])
        count, p = len(self._lower[0]), self._lower[0][-1] + 1
        errors = (found.shape[1] - count) // (p + 1)
        shared = found[:, count:].reshape(len(found), errors, p + 1, found.shape[-1])
        return found[:, :count], shared[:, :, :p], shared[:, :, p:]

    def _left(self, lower: Real, product: Real, size: Real) -> LowerTriangle:
        """Information that errors do not hide, with the prior, entries (choice, case)."""
        mean = product / (1 + size)
        left = dict[tuple[int, int], Real]()
        for number, (a, b) in enumerate(zip(*(each.tolist() for each in self._lower), strict=True)):
            hidden = (product[:, :, a] * mean[:, :, b]).sum(axis=1)
            left[a, b] = lower[:, number] - hidden + self._prior[a] * (a == b)
        return left

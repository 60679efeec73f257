"""Confusion matrix: true class against predicted class."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...simulator.arrays import Integer, Mask
from ...simulator.report.files import write_rows
from ...simulator.sweeps import checked_output
from ..parts.predictor import Predictor
from ..trust.answers import CANNOT_TELL

HEADER = ("target", "output", "count")


@dataclass(frozen=True, eq=False)
class Confusion:
    """Counts of sweeps by true class and answer."""

    labels: tuple[int | str, ...]
    """Classes in order, K of them."""
    counts: Integer
    """Shape (K, K), or (K, K + 1) if sweeps have no answer: (target class, output class)."""

    @property
    def outputs(self) -> tuple[int | str, ...]:
        """Classes in order, then CANNOT_TELL if sweeps have no answer."""
        return (*self.labels, CANNOT_TELL)[: self.counts.shape[1]]

    @property
    def total(self) -> int:
        """Number of sweeps."""
        return int(self.counts.sum())

    @property
    def correct(self) -> int:
        """Number of sweeps with the right answer."""
        return int(np.trace(self.counts))

    @property
    def accuracy(self) -> float:
        """Fraction of sweeps with the right answer."""
        return self.correct / self.total

    def table(self) -> list[tuple[int | str, int | str, int]]:
        """A row (target, output, count) for each pair of classes, target by target."""
        return [
            (target, output, int(self.counts[i, j]))
            for i, target in enumerate(self.labels)
            for j, output in enumerate(self.outputs)
        ]


def compare(targets: NDArray, outputs: NDArray, silent: Mask | None = None) -> Confusion:
    """Confusion matrix of true labels and predicted labels, shapes (sweep,).

    silent: True for sweeps without an answer, shape (sweep,). Classes are ordered by number, pixels
    by row and then column, pairs by their first pixel.
    """
    classes = _in_order([*targets.tolist(), *outputs.tolist()])
    counts = np.zeros((len(classes), len(classes) + 1), dtype=np.int64)
    number = {label: k for k, label in enumerate(classes)}
    rows = [number[label] for label in targets.tolist()]
    columns = np.array([number[label] for label in outputs.tolist()])
    if silent is not None:
        columns[silent] = len(classes)
    np.add.at(counts, (np.array(rows), columns), 1)
    return _without_empty(classes, counts)


def together(parts: Sequence[Confusion]) -> Confusion:
    """Counts of several confusion matrices together; they may have different classes."""
    classes = _in_order(label for part in parts for label in part.labels)
    counts = np.zeros((len(classes), len(classes) + 1), dtype=np.int64)
    number = {label: k for k, label in enumerate((*classes, CANNOT_TELL))}
    for part in parts:
        rows, columns = ([number[each] for each in side] for side in (part.labels, part.outputs))
        counts[np.ix_(rows, columns)] += part.counts
    return _without_empty(classes, counts)


def _without_empty(classes: Sequence[int | str], counts: Integer) -> Confusion:
    """Confusion matrix; its column of sweeps without an answer is left out if it is empty."""
    used = len(classes) + bool(counts[:, -1].any())
    return Confusion(tuple(classes), counts[:, :used])


def write_csv(confusion: Confusion, path: str | Path) -> None:
    """Write the table with header `target,output,count`, completely or not at all.

    Raises InputError if `path` does not end in .csv or its folder does not exist.
    """
    write_rows(checked_output(path, (".csv",)), HEADER, confusion.table())


def _in_order(labels: Iterable[int | str]) -> list[int | str]:
    return sorted(set(labels), key=_numbers)


def _numbers(label: int | str) -> list[int]:
    return [int(part) for part in re.split("[,+]", str(label))]


def over_folds(
    fit: Callable[[NDArray, NDArray], Predictor],
    X: NDArray,
    y: NDArray,
    splits: Iterable[tuple[NDArray, NDArray]],
) -> Confusion:
    """Confusion matrix of predictions for each fold by a predictor fitted to the others."""
    predicted = np.empty_like(y)
    for train, test in splits:
        predicted[test] = fit(X[train], y[train]).predict(X[test])
    return compare(y, predicted)

"""How often the localizer is right about sweeps it was not trained on."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from sklearn.model_selection import StratifiedGroupKFold, StratifiedKFold

from localization.classifiers import REFERENCE, pipeline
from localization.confusion import Confusion, compare
from localization.features import DEFAULT_QUANTITIES, features, labels
from simulator.sweeps import InputError

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

GROUPINGS = ("press", "session")


def cross_validate(
    sweeps: xr.Dataset,
    target: str = "column",
    classifier: str = REFERENCE,
    *,
    folds: int = 5,
    grouping: str | None = None,
    quantities: Sequence[str] = DEFAULT_QUANTITIES,
    seed: int = 0,
) -> Confusion:
    """Train on all folds but one and predict that one, in turn: every sweep is predicted once.

    target, quantities: as of `labels` and `features`. classifier: a name in CLASSIFIERS. folds,
    grouping, seed: as of `folds_of`. Raises InputError as these do.
    """
    X, y = features(sweeps, quantities), labels(sweeps, target)
    output = np.empty_like(y)
    for train, test in folds_of(sweeps, y, folds=folds, grouping=grouping, seed=seed):
        trained = pipeline(classifier, features=X.shape[1]).fit(X[train], y[train])
        output[test] = trained.predict(X[test])
    return compare(y, output)


def folds_of(
    sweeps: xr.Dataset, y: NDArray, *, folds: int, grouping: str | None, seed: int
) -> list[tuple[NDArray[np.intp], NDArray[np.intp]]]:
    """Indices (train, test) of each fold, with classes in like shares in every fold.

    y: labels, shape (sweep,). seed: of the shuffle.
    grouping: None lets repetitions of one press stand on both sides. With "press" all repetitions
        of a pixel are left out together, so that a column must be recognised from pixels never
        seen in training; the unpressed sweeps are left out one by one. With "session" a mounting
        of the skin is left out as a whole.
    Raises InputError for another grouping, and where folds cannot be made so that every class is in
    every training.
    """
    groups = _groups(sweeps, grouping)
    _check_number(folds, y, groups)
    kind = StratifiedKFold if grouping is None else StratifiedGroupKFold
    splitter = kind(n_splits=folds, shuffle=True, random_state=seed)
    splits = list(splitter.split(np.zeros(y.size), y, groups))
    for train, _ in splits:
        unseen = np.setdiff1d(y, y[train])
        if unseen.size:
            raise InputError(
                f"grouping by {grouping} leaves a training without class {unseen[0]}: "
                f"it needs more than one {grouping}"
            )
    return splits


def _groups(sweeps: xr.Dataset, grouping: str | None) -> NDArray[np.int64] | None:
    """Sweeps of the same number must share a fold; shape (sweep,), None where all are free."""
    if grouping is None:
        return None
    if grouping == "session":
        return sweeps["session"].values
    if grouping == "press":
        return _pixel_numbers(sweeps["row"].values, sweeps["column"].values)
    raise InputError(f"`grouping` must be none, {' or '.join(GROUPINGS)}, got {grouping!r}")


def _pixel_numbers(row: NDArray[np.int64], column: NDArray[np.int64]) -> NDArray[np.int64]:
    """A number per pressed pixel, and one of its own per unpressed sweep; shape (sweep,)."""
    pixels, number = np.unique(np.stack([row, column]), axis=1, return_inverse=True)
    unpressed = np.flatnonzero(row == 0)
    number[unpressed] = pixels.shape[1] + np.arange(unpressed.size)
    return number


def _check_number(folds: int, y: NDArray, groups: NDArray[np.int64] | None) -> None:
    classes, sizes = np.unique(y, return_counts=True)
    if classes.size < 2:
        raise InputError(f"need sweeps of at least 2 classes, got {classes.size}")
    least = sizes.argmin()
    if not 2 <= folds <= sizes[least]:
        raise InputError(
            f"`folds` must be from 2 to the {sizes[least]} sweeps of class {classes[least]}, "
            f"got {folds}"
        )
    if groups is not None and folds > np.unique(groups).size:
        raise InputError(
            f"`folds` must be at most the number of groups, {np.unique(groups).size}, got {folds}"
        )

"""Splits of sweeps into independent parts for training and for testing."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...simulator.sweeps import InputError
from ...simulator.sweeps.errors import named

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

    from ...simulator.arrays import Integer

GROUPINGS = ("press", "session")
MIN_SESSIONS = 2
"""Minimum number of sessions for whole sessions to be held out."""
PLENTY = 50_000
"""Number of sweeps above which one fold is held out instead of all in turn."""
MAX_SCORED = 20_000
"""Maximum number of scored sweeps of that fold: a share is then known to 0.4 % or better."""
Split = tuple["NDArray[np.intp]", "NDArray[np.intp]"]
Splits = list[Split]


def folds_of(
    sweeps: xr.Dataset, y: NDArray, *, folds: int, grouping: str | None, seed: int
) -> Splits:
    """Indices (train, test) of each fold; every fold has similar shares of the classes.

    y: labels, shape (sweep,). seed: seed of the shuffle.
    grouping: None lets repetitions of one press stand on both sides. With "press" all repetitions
        of a pixel are left out together, so that a column must be recognised from pixels that are
        not in the training; the unpressed sweeps are left out one by one. With "session" a mounting
        of the skin is left out as a whole.
    Raises InputError for another grouping, and if no folds have every class in every training.
    """
    groups = groups_of(sweeps, grouping)
    _check_number(folds, y, groups)
    splits = _split(y, groups, folds, seed)
    for train, _ in splits:
        missing = np.setdiff1d(y, y[train])
        if missing.size:
            raise InputError(
                f"grouping by {grouping} leaves a training without class {missing[0]}: "
                f"it needs more than one {grouping}"
            )
    return splits


def splits_of(strata: NDArray | None, sessions: Integer, folds: int = 5, seed: int = 0) -> Splits:
    """Split into as many folds as possible, at most `folds`.

    Whole sessions are held out if there are MIN_SESSIONS or more.
    strata: labels that every fold has in similar shares, shape (sweep,); None does not stratify.
    Raises InputError if two folds are not possible.
    """
    groups = sessions if by_session(sessions) else None
    most = folds if groups is None else min(folds, np.unique(groups).size)
    if strata is None:
        if not 2 <= most <= sessions.size:
            raise InputError(f"training needs at least 2 sweeps, got {sessions.size}")
        from sklearn.model_selection import GroupKFold, KFold

        kind = KFold if groups is None else GroupKFold
        splitter = kind(n_splits=most, shuffle=True, random_state=seed)
        return list(splitter.split(np.zeros(sessions.size), None, groups))
    classes, sizes = np.unique(strata, return_counts=True)
    if sizes.min() < 2:
        raise InputError(
            f"training needs at least 2 sweeps of each class, got 1 of {classes[sizes.argmin()]}"
        )
    return _split(strata, groups, min(most, int(sizes.min())), seed)


def scoring_splits(strata: NDArray | None, sessions: Integer) -> Splits:
    """The splits of `splits_of`, or only the first one if there are more than PLENTY sweeps.

    If that one holds out more than MAX_SCORED sweeps, MAX_SCORED evenly spaced ones are scored.
    """
    splits = splits_of(strata, sessions)
    if sessions.size <= PLENTY:
        return splits
    train, test = splits[0]
    scored = np.linspace(0, test.size - 1, min(MAX_SCORED, test.size)).round().astype(np.intp)
    return [(train, test[scored])]


def held_out_indices(splits: Splits) -> NDArray[np.intp]:
    """Sorted indices of all held-out sweeps."""
    return np.sort(np.concatenate([test for _, test in splits]))


def by_session(sessions: Integer) -> bool:
    """True if there are enough sessions to hold out whole ones."""
    return np.unique(sessions).size >= MIN_SESSIONS


def describe_splits(splits: Splits, sessions: Integer, requested: int = 0) -> str:
    """Text on how sweeps were held out. requested: number of folds that were requested."""
    folds = "1 fold" if len(splits) == 1 else f"{len(splits)} folds"
    if len(splits) < requested:
        folds += f" ({requested} requested, but there are no more {_units(sessions)})"
    if by_session(sessions):
        return f"{folds}, whole sessions held out"
    return f"{folds} within one session; the effect of another mounting or skin is not included"


def describe_nested_splits(splits: Splits, sessions: Integer, requested: int) -> str:
    """Text of `describe_splits`, with a remark if the inner folds hold out no whole sessions."""
    within = all(by_session(sessions[train]) for train, _ in splits)
    but = (
        "; inner folds split sessions, because there are too few"
        if by_session(sessions) and not within
        else ""
    )
    return describe_splits(splits, sessions, requested) + but


def _units(sessions: Integer) -> str:
    return "sessions, or sweeps of a class" if by_session(sessions) else "sweeps of a class"


def groups_of(sweeps: xr.Dataset, grouping: str | None) -> Integer | None:
    """Group numbers; sweeps of one group share a fold. Shape (sweep,), None without groups."""
    if grouping is None:
        return None
    if grouping == "session":
        return sweeps["session"].values
    if grouping == "press":
        return _pixel_numbers(sweeps["row"].values, sweeps["column"].values)
    raise InputError(f"`grouping` must be none, {' or '.join(GROUPINGS)}, got {grouping!r}")


def _split(y: NDArray, groups: Integer | None, folds: int, seed: int) -> Splits:
    from sklearn.model_selection import StratifiedGroupKFold, StratifiedKFold

    kind = StratifiedKFold if groups is None else StratifiedGroupKFold
    splitter = kind(n_splits=folds, shuffle=True, random_state=seed)
    return list(splitter.split(np.zeros(y.size), y, groups))


def _pixel_numbers(row: Integer, column: Integer) -> Integer:
    """Group of each sweep: one for each pressed pixel, one for each unpressed sweep, (sweep,)."""
    pixels, number = np.unique(np.stack([row, column]), axis=1, return_inverse=True)
    unpressed = np.flatnonzero(row == 0)
    number[unpressed] = pixels.shape[1] + np.arange(unpressed.size)
    return number


def _check_number(folds: int, y: NDArray, groups: Integer | None) -> None:
    classes, sizes = np.unique(y, return_counts=True)
    if classes.size < 2:
        raise InputError(f"need sweeps of at least 2 classes, got {classes.size}")
    least = sizes.argmin()
    if not 2 <= folds <= sizes[least]:
        raise InputError(
            f"{named('folds')} must be from 2 to the {sizes[least]} sweeps of class "
            f"{classes[least]}, got {folds}"
        )
    if groups is not None and folds > np.unique(groups).size:
        raise InputError(
            f"{named('folds')} must be at most the number of groups, {np.unique(groups).size}, "
            f"got {folds}"
        )

"""Training samples of a localizer: features, targets and sessions of sweeps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from hashlib import blake2b
from typing import TYPE_CHECKING, Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...simulator.measure.sweep_touches import counts_of
from ...simulator.sweeps import InputError
from ...simulator.sweeps.errors import named
from ...simulator.sweeps.reading_quantities import kind_of
from ..parts.plain import Plain
from .baselines import check_baselines, finite_sweeps
from .features import (
    RELATIVE,
    Quantities,
    at_interfaces,
    available_features,
    baseline_changes,
    chosen_quantities,
    in_blocks,
    names_beside,
    packed,
    taken_rows,
)
from .targets import PIXELS, UNLABELLED, Target, has_target, labels, positions

if TYPE_CHECKING:
    import xarray as xr

    from ...simulator.arrays import Integer, Mask, Real

FINGERPRINT_BYTES = 8


def fingerprints_of(sweeps: xr.Dataset) -> NDArray[np.uint64]:
    """A 64-bit number for the readings of each sweep, shape (sweep,).

    Readings are rounded to single precision, which text files keep too.
    """
    parts = in_blocks(np.arange(sweeps.sizes["sweep"]))
    return np.concatenate([_fingerprints(sweeps.isel(sweep=part)) for part in parts])


def _fingerprints(sweeps: xr.Dataset) -> NDArray[np.uint64]:
    names = kind_of(sweeps.variables).sufficient
    readings = np.stack([sweeps[name].values for name in names], axis=1)
    rows = np.ascontiguousarray(readings.reshape(len(readings), -1), dtype=np.float32)
    digests = b"".join(
        blake2b(row.tobytes(), digest_size=FINGERPRINT_BYTES).digest() for row in rows
    )
    return np.frombuffer(digests, dtype=np.uint64)


@dataclass(frozen=True)
class LocalizationProblem(Plain):
    """The target and the features of a localizer.

    target: see `labels`, or "position". features: number of features of a sweep. frequencies: Hz,
    ascending. scene: TOML text of the skin, empty if unknown. taken: see `taken_of`, row by row;
    empty if all interfaces are read at all frequencies.
    """

    target: Target
    features: Annotated[int, ">0"]
    quantities: tuple[str, ...]
    interfaces: tuple[str, ...]
    frequencies: tuple[Annotated[float, ">0"], ...]
    scene: str
    taken: tuple[tuple[bool, ...], ...] = ()

    @property
    def continuous(self) -> bool:
        """True if the target is a position, not a class."""
        return self.target == "position"

    @property
    def readings(self) -> int:
        """Number of readings of a sweep."""
        if self.taken:
            return sum(map(sum, self.taken))
        return len(self.interfaces) * len(self.frequencies)

    @property
    def single_touch(self) -> bool:
        """True if the target is defined for at most one touch."""
        return self.target in (*PIXELS, "position")

    @property
    def blocks(self) -> dict[str, NDArray[np.intp]]:
        """Indices of the features of each quantity, in the same order of readings."""
        each = np.arange(self.features).reshape(len(self.quantities), -1)
        return dict(zip(self.quantities, each, strict=True))

    @property
    def ignores_baseline(self) -> bool:
        """True if no feature is relative to recent baseline sweeps."""
        return not set(RELATIVE) & set(self.quantities)


class LeftOutSweeps(NamedTuple):
    """Numbers of sweeps that were left out.

    other: their press has no such target. without_baseline: their session has no baseline sweep,
    which is needed. sessions: number of such sessions. early: they come before the first baseline
    sweep of their session. not_finite: a reading is no finite number.
    """

    other: int = 0
    without_baseline: int = 0
    sessions: int = 0
    early: int = 0
    not_finite: int = 0

    def describe(self, target: str) -> str:
        """These numbers and the reasons as text."""
        plural = "" if self.sessions == 1 else "s"
        reasons = {
            UNLABELLED[target]: self.other,
            f"in {self.sessions} session{plural} without an unpressed sweep": self.without_baseline,
            "with no unpressed sweep before them": self.early,
            "with a reading that is no finite number": self.not_finite,
        }
        parts = [f"{number} {reason}" for reason, number in reasons.items() if number]
        return f"left out: {', '.join(parts)}" if parts else "none left out"


class SeveralTouches(NamedTuple):
    """Sweeps of two or more touches, for a target that is defined for one.

    X: features, shape (n, feature). sessions: shape (n,). changes: see `Samples`.
    """

    X: Real
    sessions: Integer
    changes: Real | None = None


NO_SEVERAL_TOUCHES = SeveralTouches(np.zeros((0, 0)), np.zeros(0, dtype=np.int64))


@dataclass(frozen=True, eq=False)
class Samples:
    """Features and targets of sweeps, as matrices.

    X: features, shape (sweep, feature). y: labels, shape (sweep,), or positions, shape (sweep, 3).
    sessions: shape (sweep,). rows: numbers of these sweeps among the given ones, shape (sweep,).
    several: sweeps of more touches than the target is defined for; the same for every part.
    changes: changes from the baseline, see `baseline_changes`, for the guards of models of one
    touch that do not use the baseline; None otherwise.
    """

    problem: LocalizationProblem
    X: Real
    y: NDArray
    sessions: Integer
    rows: NDArray[np.intp]
    left_out: LeftOutSweeps = LeftOutSweeps()
    several: SeveralTouches = NO_SEVERAL_TOUCHES
    changes: Real | None = None

    @property
    def strata(self) -> NDArray | None:
        """Labels for stratified folds: classes, or numbers of touches; None for positions."""
        if self.problem.target == "pair":
            return np.array([len(label.split("+")) if label != "0,0" else 0 for label in self.y])
        return None if self.problem.continuous else self.y

    def part(self, index: NDArray[np.intp]) -> Samples:
        """The samples with these indices."""
        parts = {name: getattr(self, name)[index] for name in ("X", "y", "sessions", "rows")}
        changes = None if self.changes is None else self.changes[index]
        return replace(self, **parts, changes=changes)

    def first_sessions(self, count: int | None) -> Samples:
        """The first `count` sessions, all for None; more if a class lacks sweeps.

        Folds need two sweeps of each class: sessions are added until there are two, or none is
        left.
        """
        _, first = np.unique(self.sessions, return_index=True)
        if count is None or len(first) <= count:
            return self
        order = self.sessions[np.sort(first)]
        known = next(
            (part for k in range(count, len(order)) if self._has_two_of_each(part := order[:k])),
            order,
        )
        return self.part(np.flatnonzero(np.isin(self.sessions, known)))

    def _has_two_of_each(self, sessions: Integer) -> bool:
        """True if each class has two sweeps in these sessions."""
        if self.strata is None:
            return True
        present = self.strata[np.isin(self.sessions, sessions)]
        return all((present == label).sum() >= 2 for label in np.unique(self.strata))

    def subsampled(self, count: int) -> Samples:
        """At most `count` samples, drawn in proportion to the classes; the same at every call."""
        if len(self.X) <= count:
            return self
        groups = self.sessions if self.problem.continuous else self.y
        return self.part(draw_stratified(groups, count))


def as_changes(samples: Samples) -> Samples:
    """The samples with changes from the baseline as features, NaN where there is none."""
    several, changes = samples.several, samples.changes
    assert changes is not None and several.changes is not None
    own, problem = changes.shape[1], samples.problem
    each = problem.features // len(problem.quantities)
    relative = names_beside(problem.quantities).relative[: own // each]
    features = {"quantities": relative, "features": own}
    known = np.isfinite(several.changes).all(axis=1)
    return replace(
        samples,
        problem=replace(samples.problem, **features),
        X=changes,
        several=SeveralTouches(several.changes[known], several.sessions[known]),
        changes=None,
    )


def draw_stratified(groups: NDArray, count: int, seed: int = 0) -> NDArray[np.intp]:
    """Ascending indices of a random draw, in proportion to the groups, at least one of each.

    The order within a group has no effect on the draw. groups: shape (n,). count: < n.
    """
    order = np.random.default_rng(seed).permutation(len(groups))
    _, index, sizes = np.unique(groups[order], return_inverse=True, return_counts=True)
    sorted_by_group = np.argsort(index, kind="stable")
    rank = np.empty(len(groups), dtype=np.intp)
    rank[sorted_by_group] = np.arange(len(groups)) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    return np.sort(order[np.argsort(rank / sizes[index], kind="stable")[:count]])


def samples_of(
    sweeps: xr.Dataset,
    target: str,
    quantities: Quantities | None = None,
    *,
    interfaces: Sequence[str] | None = None,
    rest: xr.Dataset | None = None,
) -> Samples:
    """Features and targets of the sweeps that have both; the others are counted.

    Arguments: see `available_features` and `has_target`; quantities default to those of
    `default_quantities`. Raises InputError as these do, as `touches_of` for positions, and if no
    sweep is left.
    """
    fitting = has_target(sweeps, target)
    if not fitting.any():
        raise InputError(f"no sweep has a press with a {named('target')} {target}")
    names = chosen_quantities(quantities, sweeps, rest)
    X, rows = available_features(sweeps, names, interfaces=interfaces, rest=rest)
    usable = rows[fitting[rows]]
    if not usable.size:
        check_baselines(sweeps, rows)
        raise InputError(
            f"no sweep with a {named('target')} {target} has a baseline sweep before it"
        )
    some, used = sweeps.isel(sweep=usable), at_interfaces(sweeps, interfaces)
    problem = LocalizationProblem(
        target=target,  # pyright: ignore[reportArgumentType]
        features=X.shape[1],
        quantities=names,
        interfaces=tuple(str(name) for name in used["interface"].values),
        frequencies=tuple(float(f) for f in used["frequency"].values),
        scene=str(sweeps.attrs.get("scene", "")),
        taken=taken_rows(used),
    )
    y = positions(some) if problem.continuous else labels(some, target)
    finite = finite_sweeps(used)
    left_out = _left_out(fitting, rows, sweeps["session"].values, finite)
    changes = None
    if problem.single_touch and problem.ignores_baseline:
        changes = baseline_changes(sweeps, interfaces=interfaces, rest=rest)
    several = _several_touches(sweeps, ~fitting[rows], X, rows, changes)
    sessions = some["session"].values
    X = packed(X, fitting[rows])
    own = None if changes is None else changes[usable]
    return Samples(problem, X, y, sessions, usable, left_out, several, own)


def _several_touches(
    sweeps: xr.Dataset, other: Mask, X: Real, rows: NDArray[np.intp], changes: Real | None
) -> SeveralTouches:
    """The sweeps of two or more touches among the rows without the target, (row,).

    changes: changes of all sweeps.
    """
    some = sweeps.isel(sweep=rows[other])
    more = counts_of(some) > 1
    own = None if changes is None else changes[rows[other][more]]
    return SeveralTouches(X[other][more], some["session"].values[more], own)


def _left_out(
    fitting: Mask, rows: NDArray[np.intp], session: Integer, finite: Mask
) -> LeftOutSweeps:
    """Count the sweeps left out.

    fitting: True if a sweep has the target, (sweep,). rows: usable sweeps. finite: True if all
    readings are, (sweep,).
    """
    known = np.isin(session, session[rows])
    early = known & fitting & finite
    early[rows] = False
    without = session[~known & fitting & finite]
    return LeftOutSweeps(
        int((~fitting).sum()),
        without.size,
        np.unique(without).size,
        int(early.sum()),
        int((fitting & ~finite).sum()),
    )

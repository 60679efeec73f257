"""What a localizer learns from: features of sweeps, what they are of, and from which session."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.sweeps import InputError
from .features import DEFAULT_QUANTITIES, checked_quantities, features, seen_from
from .targets import has_target, labels, positions

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Problem:
    """What a localizer is to tell, and from what.

    target: as of `labels`, or "position". features: how many numbers a sweep has. frequencies: Hz,
    ascending. scene: TOML text of the skin, empty where unknown.
    """

    target: str
    features: int
    quantities: tuple[str, ...]
    interfaces: tuple[str, ...]
    frequencies: tuple[float, ...]
    scene: str

    @property
    def continuous(self) -> bool:
        """Whether a place is told, not a class."""
        return self.target == "position"


@dataclass(frozen=True, eq=False)
class Samples:
    """Sweeps as matrices.

    X: features, shape (sweep, feature). y: labels, shape (sweep,), or positions, shape (sweep, 3).
    sessions: shape (sweep,). left_out: sweeps whose press has no such target.
    """

    problem: Problem
    X: NDArray[np.float64]
    y: NDArray
    sessions: NDArray[np.int64]
    left_out: int = 0

    @property
    def strata(self) -> NDArray | None:
        """What folds are to have in like shares: classes, or how many touches of pairs."""
        if self.problem.target == "pair":
            return np.array([len(label.split("+")) if label != "0,0" else 0 for label in self.y])
        return None if self.problem.continuous else self.y

    def part(self, index: NDArray[np.intp]) -> Samples:
        """Only those sweeps."""
        return replace(self, X=self.X[index], y=self.y[index], sessions=self.sessions[index])

    def of_sessions(self, count: int | None) -> Samples:
        """The first so many sessions, all of them for None."""
        _, first = np.unique(self.sessions, return_index=True)
        if count is None or len(first) <= count:
            return self
        known = self.sessions[np.sort(first)[:count]]
        return self.part(np.flatnonzero(np.isin(self.sessions, known)))

    def at_most(self, count: int) -> Samples:
        """So many of them or all, taken evenly in their order, the same at every call."""
        if len(self.X) <= count:
            return self
        return self.part(np.linspace(0, len(self.X) - 1, count).astype(np.intp))


def samples_of(
    sweeps: xr.Dataset,
    target: str,
    quantities: Sequence[str] = DEFAULT_QUANTITIES,
    *,
    interfaces: Sequence[str] | None = None,
    rest: xr.Dataset | None = None,
) -> Samples:
    """Features and targets of the sweeps whose press has such a target; the others are counted.

    Arguments as of `features` and `has_target`; raises InputError as these do, and where no sweep
    is left.
    """
    usable = np.flatnonzero(has_target(sweeps, target))
    if not usable.size:
        raise InputError(f"no sweep has a press that `target` {target} can be told of")
    X = features(sweeps, quantities, interfaces=interfaces, rest=rest)[usable]
    some, seen = sweeps.isel(sweep=usable), seen_from(sweeps, interfaces)
    problem = Problem(
        target=target,
        features=X.shape[1],
        quantities=checked_quantities(quantities),
        interfaces=tuple(str(name) for name in seen["interface"].values),
        frequencies=tuple(float(f) for f in seen["frequency"].values),
        scene=str(sweeps.attrs.get("scene", "")),
    )
    y = positions(some) if problem.continuous else labels(some, target)
    left_out = sweeps.sizes["sweep"] - usable.size
    return Samples(problem, X, y, some["session"].values, left_out)

"""Names of the faults that sweeps without an answer resemble."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.measure.skin_faults import kind_of_fault, place_of_fault
from ...simulator.sweeps.schema import FAULT
from ..inputs.features import available_features, names_of
from ..parts.plain import Plain, Sizes, require
from .answers import CANNOT_TELL
from .folds import splits_of
from .kinds import KindGuard, fitted_kind_guard

if TYPE_CHECKING:
    from collections.abc import Sequence

    import xarray as xr
    from numpy.typing import NDArray

    from ...simulator.arrays import Mask, Real

NO_FAULT = "no fault"
MIN_SESSIONS_OF_FAULT = 3
"""Number of sessions with a fault from which on it can be named."""
MAX_SWEEPS_OF_FAULT = 5000
CLEARER = 0.8
"""A fault is named if its distance, over its limit, is below this share of every other one."""


MISLEADING = 0.5
"""Share of right answers below which a fault is misleading."""


@dataclass(frozen=True, eq=False)
class Diagnosis(Plain):
    """Guards that each know the sweeps of one kind of fault, and those without a fault.

    guards: by kind of fault and NO_FAULT, for logarithms of magnitudes and phases as read.
    misleading: kinds of fault under which fewer than half of the answers in the training were
    right. A dead foil is one: if a localizer compares with the unpressed skin, it reads as nothing
    pressed.
    """

    guards: Mapping[str, KindGuard]
    misleading: tuple[str, ...] = ()

    def _check(self, sizes: Sizes) -> None:
        known = self.guards.keys() - {NO_FAULT}
        require(known and NO_FAULT in self.guards, "guards", "must be of a fault, and of none")
        sizes_of = {guard.features for guard in self.guards.values()}
        require(len(sizes_of) == 1, "guards", "must be of as many features each")
        require(known >= set(self.misleading), "misleading", "must be faults of `guards`")

    def kinds(self, X: Real) -> NDArray[np.str_]:
        """Kind of the fault that each sweep resembles, "" if it resembles none, shape (n,).

        A sweep resembles a fault if it is within the limit of the sweeps of that fault, beyond that
        of sweeps without a fault, and clearly nearer to the fault than to any other. X: shape (n,
        feature).
        """
        names = np.array([kind for kind in self.guards if kind != NO_FAULT])
        away = np.stack([self.guards[kind].distances(X) for kind in names])
        best = away.argmin(axis=0)
        nearest, others = away[best, np.arange(len(X))], np.sort(away, axis=0)[1:2]
        like = (nearest <= 1) & (self.guards[NO_FAULT].distances(X) > 1)
        clear = like & (nearest < CLEARER * others).all(axis=0)
        return np.where(clear, names[best], "")


def faults_of(sweeps: xr.Dataset) -> NDArray[np.str_]:
    """Fault of each sweep as text, "" without, shape (sweep,)."""
    if FAULT not in sweeps.variables:
        return np.full(sweeps.sizes["sweep"], "")
    return sweeps[FAULT].values.astype(str)


def diagnosis_of(sweeps: xr.Dataset, interfaces: Sequence[str], right: Real) -> Diagnosis | None:
    """Guards of the faults in these sweeps; None if none has enough sessions.

    right: 1 for a right answer, 0 for a wrong one, NaN where no press is known, shape (sweep,).
    """
    faults = faults_of(sweeps)
    kinds = np.array([kind_of_fault(text) or NO_FAULT for text in faults])
    guards = {
        kind: guard
        for kind in np.unique(kinds).tolist()
        if (guard := _guard(sweeps, interfaces, kinds == kind, faults)) is not None
    }
    if len(guards) < 2 or NO_FAULT not in guards:
        return None
    misleading = (
        kind
        for kind in guards
        if kind != NO_FAULT
        and (own := right[(kinds == kind) & np.isfinite(right)]).size
        and own.mean() < MISLEADING
    )
    return Diagnosis(guards, tuple(misleading))


def diagnosis_features(
    sweeps: xr.Dataset, interfaces: Sequence[str]
) -> tuple[Real, NDArray[np.intp]]:
    """Features that a `Diagnosis` takes, (row, feature), and the numbers of their sweeps."""
    absolute = names_of(sweeps.variables).absolute
    return available_features(sweeps, absolute, interfaces=interfaces)


def without_answer(kind: str) -> str:
    """Text of the answer to a sweep that resembles a kind of fault; "" for no fault."""
    article = "an" if kind[:1] in "aeiou" else "a"
    return f"{CANNOT_TELL}: like {article} {kind}" if kind else CANNOT_TELL


def _guard(
    sweeps: xr.Dataset, interfaces: Sequence[str], which: Mask, faults: NDArray[np.str_]
) -> KindGuard | None:
    """Guard of some sweeps, each place of the fault apart; None for too few sessions."""
    rows = np.flatnonzero(which)
    rows = rows[:: max(1, len(rows) // MAX_SWEEPS_OF_FAULT)]
    sessions = sweeps["session"].values[rows]
    if np.unique(sessions).size < MIN_SESSIONS_OF_FAULT:
        return None
    X, some = diagnosis_features(sweeps.isel(sweep=rows), interfaces)
    rows, sessions = rows[some], sessions[some]
    places = np.array([place_of_fault(text) or "anywhere" for text in faults[rows]])
    return fitted_kind_guard(X, places, splits=splits_of(None, sessions))

"""Subsample of a large simulated set that a kernel machine can learn, with its baselines."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

    from ...simulator.arrays import Integer

MAX_SWEEPS = 1000
"""Maximum number of sweeps: the cost of kernel machines grows with the square."""
SESSION_EXCESS = 2
"""The sessions drawn have this multiple of MAX_SWEEPS sweeps, so that each keeps enough of them."""
BASELINES_PER_SESSION = 5
"""Number of first unpressed sweeps that are kept of each session, as its baseline."""


def subsampled(sweeps: xr.Dataset, random: np.random.Generator) -> xr.Dataset:
    """At most MAX_SWEEPS of the sweeps, of sessions drawn at random; the unpressed ones first."""
    if sweeps.sizes["sweep"] <= MAX_SWEEPS:
        return sweeps
    session = sweeps["session"].values
    among = np.flatnonzero(np.isin(session, _drawn(session, random)))
    rest = _first_baselines(among, session, sweeps["row"].values)[:MAX_SWEEPS]
    others = np.setdiff1d(among, rest)
    more = random.choice(others, min(MAX_SWEEPS - rest.size, others.size), replace=False)
    return sweeps.isel(sweep=np.union1d(rest, more))


def _drawn(session: Integer, random: np.random.Generator) -> Integer:
    """Random sessions that together have SESSION_EXCESS times MAX_SWEEPS sweeps, or all."""
    names, counts = np.unique(session, return_counts=True)
    order = random.permutation(names.size)
    before = np.cumsum(counts[order]) - counts[order]
    return names[order[before < SESSION_EXCESS * MAX_SWEEPS]]


def _first_baselines(order: NDArray[np.intp], session: Integer, row: Integer) -> NDArray[np.intp]:
    """Indices of the first BASELINES_PER_SESSION unpressed sweeps of each session."""
    unpressed = order[row[order] == 0]
    parts = [
        unpressed[session[unpressed] == each][:BASELINES_PER_SESSION]
        for each in np.unique(session[unpressed])
    ]
    return np.concatenate([np.zeros(0, dtype=np.intp), *parts])

"""So many of a large simulated set as a kernel machine can learn, with the skin at rest."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

MOST = 1000
"""Sweeps that are kept: kernel machines grow with their square."""
SPREAD = 2
"""Times as many are drawn from, so that sessions are many but not thin."""
REST = 5
"""Unpressed sweeps that are kept of each session drawn, its first: later ones are told against
them."""


def subsampled(sweeps: xr.Dataset, random: np.random.Generator) -> xr.Dataset:
    """At most MOST of the sweeps, of sessions drawn at random; first those at rest."""
    if sweeps.sizes["sweep"] <= MOST:
        return sweeps
    session = sweeps["session"].values
    among = np.flatnonzero(np.isin(session, _drawn(session, random)))
    rest = _first_of_rest(among, session, sweeps["row"].values)[:MOST]
    others = np.setdiff1d(among, rest)
    more = random.choice(others, min(MOST - rest.size, others.size), replace=False)
    return sweeps.isel(sweep=np.union1d(rest, more))


def _drawn(session: NDArray[np.int64], random: np.random.Generator) -> NDArray[np.int64]:
    """Sessions that together have SPREAD times MOST sweeps, or all."""
    names, counts = np.unique(session, return_counts=True)
    order = random.permutation(names.size)
    before = np.cumsum(counts[order]) - counts[order]
    return names[order[before < SPREAD * MOST]]


def _first_of_rest(
    order: NDArray[np.intp], session: NDArray[np.int64], row: NDArray[np.int64]
) -> NDArray[np.intp]:
    """Indices of REST unpressed sweeps of each session, the first in an order."""
    unpressed = order[row[order] == 0]
    parts = [unpressed[session[unpressed] == each][:REST] for each in np.unique(session[unpressed])]
    return np.concatenate([np.zeros(0, dtype=np.intp), *parts])

"""The skin at rest, which sweeps of the same session are told against."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...simulator.sweeps import InputError, impedance

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

NEAREST, FEWEST = 8, 3
"""Sweeps at rest that tell of a moment of a session, and how few of them tell a trend."""


def log_at_rest(sweeps: xr.Dataset, rest: xr.Dataset | None = None) -> NDArray[np.complex128]:
    """ln (Z / ohm) that the skin at rest had when each sweep was taken, in its own session.

    rest: sweeps of the skin at rest, all of them unpressed, of which the mean of a session counts;
    of one session they serve every sweep. Without it, the unpressed sweeps among `sweeps`, of row
    0: skins drift, so that the line through the NEAREST of them tells, sweeps being in the order in
    which they were taken.
    Returns shape (sweep, interface, frequency). Raises InputError naming a session without any.
    """
    unpressed = sweeps.isel(sweep=sweeps["row"].values == 0) if rest is None else rest
    known, asked = unpressed["session"].values, sweeps["session"].values
    if rest is not None and np.unique(known).size == 1:
        known, asked = np.zeros_like(known), np.zeros_like(asked)
    absent = np.setdiff1d(asked, known)
    if absent.size:
        raise InputError(
            f"session {absent[0]} has no sweep of the skin at rest, which its touches are to be "
            "told against"
        )
    logarithm = np.log(impedance(unpressed).astype(complex))
    found = np.zeros((asked.size, *logarithm.shape[1:]), dtype=complex)
    moments = np.flatnonzero(sweeps["row"].values == 0) if rest is None else None
    for session in np.unique(asked):
        here, there = np.flatnonzero(asked == session), np.flatnonzero(known == session)
        shares = _mean(here, there) if moments is None else _trend(here, moments[there])
        found[here] = np.tensordot(shares, logarithm[there], axes=1)
    return found


def _mean(here: NDArray[np.intp], there: NDArray[np.intp]) -> NDArray[np.float64]:
    return np.full((here.size, there.size), 1 / there.size)


def _trend(here: NDArray[np.intp], moments: NDArray[np.intp]) -> NDArray[np.float64]:
    """Shares of the sweeps at rest in what the line through the nearest is, (sweep, at rest).

    Before the first and after the last of them the line is held.
    """
    if moments.size < FEWEST:
        return _mean(here, moments)
    nearest = np.argsort(np.abs(here[:, None] - moments), axis=1, kind="stable")[:, :NEAREST]
    times = moments[nearest].astype(float)
    at = np.clip(here.astype(float), times.min(axis=1), times.max(axis=1))
    middle = times.mean(axis=1)
    aside = times - middle[:, None]
    slope = aside / (aside**2).sum(axis=1, keepdims=True)
    shares = np.zeros((here.size, moments.size))
    parts = 1 / times.shape[1] + (at - middle)[:, None] * slope
    np.put_along_axis(shares, nearest, parts, axis=1)
    return shares

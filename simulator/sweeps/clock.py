"""Detects sweeps between which the computer's clock was set back."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .schema import TIME, session_names

if TYPE_CHECKING:
    import xarray as xr

SLACK = 0.1
"""Seconds: smaller corrections of the clock are shorter than a reading."""


def backward_times(sweeps: xr.Dataset) -> list[str]:
    """One line for each session in which a sweep has an earlier time than the one before it."""
    if TIME not in sweeps.variables:
        return []
    time, session, names = sweeps[TIME].values, sweeps["session"].values, session_names(sweeps)
    lines = []
    for number in dict.fromkeys(session.tolist()):
        own = np.flatnonzero(session == number)
        back = -np.diff(time[own])
        first = int(np.argmax(back > SLACK)) if back.size else 0
        if back.size and back[first] > SLACK:
            lines.append(
                f"session {names.get(number, number)}: sweep {own[first + 1]} is "
                f"{back[first]:.1f} s earlier than sweep {own[first]} before it"
                + (f", and {more} more" if (more := int((back > SLACK).sum()) - 1) else "")
                + ": the clock was set back, or sweeps are not in the order they were taken in"
            )
    return lines

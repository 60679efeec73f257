"""Sweeps from a file, no more of them than memory is to hold."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.sweeps import InputError, check, open_zarr, read

if TYPE_CHECKING:
    import xarray as xr


def read_some(path: Path, most: int) -> xr.Dataset:
    """The first sweeps of a file, at most so many, and of whole sessions where there are several.

    Of a `.zarr` no more than these are read. Raises InputError as `read`, and for `most` < 1.
    """
    if most < 1:
        raise InputError(f"--most must be >= 1, got {most}")
    if path.suffix != ".zarr" or not path.exists():
        sweeps = read(path)
        return sweeps.isel(sweep=_whole_sessions(sweeps["session"].values, most))
    stored = open_zarr(path).drop_dims("drawn_session", errors="ignore")
    if "session" not in stored.variables:
        return check(stored)
    some = stored.isel(sweep=_whole_sessions(stored["session"].values, most)).load()
    texts = [name for name, variable in some.variables.items() if variable.dtype.kind == "T"]
    return check(some.assign_coords({name: some[name].astype(object) for name in texts}))


def _whole_sessions(sessions: np.ndarray, most: int) -> slice:
    """The first sweeps, ending where a session ends if any does."""
    if sessions.size <= most:
        return slice(None)
    ends = np.flatnonzero(np.diff(sessions[: most + 1])) + 1
    return slice(int(ends[-1]) if ends.size else most)

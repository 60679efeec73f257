"""Sweeps from files, limited to a number that fits in memory."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.sweeps import InputError, check, loaded, open_zarr, read
from ...simulator.sweeps.joining import join
from ...simulator.sweeps.reading_quantities import kind_of

if TYPE_CHECKING:
    import xarray as xr


def read_first(files: Path | Sequence[Path], max_sweeps: int, *, lazy: bool = False) -> xr.Dataset:
    """The first sweeps of one or several files, at most `max_sweeps`.

    Whole sessions are read if possible. Only these sweeps are read from a `.zarr`. lazy: the
    readings stay in the file and are read for each part on demand. Raises InputError as `read` and
    `join`, and for `max_sweeps` < 1.
    """
    if max_sweeps < 1:
        raise InputError(f"--most must be >= 1, got {max_sweeps}")
    paths = [files] if isinstance(files, Path) else files
    parts = [_some_of(path, max_sweeps, lazy) for path in paths]
    sweeps = join(parts, paths)
    return sweeps.isel(sweep=_whole_sessions(sweeps["session"].values, max_sweeps))


def _some_of(path: Path, most: int, in_parts: bool) -> xr.Dataset:
    if path.suffix != ".zarr":
        return read(path)
    stored = open_zarr(path).drop_dims("drawn_session", errors="ignore")
    if "session" not in stored.variables:
        return check(stored)
    some = stored.isel(sweep=_whole_sessions(stored["session"].values, most))
    known = check(loaded(some.copy(), path))
    left = kind_of(some).names if in_parts else ()
    return known.assign({name: some[name].variable for name in left})


def _whole_sessions(sessions: np.ndarray, most: int) -> slice:
    """The first sweeps, up to the end of a session if there is one."""
    if sessions.size <= most:
        return slice(None)
    ends = np.flatnonzero(np.diff(sessions[: most + 1])) + 1
    return slice(int(ends[-1]) if ends.size else most)

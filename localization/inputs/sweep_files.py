"""Sweeps from a file, no more of them than memory is to hold."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.sweeps import InputError, check, loaded, open_zarr, read
from ...simulator.sweeps.joining import join
from ...simulator.sweeps.schema import QUANTITIES

if TYPE_CHECKING:
    import xarray as xr


def read_first(files: Path | Sequence[Path], max_sweeps: int, *, lazy: bool = False) -> xr.Dataset:
    """The first sweeps of a file or several, at most so many, and of whole sessions if it can be.

    Of a `.zarr` no more than these are read; in_parts: its readings stay there, and are read anew
    as each part is asked for. Raises InputError as `read` and `join`, and for `most` < 1.
    """
    if max_sweeps < 1:
        raise InputError(f"--most must be >= 1, got {max_sweeps}")
    paths = [files] if isinstance(files, Path) else files
    parts = [_some_of(path, max_sweeps, lazy) for path in paths]
    sweeps = join(parts, paths)
    return sweeps.isel(sweep=_whole_sessions(sweeps["session"].values, max_sweeps))


def _some_of(path: Path, most: int, in_parts: bool) -> xr.Dataset:
    if path.suffix != ".zarr" or not path.exists():
        return read(path)
    stored = open_zarr(path).drop_dims("drawn_session", errors="ignore")
    if "session" not in stored.variables:
        return check(stored)
    some = stored.isel(sweep=_whole_sessions(stored["session"].values, most))
    texts = [name for name, variable in some.variables.items() if variable.dtype.kind == "T"]
    held = check(loaded(some.copy(), path))
    held = held.assign_coords({name: held[name].astype(object) for name in texts})
    left = QUANTITIES if in_parts else ()
    return held.assign({name: some[name].variable for name in left})


def _whole_sessions(sessions: np.ndarray, most: int) -> slice:
    """The first sweeps, ending where a session ends if any does."""
    if sessions.size <= most:
        return slice(None)
    ends = np.flatnonzero(np.diff(sessions[: most + 1])) + 1
    return slice(int(ends[-1]) if ends.size else most)

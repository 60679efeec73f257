"""Sweeps restricted to some of their readings."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from .reading_quantities import DESCRIBED
from .schema import DIMENSIONS, TAKEN, UNNAMED, taken_of

if TYPE_CHECKING:
    import xarray as xr

    from ..arrays import Mask


def read_mask(sweeps: xr.Dataset) -> Mask:
    """Mask of the readings that were taken, shape (interface, frequency)."""
    taken = taken_of(sweeps)
    whole = np.ones((sweeps.sizes["interface"], sweeps.sizes["frequency"]), dtype=bool)
    return whole if taken is None else taken


def restricted(sweeps: xr.Dataset, read: Mask) -> xr.Dataset:
    """The sweeps with these readings only; interfaces and frequencies without any are dropped.

    read: mask of shape (interface, frequency), a non-empty subset of the readings taken.
    """
    import xarray as xr

    if read.all():
        return sweeps
    there = xr.DataArray(read, dims=DIMENSIONS[1:])
    names = [name for name in DESCRIBED if name in sweeps.variables]
    some = {name: sweeps[name].where(there).transpose(*sweeps[name].dims) for name in names}
    rows, columns = read.any(axis=1), read.any(axis=0)
    bare = sweeps.assign(some).drop_vars(TAKEN, errors="ignore")
    bare = bare.isel(interface=rows, frequency=columns)
    left = read[np.ix_(rows, columns)]
    if left.all():
        return bare
    return bare.assign_coords({TAKEN: (DIMENSIONS[1:], left.astype(np.int8))})


def with_named_interface(sweeps: xr.Dataset, names: Sequence[str]) -> xr.Dataset:
    """The sweeps; their only interface gets the only name of a scene if they name none."""
    own = [str(name) for name in sweeps["interface"].values]
    if own != [UNNAMED] or len(names) != 1:
        return sweeps
    return sweeps.assign_coords(interface=("interface", np.array(list(names), dtype=object)))


def read_at(sweeps: xr.Dataset, interface: str) -> xr.Dataset:
    """The sweeps at one interface, at the frequencies at which it was read."""
    taken = taken_of(sweeps)
    index = [str(name) for name in sweeps["interface"].values].index(interface)
    if taken is None:
        return sweeps.isel(interface=[index])
    own = sweeps.isel(interface=[index], frequency=np.flatnonzero(taken[index]))
    return own.drop_vars(TAKEN)

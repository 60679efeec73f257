"""Sweeps joined along their dimensions: more sweeps, or more interfaces of the same presses."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from .errors import InputError
from .reading_quantities import kind_of
from .schema import CONTACT, CONTACTS, DIMENSIONS, LABELS, TAKEN, TIME, taken_of

if TYPE_CHECKING:
    import xarray as xr


def concatenate(parts: Sequence[xr.Dataset]) -> xr.Dataset:
    """Concatenates data sets of equal interfaces and frequencies; attributes are the first's.

    Raises InputError if there is none, or if interfaces or frequencies differ.
    """
    import xarray as xr

    if not parts:
        raise InputError("`parts` must hold at least one data set, got none")
    first = parts[0]
    for part in parts[1:]:
        kinds = [kind_of(each.variables).name for each in (part, first)]
        if kinds[0] != kinds[1]:
            raise InputError(f"sweeps of the {kinds[0]} and the {kinds[1]} cannot be joined")
        for name in ("interface", "frequency"):
            if not np.array_equal(part[name].values, first[name].values):
                raise InputError(f"sweeps of different `{name}` cannot be joined")
        if not same_taken(part, first):
            raise InputError("sweeps of different `frequencies` of interfaces cannot be joined")
    masked = [
        part.set_coords(TAKEN) if TAKEN in part.variables else part for part in _padded(parts)
    ]
    return xr.concat(masked, dim="sweep", combine_attrs="override", join="exact")


def _padded(parts: Sequence[xr.Dataset]) -> Sequence[xr.Dataset]:
    """Data sets with room for equal numbers of contacts, NaN where there are none."""
    most = max(part.sizes.get(CONTACT, 0) for part in parts)
    if not most:
        return parts
    import xarray as xr

    padded = []
    for part in parts:
        none = xr.Variable(("sweep", CONTACT), np.full((part.sizes["sweep"], 0), np.nan))
        whole = part.assign({name: none for name in CONTACTS if name not in part})
        padded.append(whole.pad({CONTACT: (0, most - whole.sizes[CONTACT])}))
    return padded


def same_taken(one: xr.Dataset, other: xr.Dataset) -> bool:
    """True if both data sets have the same mask of readings taken."""
    first, second = taken_of(one), taken_of(other)
    if first is None or second is None:
        return first is second
    return np.array_equal(first, second)


def side_by_side(parts: Sequence[xr.Dataset]) -> xr.Dataset:
    """Joins recordings of the same presses at different interfaces into one data set.

    Attributes and time are the first's. Raises InputError if presses, sessions or frequencies
    differ, or if an interface is named twice.
    """
    import xarray as xr

    first = parts[0]
    for part in parts[1:]:
        for name in (*LABELS, "frequency"):
            if not np.array_equal(part[name].values, first[name].values):
                raise InputError(f"sweeps of different `{name}` are not of the same presses")
    names = [name for part in parts for name in part["interface"].values]
    if len(set(names)) < len(names):
        raise InputError(f"`interface` names must be distinct, got {', '.join(names)}")
    bare = [part.drop_vars(TIME, errors="ignore") for part in parts]
    if any(TAKEN in part.variables for part in parts):
        bare = [part if TAKEN in part.variables else _all_taken(part) for part in bare]
    whole = xr.concat(bare, dim="interface", combine_attrs="override", join="exact")
    return whole.assign_coords({TIME: first[TIME]}) if TIME in first.variables else whole


def _all_taken(sweeps: xr.Dataset) -> xr.Dataset:
    """Adds the mask TAKEN with all readings taken."""
    whole = np.ones((sweeps.sizes["interface"], sweeps.sizes["frequency"]), dtype=np.int8)
    return sweeps.assign_coords({TAKEN: (DIMENSIONS[1:], whole)})

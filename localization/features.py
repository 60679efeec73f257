"""From sweeps to what a classifier takes: a matrix of features and a label per sweep."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from simulator.sweeps import InputError

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

QUANTITIES = ("Rs", "X", "Cp")
DEFAULT_QUANTITIES = ("Rs", "Cp")
TARGETS = ("column", "row", "pixel")


def features(
    sweeps: xr.Dataset, quantities: Sequence[str] = DEFAULT_QUANTITIES
) -> NDArray[np.float64]:
    """The chosen quantities of each sweep side by side, in SI units, shape (sweep, feature).

    The order is that of `feature_names`: quantity by quantity as asked, within it interface by
    interface, within it by ascending frequency.
    Raises InputError for a quantity that is not one of QUANTITIES, none at all, or one asked twice.
    """
    blocks = [
        sweeps[name].transpose("sweep", "interface", "frequency").values
        for name in checked_quantities(quantities)
    ]
    return np.stack(blocks, axis=1).reshape(sweeps.sizes["sweep"], -1)


def feature_names(sweeps: xr.Dataset, quantities: Sequence[str] = DEFAULT_QUANTITIES) -> list[str]:
    """What each column of `features` is, such as "Rs left 1000 Hz"."""
    return [
        f"{quantity} {interface} {frequency:.12g} Hz"
        for quantity in checked_quantities(quantities)
        for interface in sweeps["interface"].values
        for frequency in sweeps["frequency"].values
    ]


def labels(sweeps: xr.Dataset, target: str = "column") -> NDArray[np.int64] | NDArray[np.str_]:
    """Where each sweep was pressed, shape (sweep,).

    target: "column" and "row" give its number, 0 where nothing was pressed; "pixel" gives
    "ROW,COLUMN" as in the notation of presses, "0,0" where nothing was pressed.
    Raises InputError for another target, or a sweep whose press is no single pixel.
    """
    if target not in TARGETS:
        raise InputError(f"`target` must be one of {', '.join(TARGETS)}, got {target!r}")
    row, column = sweeps["row"].values, sweeps["column"].values
    elsewhere = np.flatnonzero((row < 0) | (column < 0))
    if elsewhere.size:
        press = sweeps["press"].values[elsewhere[0]]
        raise InputError(f"sweep {elsewhere[0]}: its press {press!r} is no single pixel")
    if target == "pixel":
        return np.array([f"{i},{j}" for i, j in zip(row, column, strict=True)])
    return column if target == "column" else row


def checked_quantities(quantities: Sequence[str]) -> tuple[str, ...]:
    """The same quantities, if they can be features; raises InputError as `features` does."""
    for name in quantities:
        if name not in QUANTITIES:
            raise InputError(f"`quantities` must be of {', '.join(QUANTITIES)}, got {name!r}")
    if not quantities or len(set(quantities)) < len(quantities):
        raise InputError(f"`quantities` must name each once, at least one, got {list(quantities)}")
    return tuple(quantities)

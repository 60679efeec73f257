"""Targets of sweeps: pressed pixel, column, row, number of touches, position."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, get_args

import numpy as np

from ...simulator.measure.sweep_touches import MAX_TOUCHES, counts_of, pressed_pixels, touches_of
from ...simulator.sweeps import InputError
from ...simulator.sweeps.errors import named

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

    from ...simulator.arrays import Integer, Mask, Real

PIXELS = ("column", "row", "pixel")
CLASSES = (*PIXELS, "touches", "pair")
Target = Literal["column", "row", "pixel", "touches", "pair", "position"]
TARGETS: tuple[str, ...] = get_args(Target)
UNLABELLED = {
    **dict.fromkeys(PIXELS, "not of a press of one pixel"),
    "touches": f"of more than {MAX_TOUCHES} touches",
    "pair": f"not of a press of at most {MAX_TOUCHES} whole pixels",
    "position": "not of one touch",
}
"""Descriptions of the sweeps that do not have a target."""
COORDINATES = ("x_mm", "y_mm", "factor")
"""Columns of `positions`."""


def labels(sweeps: xr.Dataset, target: str = "column") -> Integer | NDArray[np.str_]:
    """The class of each sweep, shape (sweep,).

    target: "column" and "row" give its number, 0 if nothing was pressed; "pixel" gives "ROW,COLUMN"
    as in the notation of presses, "0,0" if nothing was pressed; "touches" gives their number;
    "pair" gives none, one or two pixels in ascending order, such as "1,2+3,4".
    Raises InputError for another target, or a sweep whose press has no such label.
    """
    if target not in CLASSES:
        raise InputError(f"{named('target')} must be one of {', '.join(CLASSES)}, got {target!r}")
    if target == "touches":
        return counts_of(sweeps)
    if target == "pair":
        return np.array([_pair(str(text)) for text in sweeps["press"].values])
    row, column = sweeps["row"].values, sweeps["column"].values
    elsewhere = np.flatnonzero((row < 0) | (column < 0))
    if elsewhere.size:
        press = sweeps["press"].values[elsewhere[0]]
        raise InputError(f"sweep {elsewhere[0]}: its press {press!r} is not a single pixel")
    if target == "pixel":
        return np.array([f"{i},{j}" for i, j in zip(row, column, strict=True)])
    return column if target == "column" else row


def positions(sweeps: xr.Dataset) -> Real:
    """Centre of the touch in mm and its strength, the factor of capacitance; shape (sweep, 3).

    Raises InputError for a sweep without exactly one touch.
    """
    touches = touches_of(sweeps)
    other = np.flatnonzero(touches.count != 1)
    if other.size:
        press = sweeps["press"].values[other[0]]
        raise InputError(f"sweep {other[0]}: its press {press!r} is not a single touch")
    first = touches.x[:, 0], touches.y[:, 0], touches.factor[:, 0]
    return np.column_stack(first) * [1e3, 1e3, 1]


def has_target(sweeps: xr.Dataset, target: str) -> Mask:
    """True for sweeps that have the target, shape (sweep,).

    Raises InputError for a target that is not one of TARGETS, or a press with invalid syntax.
    """
    if target not in TARGETS:
        raise InputError(f"{named('target')} must be one of {', '.join(TARGETS)}, got {target!r}")
    if target in PIXELS:
        return (sweeps["row"].values >= 0) & (sweeps["column"].values >= 0)
    if target == "pair":
        texts, index = np.unique(sweeps["press"].values.astype(str), return_inverse=True)
        return np.array([pressed_pixels(str(text)) is not None for text in texts])[index]
    count = counts_of(sweeps)
    return count <= MAX_TOUCHES if target == "touches" else count == 1


def _pair(text: str) -> str:
    pixels = pressed_pixels(text)
    if pixels is None:
        raise InputError(f"press {text!r}: is not a press of at most {MAX_TOUCHES} whole pixels")
    return "+".join(f"{row},{column}" for row, column in pixels) or "0,0"

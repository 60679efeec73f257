"""The schema of sweeps over (sweep, interface, frequency): a table, or an `xarray.Dataset`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import InputError
from .inputs import objects
from .reading_quantities import DESCRIBED, IMPEDANCE, ReadingKind, kind_of

if TYPE_CHECKING:
    from typing import TypeVar

    import xarray as xr
    from numpy.typing import ArrayLike, NDArray

    from ..arrays import Complex, Mask, Real

    Sweeps = TypeVar("Sweeps", bound="xr.Dataset | SweepTable")

DIMENSIONS = ("sweep", "interface", "frequency")
UNPRESSED = "none"
UNKNOWN_PRESS = "unknown"
UNNAMED = "unnamed"
"""Interface of sweeps from a file that names none."""
OPENING = "opening"
"""Coordinate that marks baseline sweeps: the first of a session, or else the latest."""
MEASURED, VIRTUAL = "measured", "virtual meter"
"""Values of the attribute `model` for sweeps of a real and of the virtual meter."""
SENSOR = "sensor"
"""Value of the attribute `model` for sweeps of a mounted skin, whose times are of its own clock."""
CONTACT = "patch"
"""Dimension of what touched a skin whose simulator knows it; `contact` is that of foils."""
CONTACTS = {
    "contact_x": ("m", "middle of each contact along the length"),
    "contact_y": ("m", "middle of each contact along the width"),
    "contact_force": ("N", "force of each contact normal to the skin"),
    "contact_area": ("m2", "area of each contact on the skin"),
}
"""Variables of sweeps under known contacts, (sweep, patch): units and meaning; NaN for none."""
LABELS = {
    "press": "the press as text",
    "row": "pressed pixel's row: 0 nothing pressed, -1 no single pixel",
    "column": "pressed pixel's column: 0 nothing pressed, -1 no single pixel",
    "session": "mounting or device",
}
NAMES, COUNTED = ("interface", "press"), ("row", "column", "session")
MAX_SHOWN = 60
"""Number of characters shown of a refused name."""
TAKEN = "taken"
"""Coordinate: mask of the readings taken, shape (interface, frequency). It exists only if some
interfaces skip some frequencies; quantities are NaN there."""
TIME = "time"
"""Coordinate: time of the middle of each sweep, s since 1970-01-01 UTC, if known."""
FAULT = "fault"
"""Coordinate: fault of the skin or of its reader during each sweep, as text; empty without. It
exists only where faults are drawn."""
SESSIONS = "sessions"
"""Attribute with the names of sessions: a JSON object of names by number."""


@dataclass(frozen=True)
class SweepVariable:
    """An array with the names of its dimensions and its attributes (`long_name`, `units`)."""

    dims: tuple[str, ...]
    values: NDArray[Any]
    attrs: Mapping[str, str]

    @property
    def dtype(self) -> np.dtype[Any]:
        """The type of the values."""
        return self.values.dtype


@dataclass(frozen=True)
class SweepTable:
    """Sweeps as plain arrays, with the names that the parts of an `xarray.Dataset` have.

    `import xarray` takes 0.6 s of a processor, and all else that `rcskin sweep` does 0.9 s: what
    is only written needs no `dataset`.
    """

    data_vars: Mapping[str, SweepVariable]
    coords: Mapping[str, SweepVariable]
    attrs: Mapping[str, Any]

    @property
    def variables(self) -> dict[str, SweepVariable]:
        """All arrays by name: quantities first, then coordinates."""
        return {**self.data_vars, **self.coords}

    @property
    def sizes(self) -> dict[str, int]:
        """Lengths of the dimensions by name."""
        shape = next(iter(self.data_vars.values())).values.shape
        return dict(zip(DIMENSIONS, shape, strict=True))

    def dataset(self) -> xr.Dataset:
        """The sweeps as an `xarray.Dataset`."""
        import xarray as xr

        arrays, coordinates = (
            {name: (each.dims, each.values, dict(each.attrs)) for name, each in group.items()}
            for group in (self.data_vars, self.coords)
        )
        return xr.Dataset(arrays, coordinates, attrs=dict(self.attrs))


def build(
    Z: ArrayLike,
    frequency: ArrayLike,
    *,
    interface: Sequence[str],
    press: Sequence[str],
    row: Sequence[int],
    column: Sequence[int],
    session: Sequence[int] | None = None,
    time: Sequence[float] | None = None,
    shown: Mapping[str, ArrayLike] | None = None,
    errors: Mapping[str, ArrayLike] | None = None,
    attributes: Mapping[str, str | int | float] | None = None,
    taken: Mask | None = None,
    kind: ReadingKind = IMPEDANCE,
) -> SweepTable:
    """Sweeps from complex readings; `dataset` makes them an `xarray.Dataset`.

    Z: impedances in ohm, or readings of another `kind`, shape (sweep, interface, frequency).
    frequency: Hz, ascending. press, row, column, session: one per sweep. time: middle of each
    sweep, s since 1970-01-01 UTC. shown: quantities by name that a meter displayed with digits of
    their own, shape of Z; the others follow from Z. errors: those of the kind, of impedances
    `Rs_error` [ohm] and `Cp_error` [F], shape of Z. taken: mask as in TAKEN, None for all; other
    values in the arrays are ignored.
    Raises InputError if the result would violate the schema (see `check`).
    """
    Z = np.asarray(Z, dtype=np.complex128)
    frequency = _checked_frequency(np.asarray(frequency, dtype=np.float64))
    if Z.ndim != 3 or Z.shape[1:] != (len(interface), frequency.size):
        shape = f"(sweep, {len(interface)}, {frequency.size})"
        raise InputError(f"{kind.name} must have shape {shape}, got {Z.shape}")
    displayed, estimated = (
        {name: np.asarray(each, dtype=float) for name, each in (given or {}).items()}
        for given in (shown, errors)
    )
    values = kind.values(Z, frequency, displayed) | estimated
    if taken is not None:
        values = {name: np.where(taken, value, np.nan) for name, value in values.items()}
    quantities = {
        name: SweepVariable(
            DIMENSIONS,
            value,
            {"long_name": DESCRIBED[name].meaning, "units": DESCRIBED[name].units},
        )
        for name, value in values.items()
    }
    labels = {
        "press": np.array(list(press), dtype=object),
        "row": np.asarray(row, dtype=np.int64),
        "column": np.asarray(column, dtype=np.int64),
        "session": np.asarray([0] * len(Z) if session is None else session, dtype=np.int64),
    }
    coordinates = {
        "interface": SweepVariable(("interface",), np.array(list(interface), dtype=object), {}),
        "frequency": SweepVariable(
            ("frequency",), frequency, {"long_name": "frequency", "units": "Hz"}
        ),
        **{
            name: SweepVariable(("sweep",), value, {"long_name": LABELS[name]})
            for name, value in labels.items()
        },
    }
    if taken is not None:
        coordinates[TAKEN] = SweepVariable(
            DIMENSIONS[1:], taken.astype(np.int8), {"long_name": "whether it was read"}
        )
    if time is not None:
        described_time = {"long_name": "time since 1970-01-01 UTC", "units": "s"}
        coordinates[TIME] = SweepVariable(
            ("sweep",), np.asarray(time, dtype=np.float64), described_time
        )
    return check(SweepTable(quantities, coordinates, dict(attributes or {})))


def _check_readings(name: str, values: Real, taken: Mask | None) -> None:
    """values: shape (sweep, interface, frequency)."""
    if taken is None:
        return _check_finite(name, values)
    _check_finite(name, values[:, taken])
    if not np.isnan(values[:, ~taken]).all():
        raise InputError(f"`{name}` must be NaN where `{TAKEN}` says that nothing was read")


def ordered(variable: SweepVariable | xr.Variable, dims: Sequence[str] = DIMENSIONS) -> NDArray:
    """Values of a variable with its dimensions in an order."""
    return variable.values.transpose([variable.dims.index(each) for each in dims])


def taken_of(sweeps: xr.Dataset | SweepTable) -> Mask | None:
    """The mask TAKEN of sweeps, shape (interface, frequency); None if all readings were taken.

    Raises InputError if the mask has other dimensions.
    """
    if TAKEN not in sweeps.variables:
        return None
    if {*sweeps.variables[TAKEN].dims} != {*DIMENSIONS[1:]}:
        raise InputError(f"`{TAKEN}` must have dimensions {DIMENSIONS[1:]}")
    return ordered(sweeps.variables[TAKEN], DIMENSIONS[1:]).astype(bool)


def _check_finite(name: str, values: Real) -> None:
    if not np.isfinite(values).all():
        raise InputError(f"`{name}` must be finite everywhere")


def _check_printable(name: str, values: NDArray) -> None:
    """Refuses control characters: names appear on terminals, in tables and in charts."""
    for each in set(map(str, values.tolist())):
        if not each.isprintable():
            raise InputError(f"`{name}` must be printable, on one line, got {each[:MAX_SHOWN]!r}")


def _check_whole(name: str, values: NDArray) -> None:
    """Refuses text and fractions where numbers are counted."""
    if values.dtype.kind in "iu":
        return
    if values.dtype.kind == "f":
        values = values[~(np.isfinite(values) & (np.floor(values) == values))]
    if values.size:
        got = str(values.flat[0])[:MAX_SHOWN]
        raise InputError(f"`{name}` must be whole numbers, got {got!r}")


def check(sweeps: Sweeps) -> Sweeps:
    """Returns the sweeps if they satisfy the schema.

    Raises InputError naming the variable and what is wrong with it: absent, of other dimensions,
    not finite, names that are not printable, or frequencies that are not positive and ascending.
    """
    found: Mapping[Any, Any] = sweeps.variables
    kind = kind_of(found)
    for name in (*kind.names, *LABELS, "frequency", "interface"):
        if name not in found:
            raise InputError(f"`{name}` is missing from the sweeps")
    taken = taken_of(sweeps)
    for name in (*kind.names, *(error for error in kind.error_names if error in found)):
        if {*found[name].dims} != {*DIMENSIONS}:
            raise InputError(f"`{name}` must have dimensions {DIMENSIONS}, got {found[name].dims}")
        _check_readings(name, ordered(found[name]), taken)
    if TIME in found:
        _check_finite(TIME, found[TIME].values)
    for name in NAMES:
        _check_printable(name, found[name].values)
    for name in COUNTED:
        _check_whole(name, found[name].values)
    _check_pixels(found["row"].values, found["column"].values)
    _checked_frequency(found["frequency"].values)
    return sweeps


def _check_pixels(row: NDArray, column: NDArray) -> None:
    """Refuses rows and columns that count from 0."""
    wrong = np.flatnonzero((np.minimum(row, column) == 0) & (np.maximum(row, column) > 0))
    if wrong.size:
        k = int(wrong[0])
        raise InputError(
            f"`row` {row[k]} with `column` {column[k]} in sweep {k} is no pixel: rows and columns "
            "count from 1, and 0 with 0 is the unpressed skin"
        )


def _checked_frequency(frequency: Real) -> Real:
    if not (np.isfinite(frequency).all() and (frequency > 0).all()):
        raise InputError("`frequency` must be finite and > 0 Hz")
    if not (np.diff(frequency) > 0).all():
        raise InputError("`frequency` must be ascending, without repeats")
    return frequency


def session_names(sweeps: xr.Dataset) -> dict[int, str]:
    """Names of named sessions by number. Raises InputError if the attribute is malformed."""
    try:
        names = objects(str(sweeps.attrs.get(SESSIONS, "{}")))
        return {int(number): str(name) for number, name in names.items()}
    except (ValueError, AttributeError) as error:
        raise InputError(f"attribute `{SESSIONS}` must be names by number: {error}") from error


def complex_readings(sweeps: xr.Dataset) -> Complex:
    """Complex readings of the sweeps' own kind, shape (sweep, interface, frequency).

    They are impedances in ohm or gains; where only magnitudes of gains are known, their phases are
    0.
    """
    kind = kind_of(sweeps.variables)
    return kind.reading({name: ordered(sweeps.variables[name]) for name in kind.sufficient})


def impedance(sweeps: xr.Dataset) -> Complex:
    """Z = Rs + jX in ohm, shape (sweep, interface, frequency).

    Raises InputError for sweeps of another kind of readings.
    """
    kind = kind_of(sweeps.variables)
    if kind is not IMPEDANCE:
        raise InputError(f"the readings are the {kind.name}; the impedance is needed here")
    return complex_readings(sweeps)

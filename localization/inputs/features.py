"""Features of sweeps: the matrix that a localizer takes."""

from __future__ import annotations

from collections.abc import Container, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ...simulator.sweeps import InputError
from ...simulator.sweeps.errors import named
from ...simulator.sweeps.reading_quantities import GAIN, IMPEDANCE, MAGNITUDE, ReadingKind, kind_of
from ...simulator.sweeps.schema import complex_readings, taken_of
from .baselines import check_baselines, finite_sweeps, has_baseline_before, log_baselines

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

    from ...simulator.arrays import Complex, Mask, Real
    from .samples import Samples

PAPER = ("Rs", "Cp")
"""The paper's choice, and the default where the unpressed skin was not measured."""


@dataclass(frozen=True)
class FeatureNames:
    """Names of the features of one kind of readings.

    read: readings as the sweeps store them, in SI units. absolute: logarithm of the magnitude, and
    phase in rad. relative: both relative to recent baseline sweeps of the same session; the meter's
    errors of the session and most differences between skins cancel. baseline: both of the unpressed
    skin at the start of the session; they identify the skin. default: without a baseline.
    """

    read: tuple[str, ...]
    absolute: tuple[str, ...]
    relative: tuple[str, ...]
    baseline: tuple[str, ...]
    default: tuple[str, ...]

    @property
    def all(self) -> tuple[str, ...]:
        """All names."""
        return *self.read, *self.absolute, *self.relative, *self.baseline


OF_IMPEDANCE = FeatureNames(
    ("Rs", "X", "Cp"), ("lnZ", "phase"), ("dlnZ", "dphase"), ("lnZ0", "phase0"), PAPER
)
OF_GAIN = FeatureNames(
    ("gain",), ("lnG", "phaseG"), ("dlnG", "dphaseG"), ("lnG0", "phaseG0"), ("lnG", "phaseG")
)
OF_MAGNITUDE = FeatureNames(("gain",), ("lnG",), ("dlnG",), ("lnG0",), ("lnG",))
NAMES = {IMPEDANCE.name: OF_IMPEDANCE, GAIN.name: OF_GAIN, MAGNITUDE.name: OF_MAGNITUDE}

READ = (*OF_IMPEDANCE.read, *OF_GAIN.read)
ABSOLUTE = (*OF_IMPEDANCE.absolute, *OF_GAIN.absolute)
RELATIVE = (*OF_IMPEDANCE.relative, *OF_GAIN.relative)
BASELINE = (*OF_IMPEDANCE.baseline, *OF_GAIN.baseline)
"""Names of all kinds; the last three have the same order of quantities."""
QUANTITIES = (*READ, *ABSOLUTE, *RELATIVE, *BASELINE)


def names_of(variables: Container[object]) -> FeatureNames:
    """Names of the features of sweeps with variables of these names."""
    return NAMES[kind_of(variables).name]


def names_beside(quantities: Sequence[str]) -> FeatureNames:
    """Names of the kind of readings that some features are of."""
    return OF_GAIN if set(quantities) & set(OF_GAIN.all) else OF_IMPEDANCE


def are_changes(quantities: Sequence[str]) -> bool:
    """True if these features are all changes from the unpressed skin, and nothing else."""
    return tuple(quantities) in [each.relative for each in NAMES.values()]


def check_kind(quantities: Sequence[str], kind: ReadingKind) -> None:
    """Raises InputError for a feature that readings of a kind do not have."""
    allowed = NAMES[kind.name].all
    for name in quantities:
        if name not in allowed:
            needed = "impedance" if name in OF_IMPEDANCE.all else "complex gain"
            raise InputError(
                f"the feature {name} needs the {needed}, and the sweeps hold the {kind.name}; "
                f"choose of {', '.join(allowed)}"
            )


BLOCK = 10_000
"""Approximate number of sweeps per block; computing features takes ten times their memory."""


Quantities = str | Sequence[str]
"""Names of QUANTITIES, in one text joined by commas or one by one."""


def default_quantities(
    sweeps: xr.Dataset, rest: xr.Dataset | None = None, curve: int | None = None
) -> tuple[str, ...]:
    """The default features: changes from the unpressed skin, if most presses have a baseline.

    They are the `relative` ones of `FeatureNames` if `rest` is given, or if more than half of the
    pressed sweeps have a baseline sweep before them in their session, else its `default`. curve:
    number of sessions from which on the `baseline` ones join them; None for never.
    """
    names = names_of(sweeps.variables)
    pressed = sweeps["row"].values != 0
    known = has_baseline_before(sweeps)[pressed]
    if rest is None and 2 * known.sum() <= known.size:
        return names.default
    many = curve is not None and np.unique(sweeps["session"].values).size >= curve
    return (*names.relative, *names.baseline) if many else names.relative


def features(
    sweeps: xr.Dataset,
    quantities: Quantities = PAPER,
    *,
    interfaces: Sequence[str] | None = None,
    rest: xr.Dataset | None = None,
) -> Real:
    """The chosen quantities of each sweep side by side, shape (sweep, feature).

    Arguments: see `available_features`. Raises InputError as it does, and for a sweep without a
    baseline sweep before it.
    """
    X, rows = available_features(sweeps, quantities, interfaces=interfaces, rest=rest)
    check_baselines(sweeps, rows)
    return X


def available_features(
    sweeps: xr.Dataset,
    quantities: Quantities = PAPER,
    *,
    interfaces: Sequence[str] | None = None,
    rest: xr.Dataset | None = None,
) -> tuple[Real, NDArray[np.intp]]:
    """Features of the sweeps that have them, (row, feature), and their numbers, ascending.

    Sweeps with a reading that is not finite have none, and are no baseline. The order is by
    quantity, then by interface, then by ascending frequency; only readings that were taken
    (`taken_of`). interfaces: those to use, in order; by default all. rest: baseline
    sweeps, if they are not among `sweeps` (see `log_baselines`). Raises InputError for a quantity
    that is not one of QUANTITIES or needs other readings, for none, for one given twice, and for an
    interface that the sweeps lack.
    """
    names = checked_quantities(quantities)
    check_kind(names, kind_of(sweeps.variables))
    used = at_interfaces(sweeps, interfaces)
    baselines = None if rest is None else _finite(at_interfaces(rest, interfaces))
    finite = np.flatnonzero(finite_sweeps(used))
    used = _finite(used)
    width = len(names) * readings_per_sweep(used)
    X, known = np.empty((finite.size, width)), np.zeros(finite.size, dtype=bool)
    for block in _blocks(used, needs_baseline(names)):
        found, rows = _features_of_block(used.isel(sweep=block), names, baselines)
        X[block[rows]], known[block[rows]] = found, True
    return packed(X, known), finite[known]


def _finite(sweeps: xr.Dataset) -> xr.Dataset:
    """The sweeps whose readings are all finite."""
    finite = finite_sweeps(sweeps)
    return sweeps if finite.all() else sweeps.isel(sweep=finite)


def baseline_changes(
    sweeps: xr.Dataset, *, interfaces: Sequence[str] | None = None, rest: xr.Dataset | None = None
) -> Real:
    """Changes from the baseline of each sweep, shape (sweep, feature); NaN without a baseline.

    Arguments: see `available_features`; raises InputError as it does.
    """
    relative = names_of(sweeps.variables).relative
    found, rows = available_features(sweeps, relative, interfaces=interfaces, rest=rest)
    changes = np.full((sweeps.sizes["sweep"], found.shape[1]), np.nan)
    changes[rows] = found
    return changes


def in_blocks(index: NDArray[np.intp]) -> list[NDArray[np.intp]]:
    """Split indices into parts of at most BLOCK."""
    return np.array_split(index, max(1, -(-index.size // BLOCK)))


def packed(X: Real, kept: Mask) -> Real:
    """Move the kept rows to the front of the same array; return that part."""
    size = 0
    for start in range(0, len(X), BLOCK):
        block = slice(start, start + BLOCK)
        rows = X[block][kept[block]]
        X[size : size + len(rows)] = rows
        size += len(rows)
    return X[:size]


def _blocks(sweeps: xr.Dataset, by_session: bool) -> list[NDArray[np.intp]]:
    """Indices of about BLOCK sweeps each; whole sessions if `by_session`."""
    count = sweeps.sizes["sweep"]
    if not by_session or count <= BLOCK:
        return in_blocks(np.arange(count))
    session = sweeps["session"].values
    order = np.argsort(session, kind="stable")
    opening = np.flatnonzero(np.diff(session[order], prepend=session[order[0]] - 1))
    ends = opening[np.searchsorted(opening, np.arange(BLOCK, count, BLOCK), side="right") - 1]
    return [np.sort(block) for block in np.split(order, np.unique(ends[ends > 0]))]


def _features_of_block(
    sweeps: xr.Dataset, quantities: tuple[str, ...], rest: xr.Dataset | None
) -> tuple[Real, NDArray[np.intp]]:
    """`available_features` of a block of sweeps, which contains whole sessions if needed."""
    rows, known = np.arange(sweeps.sizes["sweep"]), names_of(sweeps.variables)
    found = {name: _read(sweeps, name) for name in quantities if name in READ}
    if len(found) < len(quantities):
        absolute = np.log(complex_readings(sweeps).astype(complex))
        found |= _parts(absolute, known.absolute)
    if needs_baseline(quantities):
        baselines = log_baselines(sweeps, rest)
        rows = baselines.rows
        found = {name: values[rows] for name, values in found.items()}
        found |= _parts(absolute[rows] - baselines.recent, known.relative)
        found |= _parts(baselines.opening, known.baseline)
    taken = taken_of(sweeps)
    blocks = [_flat(found[name], taken) for name in quantities]
    return np.concatenate(blocks, axis=1), rows


def _flat(values: Real, taken: Mask | None) -> Real:
    """Readings that were taken, interface by interface, shape (row, reading)."""
    if taken is not None:
        return values[:, taken]
    return values.reshape(len(values), np.prod(values.shape[1:]))


def readings_per_sweep(sweeps: xr.Dataset) -> int:
    """Number of readings in a sweep."""
    taken = taken_of(sweeps)
    whole = sweeps.sizes["interface"] * sweeps.sizes["frequency"]
    return whole if taken is None else int(taken.sum())


def taken_rows(sweeps: xr.Dataset) -> tuple[tuple[bool, ...], ...]:
    """`taken_of` as tuples; empty if all interfaces were read at all frequencies."""
    taken = taken_of(sweeps)
    return () if taken is None else tuple(tuple(row) for row in taken.tolist())


def at_interfaces(sweeps: xr.Dataset, interfaces: Sequence[str] | None) -> xr.Dataset:
    """The sweeps at these interfaces only, in that order; all interfaces for None.

    Raises InputError that names an interface that the sweeps lack, or that is given twice.
    """
    if interfaces is None:
        return sweeps
    there = [str(name) for name in sweeps["interface"].values]
    for name in interfaces:
        if name not in there:
            raise InputError(f"the sweeps have no interface {name!r}, only {', '.join(there)}")
    if not interfaces or len(set(interfaces)) < len(interfaces):
        raise InputError(
            f"{named('interfaces')} must name each once, at least one, got {list(interfaces)}"
        )
    return sweeps.isel(interface=[there.index(name) for name in interfaces])


def checked_quantities(quantities: Quantities) -> tuple[str, ...]:
    """The names as a tuple. Raises InputError as `features` does."""
    if isinstance(quantities, str):
        quantities = [name.strip() for name in quantities.split(",")]
    for name in quantities:
        if name not in QUANTITIES:
            raise InputError(
                f"{named('quantities')} must be of {', '.join(QUANTITIES)}, got {name!r}"
            )
    if not quantities or len(set(quantities)) < len(quantities):
        raise InputError(
            f"{named('quantities')} must name each once, at least one, got {list(quantities)}"
        )
    return tuple(quantities)


def chosen_quantities(
    quantities: Quantities | None, sweeps: xr.Dataset, rest: xr.Dataset | None = None
) -> tuple[str, ...]:
    """`checked_quantities`, or `default_quantities` for None."""
    return (
        default_quantities(sweeps, rest) if quantities is None else checked_quantities(quantities)
    )


def needs_baseline(quantities: Sequence[str]) -> bool:
    """True if any of the quantities needs baseline sweeps."""
    return any(name in (*RELATIVE, *BASELINE) for name in quantities)


def press_features(quantities: Sequence[str], count: int) -> tuple[NDArray[np.intp], bool]:
    """Indices of the features that a press changes most, and True if they have equal noise.

    These are the RELATIVE features if there are any, else all but the BASELINE ones. count: of all
    features of the quantities.
    """
    relative = [name for name in quantities if name in RELATIVE]
    wanted = relative or [name for name in quantities if name not in BASELINE] or list(quantities)
    blocks = np.arange(count).reshape(len(quantities), -1)
    index = np.concatenate([blocks[quantities.index(name)] for name in wanted])
    return index, not any(name in READ for name in wanted)


def _read(sweeps: xr.Dataset, name: str) -> Real:
    values = sweeps[name].transpose("sweep", "interface", "frequency").values
    return values.astype(np.float64, copy=False)


def _parts(logarithm: Complex, names: tuple[str, ...]) -> dict[str, Real]:
    """Real and imaginary parts by name; the real ones alone for one name."""
    return dict(zip(names, (np.real(logarithm), np.imag(logarithm)), strict=False))


class Features(tuple["NDArray[Any]", "NDArray[Any]"]):
    """The features X and the targets y of sweeps; unpacks into these two arrays.

    X: shape (sweep, feature). y: shape (sweep,), for positions (sweep, 3). index: numbers of these
    sweeps among the given ones, from 0, ascending, shape (sweep,). left_out: text on the sweeps
    that were left out, with the reasons.
    """

    index: NDArray[Any]
    left_out: str
    _about: str

    @classmethod
    def of(cls, samples: Samples) -> Features:
        """The features and the targets of samples."""
        found, problem = cls((samples.X, samples.y)), samples.problem
        found.index = samples.rows
        found.left_out = samples.left_out.describe(problem.target)
        found._about = f"{problem.target}: {', '.join(problem.quantities)}"
        return found

    @property
    def X(self) -> NDArray[Any]:
        """Features, shape (sweep, feature)."""
        return self[0]

    @property
    def y(self) -> NDArray[Any]:
        """Targets, shape (sweep,), for positions (sweep, 3)."""
        return self[1]

    def __repr__(self) -> str:
        shape = "x".join(map(str, self.X.shape))
        return f"Features of {self._about}; X is {shape} (sweep, feature); sweeps {self.left_out}"

"""Joins sweeps: recordings, whose mountings become sessions; or interfaces of the same presses."""

from __future__ import annotations

import json
from collections.abc import Hashable, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import InputError
from .input_files import read
from .inputs import objects
from .reading_quantities import kind_of
from .same_skin import difference, same_frequencies
from .schema import (
    CONTACT,
    CONTACTS,
    DIMENSIONS,
    LABELS,
    SESSIONS,
    TAKEN,
    TIME,
    session_names,
    taken_of,
)

if TYPE_CHECKING:
    import xarray as xr

Source = str | Path
PER_SWEEP_ATTRIBUTES = ("times", "interface_times", "remarks", "answers")
"""Attributes that are JSON lists with an entry for each sweep."""
FLAGGED = "flagged"
"""Attribute of abnormal readings: JSON rows that start with the number of the sweep."""


def read_joined(paths: Sequence[Source]) -> xr.Dataset:
    """The sweeps of one file, or of several joined. Raises InputError as `read` and `join`."""
    return join([read(path) for path in paths], paths)


def join(parts: Sequence[xr.Dataset], sources: Sequence[Source]) -> xr.Dataset:
    """Joins the sweeps of several recordings, in order of time if known, else in the given order.

    A single recording is unchanged. Sessions of the same name become one session, all others are
    numbered consecutively. Time and estimated errors are kept if all parts have them. Attributes:
    the first scene; differing values are listed.
    Raises InputError naming a source of another skin or with other frequencies or interfaces.
    """
    if len(parts) == 1:
        return parts[0]
    if all(TIME in part.variables for part in parts):
        begun = np.array([part[TIME].values.min() for part in parts])
        order = np.argsort(begun, kind="stable")
        parts, sources = [parts[i] for i in order], [sources[i] for i in order]
    common = set.intersection(*(set(map(str, part.variables)) for part in parts))
    fitting = []
    for part, source in zip(parts, sources, strict=True):
        _check_skin(part, source, parts[0], sources[0])
        part_aligned = aligned(part, source, parts[0], sources[0])
        fitting.append(
            part_aligned.drop_vars([name for name in part.variables if name not in common])
        )
    renumbered, names = _sessions(fitting)
    named = {SESSIONS: json.dumps(names)}
    return concatenate(renumbered).assign_attrs(merged_attributes(parts) | named)


def aligned(part: xr.Dataset, path: Source, first: xr.Dataset, other: Source) -> xr.Dataset:
    """The sweeps with the exact frequencies and the interface order of the first recording.

    Raises InputError if frequencies, interfaces or the kinds of readings differ.
    """
    kind, kind_of_first = (kind_of(each.variables) for each in (part, first))
    if kind is not kind_of_first:
        raise InputError(
            f"{path}: every reading is the {kind.name}, those of {other} are the "
            f"{kind_of_first.name}"
        )
    ours, theirs = ([str(name) for name in each["interface"].values] for each in (part, first))
    if sorted(ours) != sorted(theirs):
        raise InputError(
            f"{path}: interfaces {', '.join(ours)} are not those of {other}: {', '.join(theirs)}"
        )
    f, g = part["frequency"].values, first["frequency"].values
    if f.size != g.size or not same_frequencies(f, g).all():
        raise InputError(
            f"{path}: {_range_text(f)} are not the frequencies of {other}: {_range_text(g)}"
        )
    ordered = part.isel(interface=[ours.index(name) for name in theirs])
    if not same_taken(ordered, first):
        raise InputError(
            f"{path}: its interfaces were read at other `frequencies` of their own than those of "
            f"{other}"
        )
    return ordered.assign_coords(frequency=first["frequency"])


def _range_text(frequency: np.ndarray) -> str:
    return f"{frequency.size} from {frequency[0]:.6g} to {frequency[-1]:.6g} Hz"


def _check_skin(part: xr.Dataset, source: Source, first: xr.Dataset, other: Source) -> None:
    ours, theirs = (str(each.attrs.get("scene", "")) for each in (part, first))
    differing = difference(ours, theirs)
    if differing is not None:
        raise InputError(f"{source}: is of another skin than {other}: {differing}")


def _sessions(parts: Sequence[xr.Dataset]) -> tuple[list[xr.Dataset], dict[int, str]]:
    """The parts with consecutively numbered sessions, and the names of named sessions."""
    numbers: dict[Hashable, int] = {}
    renumbered = []
    for place, part in enumerate(parts):
        names = session_names(part)
        keys = [names.get(int(each), (place, int(each))) for each in part["session"].values]
        counted = [numbers.setdefault(key, len(numbers)) for key in keys]
        session = part["session"].copy(data=np.array(counted, dtype=np.int64))
        renumbered.append(part.assign_coords(session=session))
    return renumbered, {number: key for key, number in numbers.items() if isinstance(key, str)}


def merged_attributes(parts: Sequence[xr.Dataset]) -> dict[str, Any]:
    """Attributes of joined parts; values that differ are listed, separated by semicolons."""
    merged: dict[str, Any] = {}
    for name in dict.fromkeys(str(name) for part in parts for name in part.attrs):
        values = [part.attrs[name] for part in parts if name in part.attrs]
        if name in (*PER_SWEEP_ATTRIBUTES, FLAGGED):
            if len(values) == len(parts):
                merged[name] = json.dumps(_listed(name, values, parts))
        elif name == "scene" or all(np.array_equal(value, values[0]) for value in values):
            merged[name] = values[0]
        else:
            merged[name] = "; ".join(filter(None, dict.fromkeys(map(str, values))))
    return merged


def _listed(name: str, values: Iterable[str], parts: Sequence[xr.Dataset]) -> list[Any]:
    listed, before = [], 0
    for value, part in zip(values, parts, strict=True):
        each = objects(value)
        listed += [[before + i, *rest] for i, *rest in each] if name == FLAGGED else each
        before += part.sizes["sweep"]
    return listed


def one_session(sweeps: xr.Dataset, name: str) -> xr.Dataset:
    """The sweeps, all in one session of that name."""
    session = sweeps["session"].copy(data=np.zeros(sweeps.sizes["sweep"], dtype=np.int64))
    return sweeps.assign_coords(session=session).assign_attrs({SESSIONS: json.dumps({0: name})})


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

"""Joins several recordings into one: each mounting becomes a session, attributes are merged."""

from __future__ import annotations

import json
from collections.abc import Hashable, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .concatenation import concatenate, same_taken
from .errors import InputError
from .input_files import read
from .inputs import objects
from .reading_quantities import kind_of
from .same_frequency import same_frequencies
from .same_skin import difference
from .schema import SESSIONS, TIME, session_names

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
    return concatenate(renumbered).assign_attrs(_attributes(parts, names))


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


def _attributes(parts: Sequence[xr.Dataset], names: dict[int, str]) -> dict[str, Any]:
    merged: dict[str, Any] = {}
    for name in dict.fromkeys(str(name) for part in parts for name in part.attrs):
        values = [part.attrs[name] for part in parts if name in part.attrs]
        if name in (*PER_SWEEP_ATTRIBUTES, FLAGGED):
            if len(values) == len(parts):
                merged[name] = json.dumps(_listed(name, values, parts))
        elif name == "scene" or all(np.array_equal(value, values[0]) for value in values):
            merged[name] = values[0]
        else:
            merged[name] = "; ".join(dict.fromkeys(map(str, values)))
    return {**merged, SESSIONS: json.dumps(names)}


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

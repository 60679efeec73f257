"""Baselines: sweeps of the unpressed skin, from which changes are computed.

A sweep is never part of its own baseline, whatever its label, and neither is a later sweep: in a
lab only earlier measurements are known. All sweeps of a session are compared with the same number
of baseline sweeps; otherwise the noise of the baseline would depend on the label.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...simulator.sweeps import OPENING as OF_OPENING
from ...simulator.sweeps import InputError, check, loaded, open_zarr, read
from ...simulator.sweeps.joining import join
from ...simulator.sweeps.reading_quantities import kind_of
from ...simulator.sweeps.reading_subset import read_mask
from ...simulator.sweeps.schema import complex_readings

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

    from ...simulator.arrays import Complex, Mask


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


MIN_BASELINES, RECENT, OPENING = 1, 3, 8
"""Numbers of baseline sweeps.

The first two are the minimum and maximum number of recent ones for a change, as skins drift slowly.
The last is the number at the start of a session that identify the skin.
"""
TIME = "time"
EARLY = 0.1
"""Share of a session, from its start, whose baseline sweeps are waited for."""


class Baselines(NamedTuple):
    """ln (Z / ohm) of the unpressed skin, for some of the sweeps.

    rows: numbers of these sweeps, ascending. recent: mean of the latest baseline sweeps before
    each; opening: mean of the first ones; both of shape (row, interface, frequency).
    """

    rows: NDArray[np.intp]
    recent: Complex
    opening: Complex


def log_baselines(sweeps: xr.Dataset, rest: xr.Dataset | None = None) -> Baselines:
    """The baseline that was known when each sweep was taken, in its own session.

    rest: baseline sweeps, all unpressed, of which the mean of a session is used; those of the
    opening and the latest ones separately if they are marked. If they are of one session they apply
    to every sweep. Without `rest`, the unpressed sweeps among `sweeps`, of row 0, in the order of
    their `time`, or else in file order: the latest RECENT before a sweep, or as many as there are
    before EARLY, at least MIN_BASELINES. Sweeps before these, and sessions without any, are not
    among the rows.
    """
    absolute = np.log(complex_readings(sweeps).astype(complex))
    parts = list(
        _own_baselines(sweeps, absolute)
        if rest is None
        else _given_baselines(sweeps, absolute, rest)
    )
    none = Baselines(np.zeros(0, dtype=np.intp), absolute[:0], absolute[:0])
    rows, recent, opening = (np.concatenate(each) for each in zip(none, *parts, strict=True))
    order = np.argsort(rows)
    return Baselines(rows[order], recent[order], opening[order])


def finite_sweeps(sweeps: xr.Dataset) -> Mask:
    """True for sweeps of which all readings that were taken are finite, shape (sweep,)."""
    taken = read_mask(sweeps)
    each = [
        np.isfinite(sweeps[name].transpose("sweep", "interface", "frequency").values)[:, taken]
        for name in kind_of(sweeps.variables).names
        if name in sweeps.variables
    ]
    return np.asarray(np.concatenate(each, axis=1).all(axis=1))


def check_baselines(sweeps: xr.Dataset, rows: NDArray[np.intp]) -> None:
    """Raises InputError that names a sweep with a reading that is not finite, a session without a
    baseline, or the first sweep before it."""
    unread = np.setdiff1d(np.flatnonzero(~finite_sweeps(sweeps)), rows)
    if unread.size:
        raise InputError(
            f"sweep {unread[0]}: a reading is no finite number; leave the sweep out, or take "
            "`localize`, which answers it by 'cannot tell'"
        )
    session = sweeps["session"].values
    without = np.setdiff1d(session, session[rows])
    if without.size:
        raise InputError(
            f"session {without[0]} has no sweep of the unpressed skin, from which changes by its "
            "touches are taken"
        )
    early = np.setdiff1d(np.arange(session.size), rows)
    if early.size:
        raise InputError(
            f"sweep {early[0]}: too few sweeps of the unpressed skin come before it in session "
            f"{session[early[0]]}"
        )


def has_baseline_before(sweeps: xr.Dataset) -> Mask:
    """True for sweeps with a baseline sweep before them in their session, (sweep,)."""
    known = np.zeros(sweeps.sizes["sweep"], dtype=bool)
    for here, moments, count in _baseline_sweeps(sweeps):
        known[here[moments[count - 1] + 1 :]] = True
    return known


def _baseline_sweeps(
    sweeps: xr.Dataset,
) -> Iterator[tuple[NDArray[np.intp], NDArray[np.intp], int]]:
    """Yield the baseline sweeps of each session that has any.

    These are the indices of its sweeps in time order, the positions of the baseline sweeps among
    them, and the number of latest baseline sweeps to average.
    """
    session, unpressed = sweeps["session"].values, sweeps["row"].values == 0
    for each in np.unique(session[unpressed]):
        here = _in_time(sweeps, np.flatnonzero(session == each))
        moments = np.flatnonzero(unpressed[here])
        count = max(MIN_BASELINES, int(np.count_nonzero(moments[:RECENT] < EARLY * here.size)))
        yield here, moments, count


def _own_baselines(sweeps: xr.Dataset, absolute: Complex) -> Iterator[Baselines]:
    for here, moments, count in _baseline_sweeps(sweeps):
        later = np.arange(moments[count - 1] + 1, here.size)
        rows, known = here[later], np.searchsorted(moments, later)
        baselines = absolute[here[moments]]
        recent = baselines[known[:, None] - np.arange(count) - 1].mean(axis=1)
        firsts = np.stack([baselines[:count].mean(axis=0), baselines[:OPENING].mean(axis=0)])
        yield Baselines(rows, recent, firsts[(known >= OPENING).astype(int)])


def _given_baselines(
    sweeps: xr.Dataset, absolute: Complex, rest: xr.Dataset
) -> Iterator[Baselines]:
    known, wanted = rest["session"].values, sweeps["session"].values
    if np.unique(known).size == 1:
        known, wanted = np.zeros_like(known), np.zeros_like(wanted)
    baselines = np.log(complex_readings(rest).astype(complex))
    for session in np.intersect1d(wanted, known):
        here, of_session = np.flatnonzero(wanted == session), known == session
        means = [_mean_of_others(absolute[here], baselines[of_session & of]) for of in _parts(rest)]
        (recent, there), (opening, _) = means
        yield Baselines(here[there], recent[there], opening[there])


def mean_baselines(rest: xr.Dataset) -> tuple[Complex, Complex]:
    """Means of ln (Z / ohm) of the latest baseline sweeps, and of those of the opening.

    Both are the mean of all if the opening is not marked. Shape (interface, frequency) each.
    """
    known = np.log(complex_readings(rest).astype(complex))
    latest, opening = (known[part].mean(axis=0) for part in _parts(rest))
    return latest, opening


def _parts(rest: xr.Dataset) -> tuple[Mask, Mask]:
    """Masks of the latest baseline sweeps and of those of the opening; all if not marked."""
    if OF_OPENING not in rest.coords:
        every = np.ones(rest.sizes["sweep"], dtype=bool)
        return every, every
    opening = rest[OF_OPENING].values.astype(bool)
    return ~opening, opening


def _mean_of_others(curves: Complex, baselines: Complex) -> tuple[Complex, Mask]:
    """Mean of the baseline sweeps other than the sweep itself, and True if there are any."""
    names = {curve.tobytes() for curve in baselines}
    own = np.array([curve.tobytes() in names for curve in curves])
    others = len(baselines) - own
    total = baselines.sum(axis=0) - np.where(own[:, None, None], curves, 0)
    return total / np.maximum(others, 1)[:, None, None], others > 0


def _in_time(sweeps: xr.Dataset, here: NDArray[np.intp]) -> NDArray[np.intp]:
    """The numbers of these sweeps in the order in which they were taken."""
    if TIME not in sweeps.coords:
        return here
    return here[np.argsort(sweeps[TIME].values[here], kind="stable")]

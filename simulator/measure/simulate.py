"""Sweeps of a scene's presses: noise-free, and with the presses of another recording."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from importlib.metadata import version
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Mask, Real
from ..models.solution import Solution
from ..models.solver import Solver
from ..press.press import Press, check_press, label_of, press_on
from ..scene.parts import Meter, SceneParts, Setup
from ..sweeps import InputError, SweepTable, build, concatenate
from ..sweeps.free_space import check_memory
from ..sweeps.reading_subset import read_mask, restricted
from ..sweeps.schema import complex_readings
from .foam_state import solved_in_time
from .readout import read_out

if TYPE_CHECKING:
    import xarray as xr


BYTES_FOR_READING = 120
"""Memory for a reading, bytes: Z and its errors; Rs, X, Cp and their errors; a copy while
written."""


def check_fits(setup: Setup, presses: int) -> None:
    """Raise InputError if sweeps of that many presses would not fit in memory."""
    readings = len(setup.interfaces) * len(setup.frequency)
    check_memory(
        BYTES_FOR_READING * presses * readings,
        f"{presses} sweeps of {readings} readings",
        "request fewer presses, frequencies or interfaces",
    )


def simulate(solver: Solver, presses: Iterable[Press]) -> xr.Dataset:
    """Noise-free sweeps, one for each press, with their estimated numerical errors.

    Raises InputError if there is no press or one does not fit the scene, ToleranceError if the
    tolerance is not reached.
    """
    return gather(solver, answered(solver, presses)).dataset()


def answered(solver: Solver, presses: Iterable[Press]) -> Iterator[tuple[Press, Solution]]:
    """Each press with its solution; a repeated press is solved once.

    For foam that creeps they are those of a session, see `solved_in_time`. Raises InputError if a
    press does not fit the scene, ToleranceError if the tolerance is not reached.
    """
    if solver.skin.foam.in_time:
        yield from solved_in_time(solver, presses)
        return
    known: dict[Press, Solution] = {}
    for press in presses:
        if press not in known:
            known[press] = solver.solve(check_press(press, solver.skin))
        yield press, known[press]


def gather(solver: Solver, pairs: Iterable[tuple[Press, Solution]]) -> SweepTable:
    """Sweeps from presses that are already solved. Raises InputError if there is none."""
    found = list(pairs)
    if not found:
        raise InputError("`presses` must hold at least one press, got none")
    presses, answers = zip(*found, strict=True)
    return build(
        np.stack([answer.Z for answer in answers]),
        answers[0].frequency,
        interface=solver.setup.names,
        press=[label_of(press, solver.skin, solver.parts.plan.press) for press in presses],
        row=[press.pixel[0] for press in presses],
        column=[press.pixel[1] for press in presses],
        errors={
            name: np.stack([answer.errors[name] for answer in answers])
            for name in answers[0].errors
        },
        kind=answers[0].kind,
        attributes={
            "scene": solver.parts.text,
            "model": "; ".join(dict.fromkeys(answer.model for answer in answers)),
            "rtol": solver.rtol,
            "seed": solver.parts.plan.seed,
            "software": f"rcskin {version('rcskin')}",
        },
        taken=solver.setup.taken,
    )


def resimulated(sweeps: xr.Dataset, parts: SceneParts, frequency: Real) -> xr.Dataset:
    """Noise-free sweeps with the presses and interfaces of other sweeps.

    For foam that creeps they follow each other in the given order, session by session. frequency:
    Hz; if they are those of the sweeps, the same readings are taken as there, else all. Raises what
    `press_on` and `Solver.solve` raise.
    """
    parts = parts.read(parts.setup.taking(frequency))
    found = (_in_sessions if parts.skin.foam.in_time else _of_each)(sweeps, parts)
    again = found.sel(interface=sweeps["interface"].values)
    again = again.assign_coords(session=("sweep", sweeps["session"].values))
    same = np.array_equal(frequency, sweeps["frequency"].values)
    return restricted(again, read_mask(sweeps)) if same else again


def _of_each(sweeps: xr.Dataset, parts: SceneParts) -> xr.Dataset:
    """Simulated sweep of each press; a repeated press is solved once."""
    presses, which = np.unique(
        sweeps["press"].values.astype(object).astype(str), return_inverse=True
    )
    found = simulate(
        Solver(parts),
        [press_on(parts.skin, parts.plan.press, str(press)) for press in presses],
    )
    return found.isel(sweep=which)


def _in_sessions(sweeps: xr.Dataset, parts: SceneParts) -> xr.Dataset:
    """Simulated sweeps in sessions, each in the given order."""
    presses = [
        press_on(parts.skin, parts.plan.press, str(press)) for press in sweeps["press"].values
    ]
    return _by_session(
        sweeps["session"].values,
        lambda own: simulate(Solver(parts), [presses[k] for k in np.flatnonzero(own)]),
    )


def _by_session(session: NDArray, part: Callable[[Mask], xr.Dataset]) -> xr.Dataset:
    """Parts of sweeps, joined in the order of the sweeps. session: of each sweep."""
    order = np.argsort(np.argsort(session, kind="stable"))
    return concatenate([part(session == each) for each in np.unique(session)]).isel(sweep=order)


def read_by_meter(sweeps: xr.Dataset, meter: Meter, seed: int) -> xr.Dataset:
    """Sweeps as measured by the meter of a scene, session by session."""
    readout, random = meter.readout, np.random.default_rng(seed)
    if not sweeps.sizes["sweep"]:
        return sweeps
    session = sweeps["session"].values
    return _by_session(
        session,
        lambda own: read_out(sweeps.isel(sweep=own), readout, random, int(session[own][0])),
    )


class ReadingError(NamedTuple):
    """Standard deviation of one reading: of its modulus, as a fraction, and of its phase, rad.

    Each is one number, or has shape (frequency,).
    """

    magnitude: float | Real
    phase: float | Real


def reading_error(meter: Meter, sweeps: xr.Dataset) -> ReadingError | None:
    """Error of one reading by a scene's meter, with that of its session; None without noise.

    Where it depends on the reading: the root mean square over those of the sweeps, by frequency.
    """
    readout = meter.readout
    if not readout.uniform:
        readings, frequency = complex_readings(sweeps), sweeps["frequency"].values
        square = (
            readout.accuracy(readings, frequency) ** 2 + readout.noise(readings, frequency) ** 2
        )
        return ReadingError(*np.sqrt(np.nanmean(square, axis=(1, 2))))
    magnitude = math.hypot(readout.magnitude_accuracy, readout.magnitude_noise)
    phase = math.hypot(readout.phase_accuracy, readout.phase_noise)
    return ReadingError(magnitude, phase) if magnitude > 0 and phase > 0 else None

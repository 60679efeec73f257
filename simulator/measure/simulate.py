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
from ..scene.readings.changed_readings import with_frequencies
from ..scene.scene import Scene
from ..scene.scene_files import scene_text
from ..sweeps import InputError, SweepTable, build, concatenate
from ..sweeps.free_space import check_memory
from ..sweeps.reading_subset import read_mask, restricted
from ..sweeps.schema import complex_readings
from .creeping_sweeps import solved_in_time
from .readout import read_out

if TYPE_CHECKING:
    import xarray as xr


BYTES_FOR_READING = 120
"""Memory for a reading, bytes: Z and its errors; Rs, X, Cp and their errors; a copy while
written."""


def check_fits(scene: Scene, presses: int) -> None:
    """Raise InputError if sweeps of that many presses would not fit in memory."""
    readings = len(scene.interfaces) * len(scene.frequencies)
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
    if solver.scene.skin.foam.in_time:
        yield from solved_in_time(solver, presses)
        return
    known: dict[Press, Solution] = {}
    for press in presses:
        if press not in known:
            known[press] = solver.solve(check_press(press, solver.scene.parts.skin))
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
        interface=[interface.name for interface in solver.scene.interfaces],
        press=[label_of(press, solver.scene.parts.skin, solver.scene.press) for press in presses],
        row=[press.pixel[0] for press in presses],
        column=[press.pixel[1] for press in presses],
        errors={
            name: np.stack([answer.errors[name] for answer in answers])
            for name in answers[0].errors
        },
        kind=answers[0].kind,
        attributes={
            "scene": scene_text(solver.scene),
            "model": "; ".join(dict.fromkeys(answer.model for answer in answers)),
            "rtol": solver.rtol,
            "seed": solver.scene.experiment.seed,
            "software": f"rcskin {version('rcskin')}",
        },
        taken=solver.scene.taken,
    )


def resimulated(sweeps: xr.Dataset, scene: Scene, frequency: Real) -> xr.Dataset:
    """Noise-free sweeps of a scene with the presses and interfaces of other sweeps.

    For foam that creeps they follow each other in the given order, session by session. frequency:
    Hz; if they are those of the sweeps, the same readings are taken as there, else all. Raises what
    `press_on` and `Solver.solve` raise.
    """
    scene = with_frequencies(scene, frequency.tolist())
    found = _in_sessions(sweeps, scene) if scene.skin.foam.in_time else _of_each(sweeps, scene)
    again = found.sel(interface=sweeps["interface"].values)
    again = again.assign_coords(session=("sweep", sweeps["session"].values))
    same = np.array_equal(frequency, sweeps["frequency"].values)
    return restricted(again, read_mask(sweeps)) if same else again


def _of_each(sweeps: xr.Dataset, scene: Scene) -> xr.Dataset:
    """Simulated sweep of each press; a repeated press is solved once."""
    presses, which = np.unique(
        sweeps["press"].values.astype(object).astype(str), return_inverse=True
    )
    found = simulate(
        Solver(scene), [press_on(scene.parts.skin, scene.press, str(press)) for press in presses]
    )
    return found.isel(sweep=which)


def _in_sessions(sweeps: xr.Dataset, scene: Scene) -> xr.Dataset:
    """Simulated sweeps in sessions, each in the given order."""
    presses = [
        press_on(scene.parts.skin, scene.press, str(press)) for press in sweeps["press"].values
    ]
    return _by_session(
        sweeps["session"].values,
        lambda own: simulate(Solver(scene), [presses[k] for k in np.flatnonzero(own)]),
    )


def _by_session(session: NDArray, part: Callable[[Mask], xr.Dataset]) -> xr.Dataset:
    """Parts of sweeps, joined in the order of the sweeps. session: of each sweep."""
    order = np.argsort(np.argsort(session, kind="stable"))
    return concatenate([part(session == each) for each in np.unique(session)]).isel(sweep=order)


def read_by_meter(sweeps: xr.Dataset, scene: Scene, seed: int) -> xr.Dataset:
    """Sweeps as measured by the meter of a scene, session by session."""
    meter, random = scene.readout, np.random.default_rng(seed)
    if not sweeps.sizes["sweep"]:
        return sweeps
    session = sweeps["session"].values
    return _by_session(
        session,
        lambda own: read_out(sweeps.isel(sweep=own), meter, random, int(session[own][0])),
    )


class ReadingError(NamedTuple):
    """Standard deviation of one reading: of its modulus, as a fraction, and of its phase, rad.

    Each is one number, or has shape (frequency,).
    """

    magnitude: float | Real
    phase: float | Real


def reading_error(scene: Scene, sweeps: xr.Dataset) -> ReadingError | None:
    """Error of one reading by a scene's meter, with that of its session; None without noise.

    Where it depends on the reading: the root mean square over those of the sweeps, by frequency.
    """
    meter = scene.readout
    if not meter.uniform:
        readings, frequency = complex_readings(sweeps), sweeps["frequency"].values
        square = meter.accuracy(readings, frequency) ** 2 + meter.noise(readings, frequency) ** 2
        return ReadingError(*np.sqrt(np.nanmean(square, axis=(1, 2))))
    magnitude = math.hypot(meter.magnitude_accuracy, meter.magnitude_noise)
    phase = math.hypot(meter.phase_accuracy, meter.phase_noise)
    return ReadingError(magnitude, phase) if magnitude > 0 and phase > 0 else None

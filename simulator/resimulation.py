"""Sweeps simulated once more: the same presses on another scene, or the same sweeps by a meter."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from simulator.fidelity import Solver
from simulator.press import parse_press
from simulator.readout import read_out
from simulator.scene import Sweep
from simulator.scene_file import parse_scene
from simulator.simulate import simulate
from simulator.sweeps import concatenate

if TYPE_CHECKING:
    import xarray as xr


def resimulated(sweeps: xr.Dataset, text: str, frequency: NDArray[np.float64]) -> xr.Dataset:
    """The presses of sweeps on the scene that is written in TOML, noise-free. frequency: Hz.

    Raises as `parse_scene`, `parse_press` and `Solver.solve`.
    """
    asked = Sweep(frequencies=tuple(map(float, frequency)))
    scene = parse_scene(text, "scene").model_copy(update={"sweep": asked})
    presses, which = np.unique(
        sweeps["press"].values.astype(object).astype(str), return_inverse=True
    )
    factor = scene.press.capacitance_factor
    found = simulate(Solver(scene), [parse_press(str(press), factor) for press in presses])
    again = found.isel(sweep=which).sel(interface=sweeps["interface"].values)
    return again.assign_coords(session=("sweep", sweeps["session"].values))


def read_by_meter(sweeps: xr.Dataset, text: str, seed: int) -> xr.Dataset:
    """The sweeps as the meter of a scene would show them, session by session."""
    meter, random = parse_scene(text, "scene").readout, np.random.default_rng(seed)
    session = sweeps["session"].values
    order = np.argsort(np.argsort(session, kind="stable"))
    parts = [
        read_out(sweeps.isel(sweep=session == each), meter, random, int(each))
        for each in np.unique(session)
    ]
    return concatenate(parts).isel(sweep=order)


def reading_error(text: str) -> tuple[float, float] | None:
    """Standard deviations of |Z| (a fraction) and phase (rad) of one reading by a scene's meter,
    with the errors of its session; None where it has none."""
    meter = parse_scene(text, "scene").readout
    magnitude = math.hypot(meter.magnitude_accuracy, meter.magnitude_noise)
    phase = math.hypot(meter.phase_accuracy, meter.phase_noise)
    return (magnitude, phase) if magnitude > 0 and phase > 0 else None

"""Simulation of the paper's six experiments, as the meter reads them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ...simulator.measure.experiment import METER, PRESSES, planned_presses, stream
from ...simulator.measure.readout import read_out
from ...simulator.measure.simulate import simulate
from ...simulator.models.solver import Solver
from ...simulator.press.press import Press
from ...simulator.progress import ProgressCallback, tracked
from ...simulator.scene.pixel_grid import Pixels
from ...simulator.scene.scene import Scene

if TYPE_CHECKING:
    import xarray as xr

STRIPS = ("strip-1x3", "strip-1x4", "strip-1x5")
SHEETS = ("sheet-3x3", "sheet-4x4", "sheet-5x5")
EXPERIMENTS = (*STRIPS, *SHEETS)


@dataclass(frozen=True)
class SimulatedExperiment:
    """An experiment's scene, with its noise-free, measured and unpressed sweeps."""

    scene: Scene
    exact: xr.Dataset
    measured: xr.Dataset
    unpressed: xr.Dataset


def simulate_experiment(scene: Scene, progress: ProgressCallback) -> SimulatedExperiment:
    """Press every pixel as often as the scene's experiment says and read the meter each time."""
    solver = Solver(scene)
    presses = planned_presses(scene, stream(scene, PRESSES))
    exact = simulate(solver, tracked(presses, scene.name, progress))
    return SimulatedExperiment(
        scene,
        exact,
        read_out(exact, scene.readout, stream(scene, METER)),
        simulate(solver, [Press()]),
    )


def with_pixels(scene: Scene, n: int) -> Scene:
    """The scene with n x n pixels."""
    pixels = Pixels(rows=n, columns=n)
    name = f"{scene.name} on {n}x{n} pixels"
    return scene.model_copy(update={"pixels": pixels, "name": name})

"""The paper's six experiments as the meter reads them, and what it varied or left open.

The studies are of the frequencies, the meter's noise and the contact layout.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.arrays import Integer
from ...simulator.measure.experiment import METER, PRESSES, planned_presses, stream
from ...simulator.measure.readout import read_out
from ...simulator.measure.simulate import simulate
from ...simulator.models.solver import Solver
from ...simulator.press.press import Press
from ...simulator.progress import ProgressCallback, tracked
from ...simulator.scene.parts import Meter, Plan, SceneParts
from ...simulator.scene.pixel_grid import Pixels
from ...simulator.scene.scene import Scene
from ...simulator.scene.scene_files import load_scene
from ..evaluation.confusion import Confusion
from ..evaluation.evaluation import cross_validate
from ..inputs.features import PAPER

if TYPE_CHECKING:
    import xarray as xr

STRIPS = ("strip-1x3", "strip-1x4", "strip-1x5")
SHEETS = ("sheet-3x3", "sheet-4x4", "sheet-5x5")
EXPERIMENTS = (*STRIPS, *SHEETS)
DRAWS = 5
NOISE_MULTIPLES = (0.1, 0.3, 1.0, 3.0, 10.0)
CHOICES = {"10 low": slice(10), "10 spread": slice(None, None, 2), "20": slice(None)}
QUANTITIES = {"Cp": ("Cp",), "Rs and Cp": ("Rs", "Cp")}
LAYOUTS = {"same edge": "sheet-5x5", "crossed": "sheet-5x5-crossed"}
LAYOUT_PIXELS = (3, 4, 5)
LAYOUT_MULTIPLES = (0.1, 1.0)
STUDY_RTOL = 1e-3


@dataclass(frozen=True)
class SimulatedExperiment:
    """An experiment's scene, with its noise-free, measured and unpressed sweeps."""

    scene: Scene
    exact: xr.Dataset
    measured: xr.Dataset
    unpressed: xr.Dataset


def simulate_experiment(scene: Scene, progress: ProgressCallback) -> SimulatedExperiment:
    """Press every pixel as often as the scene's experiment says and read the meter each time."""
    solver = Solver(scene.parts)
    presses = planned_presses(scene.parts.skin, scene.parts.plan, stream(scene.parts.plan, PRESSES))
    exact = simulate(solver, tracked(presses, scene.name, progress))
    return SimulatedExperiment(
        scene,
        exact,
        read_out(exact, scene.readout, stream(scene.parts.plan, METER)),
        simulate(solver, [Press()]),
    )


def with_pixels(scene: Scene, n: int) -> Scene:
    """The scene with n x n pixels."""
    pixels = Pixels(rows=n, columns=n)
    name = f"{scene.name} on {n}x{n} pixels"
    return scene.model_copy(update={"pixels": pixels, "name": name})


@dataclass(frozen=True)
class Results:
    """Experiments and their confusions by scene, and the studies.

    finer: confusion of the 5x5 sheet pressed on 6x6 pixels. fewest, pooled: `fewest_frequencies`
    and `pooled_counts` of the 1x5 strip.
    """

    experiments: Mapping[str, SimulatedExperiment]
    confusions: Mapping[str, Confusion]
    frequency: xr.DataArray
    noise: xr.DataArray
    contact: xr.DataArray
    finer: Confusion
    fewest: xr.DataArray
    pooled: Integer


def frequency_study(
    experiments: Sequence[SimulatedExperiment], progress: ProgressCallback
) -> xr.DataArray:
    """Accuracy from 10 and from 20 frequencies, with Cp alone and with Rs and Cp.

    Dimensions (scene, frequencies, quantities). The ten are the lowest of the twenty, in the band
    of the paper's 1-D model, or every second one.
    """
    cases = list(itertools.product(experiments, CHOICES.values(), QUANTITIES.values()))
    return _table(
        [
            mean_accuracy(each.exact.isel(frequency=choice), each.scene, quantities=quantities)
            for each, choice, quantities in tracked(cases, "10 against 20 frequencies", progress)
        ],
        scene=[each.scene.name for each in experiments],
        frequencies=list(CHOICES),
        quantities=list(QUANTITIES),
    )


def noise_study(
    experiments: Sequence[SimulatedExperiment], progress: ProgressCallback
) -> xr.DataArray:
    """Accuracy at multiples of the scene's noise; dimensions (scene, multiple)."""
    cases = list(itertools.product(experiments, NOISE_MULTIPLES))
    return _table(
        [
            mean_accuracy(each.exact, each.scene, multiple)
            for each, multiple in tracked(cases, "accuracy against noise", progress)
        ],
        scene=[each.scene.name for each in experiments],
        multiple=NOISE_MULTIPLES,
    )


def contact_study(progress: ProgressCallback) -> xr.DataArray:
    """Accuracy with the terminals of both sheets at one edge, and at two different edges.

    Dimensions (layout, n, multiple); multiple is a multiple of the scene's noise.
    """
    accuracies = []
    for name, n in itertools.product(LAYOUTS.values(), LAYOUT_PIXELS):
        scene = with_pixels(load_scene(name), n)
        exact = exact_sweeps(scene.parts, progress)
        accuracies += [mean_accuracy(exact, scene, multiple) for multiple in LAYOUT_MULTIPLES]
    return _table(accuracies, layout=list(LAYOUTS), n=LAYOUT_PIXELS, multiple=LAYOUT_MULTIPLES)


def fewest_frequencies(experiment: SimulatedExperiment) -> xr.DataArray:
    """Accuracy from the highest frequency, the highest two, ... of a scene; dimension (count,)."""
    exact, scene = experiment.exact, experiment.scene
    counts = range(1, len(scene.frequencies) + 1)
    highest = (exact.isel(frequency=slice(-count, None)) for count in counts)
    return _table([mean_accuracy(each, scene) for each in highest], count=counts)


def pooled_counts(experiment: SimulatedExperiment) -> Integer:
    """Confusion counts (target, output), summed over DRAWS draws of the meter's noise."""
    return np.sum(
        [
            each.counts
            for each in _drawn(
                experiment.exact, experiment.scene.parts.meter, experiment.scene.parts.plan
            )
        ],
        axis=0,
    )


def crossed_cap(n: int) -> float:
    """Maximum accuracy of columns if (i, j) and (j, i) read the same: (n + 1) / 2n.

    One of two guesses is right for each such pair; pixels of the diagonal have no twin.
    """
    return (n + 1) / (2 * n)


def _table(accuracies: list[float], **coordinates: Sequence[object]) -> xr.DataArray:
    import xarray as xr

    axes = {name: list(values) for name, values in coordinates.items()}
    values = np.reshape(accuracies, [len(each) for each in axes.values()])
    return xr.DataArray(values, axes, list(axes), name="accuracy")


def exact_sweeps(parts: SceneParts, progress: ProgressCallback) -> xr.Dataset:
    """Sweeps of every planned press of a scene, to a tolerance well below the meter's noise."""
    presses = planned_presses(parts.skin, parts.plan, stream(parts.plan, PRESSES))
    return simulate(Solver(parts, rtol=STUDY_RTOL), tracked(presses, parts.skin.name, progress))


def mean_accuracy(
    exact: xr.Dataset, scene: Scene, multiple: float = 1.0, quantities: tuple[str, ...] = PAPER
) -> float:
    """Cross-validated accuracy, mean over DRAWS draws of the meter's noise and of the folds.

    multiple: of the noise of each reading.
    """
    readout = scene.readout
    names = ("magnitude_noise", "phase_noise")
    noise = {name: multiple * getattr(readout, name) for name in names}
    scene = scene.model_copy(update={"readout": readout.model_copy(update=noise)})
    return float(
        np.mean(
            [
                each.accuracy
                for each in _drawn(exact, scene.parts.meter, scene.parts.plan, quantities)
            ]
        )
    )


def _drawn(
    exact: xr.Dataset, meter: Meter, plan: Plan, quantities: tuple[str, ...] = PAPER
) -> Iterator[Confusion]:
    for draw in range(DRAWS):
        random = np.random.default_rng([plan.seed, METER, draw])
        measured = read_out(exact, meter.readout, random)
        yield cross_validate(measured, quantities=quantities, seed=draw)

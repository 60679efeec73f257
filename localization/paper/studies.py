"""Accuracy against quantities that the paper varied or left open.

These are the frequencies, the meter's noise and the contact layout.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.arrays import Integer
from ...simulator.measure.experiment import METER, PRESSES, planned_presses, stream
from ...simulator.measure.readout import read_out
from ...simulator.measure.simulate import simulate
from ...simulator.models.solver import Solver
from ...simulator.progress import ProgressCallback, tracked
from ...simulator.scene.readout.meter import Readout
from ...simulator.scene.scene import Scene
from ...simulator.scene.scene_files import load_scene
from ..evaluation.evaluation import cross_validate
from ..inputs.feature_names import PAPER
from .simulated_experiment import SimulatedExperiment, with_pixels

if TYPE_CHECKING:
    import xarray as xr

DRAWS = 5
NOISE_MULTIPLES = (0.1, 0.3, 1.0, 3.0, 10.0)
CHOICES = {"10 low": slice(10), "10 spread": slice(None, None, 2), "20": slice(None)}
QUANTITIES = {"Cp": ("Cp",), "Rs and Cp": ("Rs", "Cp")}
LAYOUTS = {"same edge": "sheet-5x5", "crossed": "sheet-5x5-crossed"}
LAYOUT_PIXELS = (3, 4, 5)
LAYOUT_MULTIPLES = (0.1, 1.0)
STUDY_RTOL = 1e-3


def frequency_study(
    experiments: Sequence[SimulatedExperiment], progress: ProgressCallback
) -> xr.DataArray:
    """Accuracy from 10 and from 20 frequencies, with Cp alone and with Rs and Cp.

    Dimensions (scene, frequencies, quantities). The ten are the lowest of the twenty, in the band
    of the paper's 1-D model, or every second one.
    """
    cases = list(itertools.product(experiments, CHOICES.values(), QUANTITIES.values()))
    accuracies = [
        mean_accuracy(
            experiment.exact.isel(frequency=choice),
            experiment.scene,
            experiment.scene.readout,
            quantities,
        )
        for experiment, choice, quantities in tracked(cases, "10 against 20 frequencies", progress)
    ]
    return _table(
        accuracies,
        scene=[experiment.scene.name for experiment in experiments],
        frequencies=list(CHOICES),
        quantities=list(QUANTITIES),
    )


def noise_study(
    experiments: Sequence[SimulatedExperiment], progress: ProgressCallback
) -> xr.DataArray:
    """Accuracy at multiples of the scene's noise; dimensions (scene, multiple)."""
    cases = list(itertools.product(experiments, NOISE_MULTIPLES))
    accuracies = [
        mean_accuracy(
            experiment.exact,
            experiment.scene,
            scaled_noise(experiment.scene.readout, multiple),
        )
        for experiment, multiple in tracked(cases, "accuracy against noise", progress)
    ]
    return _table(
        accuracies,
        scene=[experiment.scene.name for experiment in experiments],
        multiple=list(NOISE_MULTIPLES),
    )


def contact_study(progress: ProgressCallback) -> xr.DataArray:
    """Accuracy with the terminals of both sheets at one edge, and at two different edges.

    Dimensions (layout, n, multiple); multiple is a multiple of the scene's noise.
    """
    accuracies = []
    for name, n in itertools.product(LAYOUTS.values(), LAYOUT_PIXELS):
        scene = with_pixels(load_scene(name), n)
        exact = exact_sweeps(scene, progress)
        accuracies += [
            mean_accuracy(exact, scene, scaled_noise(scene.readout, multiple))
            for multiple in LAYOUT_MULTIPLES
        ]
    return _table(
        accuracies, layout=list(LAYOUTS), n=list(LAYOUT_PIXELS), multiple=list(LAYOUT_MULTIPLES)
    )


def fewest_frequencies(experiment: SimulatedExperiment) -> xr.DataArray:
    """Accuracy from the highest frequency, the highest two, ... of a scene; dimension (count,)."""
    counts = range(1, len(experiment.scene.frequencies) + 1)
    accuracies = [
        mean_accuracy(
            experiment.exact.isel(frequency=slice(-count, None)),
            experiment.scene,
            experiment.scene.readout,
        )
        for count in counts
    ]
    return _table(accuracies, count=list(counts))


def pooled_counts(experiment: SimulatedExperiment) -> Integer:
    """Confusion counts (target, output), summed over DRAWS draws of the meter's noise."""
    return np.sum(
        [
            cross_validate(measured, quantities=PAPER, seed=draw).counts
            for draw, measured in enumerate(_drawn(experiment.exact, experiment.scene))
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

    shape = [len(values) for values in coordinates.values()]
    return xr.DataArray(
        np.reshape(accuracies, shape), coordinates, list(coordinates), name="accuracy"
    )


def exact_sweeps(scene: Scene, progress: ProgressCallback) -> xr.Dataset:
    """Sweeps of every planned press of a scene, to a tolerance well below the meter's noise."""
    presses = planned_presses(scene, stream(scene, PRESSES))
    return simulate(Solver(scene, rtol=STUDY_RTOL), tracked(presses, scene.name, progress))


def mean_accuracy(
    exact: xr.Dataset, scene: Scene, readout: Readout, quantities: tuple[str, ...] = PAPER
) -> float:
    """Cross-validated accuracy, mean over DRAWS draws of the meter's noise and of the folds."""
    drawn = _drawn(exact, scene.model_copy(update={"readout": readout}))
    return float(
        np.mean(
            [
                cross_validate(measured, quantities=quantities, seed=draw).accuracy
                for draw, measured in enumerate(drawn)
            ]
        )
    )


def _drawn(exact: xr.Dataset, scene: Scene) -> Iterator[xr.Dataset]:
    for draw in range(DRAWS):
        random = np.random.default_rng([scene.experiment.seed, METER, draw])
        yield read_out(exact, scene.readout, random)


def scaled_noise(readout: Readout, multiple: float) -> Readout:
    """The meter with `multiple` times the noise of each reading."""
    return readout.model_copy(
        update={
            "magnitude_noise": multiple * readout.magnitude_noise,
            "phase_noise": multiple * readout.phase_noise,
        }
    )

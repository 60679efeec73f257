"""Execution of a study on any number of processes, from its axes to its findings."""

from __future__ import annotations

import itertools
import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import numpy as np

from ...simulator.fem.factors import one_blas_thread
from ...simulator.models.mechanics.force_depths import pressed_by_factors
from ...simulator.models.validity import warnings
from ...simulator.processes import map_in_order, worker_pool
from ...simulator.progress import ProgressCallback
from ...simulator.scene.parts import SceneParts
from ...simulator.scene.supports import supported
from ...simulator.sweeps.errors import named
from .axis import Axis, with_values
from .point import (
    MAX_RTOL,
    EvaluationSettings,
    FamilyOfSkins,
    PointFindings,
    families,
    score_point,
)

if TYPE_CHECKING:
    import xarray as xr

NEEDED = ("rcskin.localization.cli", "rcskin.localization.study.execution")
"""Modules of the command and of every task, imported once for all processes."""
NOISE_SHARE, MIN_RTOL = 0.1, 1e-7
JOBS = 4
"""Least number of jobs of each process, so that processes end at the same time."""
VARIABLES = {
    "accuracy": ("share of sweeps whose class is found, on skins not trained on", "1"),
    "accuracy_sd": ("standard deviation of the accuracy between the parts held out", "1"),
    "least_separation": ("distance of the nearest two classes over the meter's error", "1"),
    "median_separation": ("distance of two classes over the meter's error, median", "1"),
    "band_start": ("lowest frequency of the band that separates neighbours best", "Hz"),
    "band_stop": ("highest frequency of the band that separates neighbours best", "Hz"),
    "band_separation": ("distance of the nearest neighbours within that band", "1"),
}


def points_of(
    table: Mapping[str, Any], axes: Sequence[Axis], trial: EvaluationSettings
) -> list[SceneParts]:
    """The parts at every point, the last axis varying fastest.

    Raises InputError for an invalid scene.
    """
    points = []
    for values in itertools.product(*(axis.values for axis in axes)):
        given = dict(zip((axis.key for axis in axes), values, strict=True))
        parts = pressed_by_factors(supported("a study", with_values(table, given).parts))
        trial.check(parts)
        points.append(parts)
    return points


def warnings_of(points: Sequence[SceneParts]) -> list[str]:
    """Warnings of points that drive floating foils, or leave the model's range; one a kind."""
    of_model = [warnings(each.skin, each.setup, each.plan.press) for each in points]
    of_points = ([each.driven_by_touch for each in points], of_model)
    messages = [[found[0] for found in each if found] for each in of_points]
    return [
        f"{len(each)} of {len(points)} points, the first: {each[0]}" for each in messages if each
    ]


def fitting_rtol(points: Sequence[SceneParts]) -> float:
    """A tolerance that keeps errors of the simulation well below the noise of all meters."""
    noise = min(each.meter.readout.smallest_noise for each in points)
    return float(np.clip(NOISE_SHARE * noise, MIN_RTOL, MAX_RTOL))


def study(
    points: Sequence[SceneParts],
    axes: Sequence[Axis],
    trial: EvaluationSettings,
    progress: ProgressCallback,
    *,
    rtol: float | None = None,
    workers: int = 1,
) -> xr.Dataset:
    """Findings at every point of one or two axes: VARIABLES over dimensions named by keys.

    points: as in `points_of`. rtol: largest relative error of Rs and Cp; None for `fitting_rtol`.
    workers: number of processes; the result does not depend on it.
    Raises ToleranceError if the tolerance is not reached.
    """
    rtol = fitting_rtol(points) if rtol is None else rtol
    progress("accuracy", 0, len(points))
    with worker_pool(
        workers, NEEDED, f"too little memory may be the cause; fewer {named('workers')}"
    ) as pool:
        findings = _scored(points, trial, rtol, progress, pool, workers)
    attributes = {
        "scene": points[0].text,
        "target": trial.target,
        "draws": trial.draws,
        "rtol": rtol,
        "software": f"rcskin {version('rcskin')}",
    }
    return _dataset(axes, findings, attributes)


def _scored(
    points: Sequence[SceneParts],
    trial: EvaluationSettings,
    rtol: float,
    progress: ProgressCallback,
    pool: ProcessPoolExecutor | None,
    workers: int,
) -> list[PointFindings]:
    """Findings at each point. A process trains one family for all points of a job.

    Jobs of most pixels take longest and come first. Each process uses one thread, so that results
    do not depend on the pool.
    """
    sharing, most = defaultdict[FamilyOfSkins, list[int]](list), -(-len(points) // (JOBS * workers))
    for k, family in enumerate(families(points, trial, rtol)):
        sharing[family].append(k)
    each = [
        (family, own[start : start + most])
        for family, own in sharing.items()
        for start in range(0, len(own), most)
    ]
    each.sort(key=lambda job: math.prod(points[job[1][0]].skin.pixels.shape), reverse=True)
    jobs = [([points[k] for k in own], trial, family) for family, own in each]
    found = dict[int, PointFindings]()
    for (_, own), made in zip(each, map_in_order(pool, _score_points, jobs), strict=True):
        found |= zip(own, made, strict=True)
        progress("accuracy", len(found), len(points))
    return [found[k] for k in range(len(points))]


def _score_points(
    job: tuple[list[SceneParts], EvaluationSettings, FamilyOfSkins],
) -> list[PointFindings]:
    points, trial, family = job
    with one_blas_thread():
        return [score_point(each, trial, family) for each in points]


def _dataset(
    axes: Sequence[Axis], findings: Sequence[PointFindings], attributes: Mapping[str, Any]
) -> xr.Dataset:
    import xarray as xr

    names, shape = [axis.key.name for axis in axes], [len(axis.values) for axis in axes]
    accuracies = np.array([each.accuracies for each in findings])
    columns = {
        "accuracy": accuracies.mean(axis=1),
        "accuracy_sd": accuracies.std(axis=1, ddof=1 if accuracies.shape[1] > 1 else 0),
        "least_separation": [each.separation.least for each in findings],
        "median_separation": [each.separation.median for each in findings],
        "band_start": [each.separation.band_start for each in findings],
        "band_stop": [each.separation.band_stop for each in findings],
        "band_separation": [each.separation.band_separation for each in findings],
    }
    return xr.Dataset(
        {
            name: (names, np.reshape(column, shape), _described(*VARIABLES[name]))
            for name, column in columns.items()
        },
        {
            axis.key.name: (axis.key.name, list(axis.values), {"units": axis.key.unit or "1"})
            for axis in axes
        },
        attrs=dict(attributes),
    )


def _described(long_name: str, units: str) -> dict[str, str]:
    return {"long_name": long_name, "units": units}

"""A study as one object: its axes, the scoring of points, and the findings."""

from __future__ import annotations

import copy
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...simulator.chart_style import checked_chart
from ...simulator.progress import ProgressCallback, silent
from ...simulator.report.findings import DataTable, Findings, Head, Result
from ...simulator.scene.parts import SceneParts
from ...simulator.scene.scene import Scene
from ...simulator.sweeps import InputError, checked_output
from ...simulator.sweeps.errors import named
from ...simulator.sweeps.output_files import replacing
from . import execution
from .axis import READY_MADE, Axis, axes_of, find_key, scene_table, with_values
from .point import EvaluationSettings
from .report import ENDINGS, answers, describe_experiment, draw_study, spacing, write_table

if TYPE_CHECKING:
    import xarray as xr


def with_study_settings(
    table: Mapping[str, Any], max_frequency: float | None, repetitions: int | None, seed: int | None
) -> dict[str, Any]:
    """A scene's table with a study's settings; None keeps the scene's value. Raises InputError."""
    new = copy.deepcopy(dict(table))
    if repetitions is not None:
        new["experiment"]["repetitions"] = repetitions
    if seed is not None:
        new["experiment"]["seed"] = seed
    if max_frequency is not None:
        new["sweep"]["frequencies"] = _up_to(max_frequency, new["sweep"]["frequencies"])
        new["interface"] = _read_up_to(max_frequency, new["interface"])
    with_values(new, {find_key("experiment.seed", new): new["experiment"]["seed"]})
    return new


def _read_up_to(limit: float, interfaces: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The interfaces, without those of their own frequencies that are above a limit."""
    kept = []
    for each in interfaces:
        own = [f for f in each.get("frequencies", ()) if f <= limit]
        if "frequencies" in each and not own:
            raise InputError(
                f"{named('max_frequency')} {limit:g} Hz is below all `frequencies` of interface "
                f"{each['name']}"
            )
        kept.append({**each, "frequencies": own} if own else each)
    return kept


def _up_to(limit: float, frequencies: Any) -> Any:
    lowest = frequencies["start"] if isinstance(frequencies, dict) else min(frequencies)
    if not (math.isfinite(limit) and limit > lowest):
        raise InputError(
            f"{named('max_frequency')} must be finite and > {lowest:g} Hz, where the scene begins, "
            f"got {limit:g}"
        )
    if isinstance(frequencies, dict):
        return {**frequencies, "stop": limit}
    return [frequency for frequency in frequencies if frequency <= limit]


Vary = str | Sequence[str] | Mapping[str, Iterable[float]]
"""Keys and their values: texts as on the command line, or a mapping from keys to values."""


@dataclass(frozen=True, eq=False, repr=False)
class Study(Result):
    """Accuracy of localization at every value of one or two numbers of a scene.

    findings: accuracy, separation of classes, and the band that separates neighbours best, over
    dimensions named by the keys. axes: keys and values that varied. experiment: the scene, its
    frequencies, noise and presses, in one line.
    """

    findings: xr.Dataset
    axes: tuple[Axis, ...]
    experiment: str

    @property
    def best(self) -> list[str]:
        """Lines with the best value of the first key, one for each value of the second."""
        return answers(self.findings, self.axes)

    @property
    def spacing(self) -> str:
        """Spacing of the values of each key, in one line."""
        return spacing(self.axes)

    def write(self, path: str | Path, *, overwrite: bool = False) -> None:
        """Write a table.

        path: .csv or .nc. overwrite: True replaces a file that exists. Raises InputError for
        another ending, an absent folder, or a file that exists and may not be replaced.
        """
        with replacing(overwrite):
            write_table(self.findings, checked_output(path, ENDINGS))

    def plot(self, path: str | Path, *, overwrite: bool = False) -> None:
        """Draw a chart.

        path: .png, .svg or .pdf. overwrite: True replaces a file that exists. Raises InputError for
        another ending, an absent folder, or a file that exists and may not be replaced.
        """
        with replacing(overwrite):
            draw_study(self.findings, self.axes, self.experiment, checked_chart(path))

    @property
    def report(self) -> Findings:
        """The best values, and what was found at each point."""
        frame = self.findings.to_dataframe().reset_index()
        columns = [Head(str(name), form=".6g") for name in frame.columns]
        table = DataTable("study", columns, frame.values.tolist())
        return Findings(f"Study of {self.experiment}", [table, *self.best])


@dataclass(frozen=True)
class StudyPlan:
    """Points of a study before they are computed: checked parts, and settings of the score."""

    table: Mapping[str, Any]
    axes: tuple[Axis, ...]
    trial: EvaluationSettings
    points: tuple[SceneParts, ...]

    def run(
        self,
        progress: ProgressCallback = silent,
        *,
        rtol: float | None = None,
        workers: int = 1,
    ) -> Study:
        """Compute the study; arguments and errors: see `execution.study`."""
        found = execution.study(
            self.points, self.axes, self.trial, progress, rtol=rtol, workers=workers
        )
        presses = self.trial.presses(self.points[0].plan)
        return Study(found, self.axes, describe_experiment(self.table, self.axes, presses))


def plan_study(
    scene: Scene | str,
    vary: Vary | None = None,
    *,
    max_frequency: float | None = None,
    target: str = "column",
    draws: int = 1,
    repetitions: int | None = None,
    seed: int | None = None,
) -> StudyPlan:
    """Plan a study of a scene, or of the scene of that name or path.

    vary: keys and values; None takes READY_MADE. max_frequency: the meter's upper limit, Hz. draws:
    number of independent draws of skins, presses and readings. repetitions: number of presses of
    each pixel in a draw. seed: None takes the scene's. Raises InputError for an invalid key or
    value, and for scenes that cannot be scored.
    """
    table = with_study_settings(scene_table(scene), max_frequency, repetitions, seed)
    axes = axes_of(vary or READY_MADE, table)
    varied = [place[0] for axis in axes for place in axis.key.places]
    trial = EvaluationSettings(target, draws, repetitions is not None or "experiment" in varied)
    return StudyPlan(table, tuple(axes), trial, tuple(execution.points_of(table, axes, trial)))

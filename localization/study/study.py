"""A study as one object: what varies, how points are scored, and the findings."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...simulator.chart_style import checked_chart
from ...simulator.progress import ProgressCallback, silent
from ...simulator.safe_text import Tabular
from ...simulator.scene.scene import Scene
from ...simulator.sweeps import checked_output
from . import execution
from .axis import READY_MADE, Axis, axes_of
from .point import EvaluationSettings
from .report import ENDINGS, answers, describe_experiment, spacing, write_table
from .scene_keys import scene_table
from .settings import changed
from .study_figure import draw_study

if TYPE_CHECKING:
    import xarray as xr

Vary = str | Sequence[str] | Mapping[str, Iterable[float]]
"""Keys and their values: each a text as on the command line, or the values by key."""


@dataclass(frozen=True, eq=False, repr=False)
class Study(Tabular):
    """Accuracy of localization at every value of one or two numbers of a scene.

    findings: `execution.VARIABLES` over dimensions named by the keys. axes: what varied.
    experiment: the scene, its frequencies, noise and presses, in one line.
    """

    findings: xr.Dataset
    axes: tuple[Axis, ...]
    experiment: str

    @property
    def best(self) -> list[str]:
        """In one line for each value of the second key, the best value of the first."""
        return answers(self.findings, self.axes)

    @property
    def spacing(self) -> str:
        """How the values of each key are spaced, in one line."""
        return spacing(self.axes)

    def write(self, path: str | Path) -> None:
        """Write a table, .csv or .nc. Raises InputError for another ending or an absent folder."""
        write_table(self.findings, checked_output(path, ENDINGS))

    def plot(self, path: str | Path) -> None:
        """Draw a chart, .png, .svg or .pdf. Raises InputError as `write`."""
        draw_study(self.findings, self.axes, self.experiment, checked_chart(path))

    def _table(self) -> tuple[str, list[tuple[str, ...]]]:
        frame = self.findings.to_dataframe().reset_index()
        rows = [tuple(f"{value:.6g}" for value in row) for row in frame.itertuples(index=False)]
        return f"Study of {self.experiment}", [tuple(map(str, frame.columns)), *rows]


@dataclass(frozen=True)
class StudyPlan:
    """The points of a study before they are computed: checked scenes, and how they are judged."""

    table: Mapping[str, Any]
    axes: tuple[Axis, ...]
    trial: EvaluationSettings
    scenes: tuple[Scene, ...]

    def run(
        self,
        progress: ProgressCallback = silent,
        *,
        rtol: float | None = None,
        workers: int = 1,
    ) -> Study:
        """The study; arguments as of `execution.study`, which says what is raised."""
        found = execution.study(
            self.scenes, self.axes, self.trial, progress, rtol=rtol, workers=workers
        )
        return Study(found, self.axes, describe_experiment(self.table, self.axes))


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
    """A study of a scene or the one of that name or path.

    vary: READY_MADE where it is None. max_frequency: the meter's upper limit, Hz. draws: how often
    skins, presses and readings are drawn anew. repetitions: presses of each pixel in a draw. seed:
    the scene's where it is None. Raises InputError for a key or value that cannot be, and for
    scenes that cannot be judged.
    """
    table = changed(scene_table(scene), max_frequency, repetitions, seed)
    axes = axes_of(vary or READY_MADE, table)
    varied = [place[0] for axis in axes for place in axis.key.places]
    trial = EvaluationSettings(target, draws, repetitions is not None or "experiment" in varied)
    return StudyPlan(table, tuple(axes), trial, tuple(execution.scenes_of(table, axes, trial)))

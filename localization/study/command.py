"""The command `rcskin study`."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

from ...simulator.requests.argument_types import scene_of
from ...simulator.requests.number_ranges import HERTZ, REPETITIONS, RTOL, SEED, TRAININGS, WORKERS
from ...simulator.requests.options import SCENE
from ...simulator.requests.request import Writing, argument, function, option, typed
from ...simulator.safe_text import say

if TYPE_CHECKING:
    from ...simulator.scene.scene import Scene
    from .separation import Target
    from .study import Study, StudyPlan, Vary


class StudyScene(Writing, command="study", example="study sheet-5x5 -o study.csv"):
    """Accuracy of localization while one or two numbers of the scene vary.

    KEY is the dotted path of a number in the scene file, such as
    skin.foam.loss_tangent, contact.top-left.resistance or
    readout.phase_noise; skin.sheet_resistance stands for both sheets,
    pixels for rows and columns.

    At each point: the accuracy that `rcskin train` reaches on a data set of
    the scene (random skins, presses as strong as the scene says, the meter's
    noise), on skins not trained on; the distance between classes in units of
    the meter's error; and the band of frequencies that separates
    neighbours best.
    """

    scene: Scene | str | Path = argument(SCENE)
    output: Path = typed("OUT.csv or OUT.nc; the chart is OUT.png.", "--output", "-o")
    vary: Vary | None = option(
        "KEY=START:STOP:POINTS[:log|linear], of whole numbers KEY=START:STOP, or "
        "KEY=VALUE,VALUE,...; once or twice. Real numbers are spaced logarithmically "
        "unless :linear is given. Default: skin.sheet_resistance="
        "1e3:1e6:13:log and pixels=2:10.",
        kind=list[str],
        called='values by key, such as {"pixels": range(2, 11)}, or texts as in '
        "`rcskin study --vary`; by default sheet resistances and numbers of pixels.",
        default=None,
        kw_only=False,
    )
    chart: Path | None = typed(
        "Path of the chart, .png, .svg or .pdf; default: OUT.png.", default=None
    )
    max_frequency: float | None = option(
        "The meter's upper limit in Hz: a grid of frequencies ends there, of a list "
        "those above are left out.",
        within=HERTZ,
        default=None,
    )
    target: Target = option(
        "column, row or pixel.",
        among=("column", "row", "pixel"),
        called='"column", "row" or "pixel".',
        default="column",
    )
    draws: int = option(
        "Number of draws of skins, presses and readings.", within=TRAININGS, default=1
    )
    repetitions: int | None = option(
        "Presses of each pixel in a draw; default: 2000 sweeps in all.",
        within=REPETITIONS,
        default=None,
    )
    seed: int | None = option(
        "Seed of all random numbers; default: the scene's.", within=SEED, default=None
    )
    rtol: float | None = option(
        "Largest relative error of Rs, Cp, 1e-8 to 1e-2; default: well below the noise.",
        within=RTOL,
        default=None,
    )
    workers: int | None = option(
        "Number of processes; default: one for each core. The results are the same.",
        within=WORKERS,
        called="number of processes; None: one for each core; a script with more than one must "
        'call this under `if __name__ == "__main__":`.',
        default=1,
        typed_default=None,
    )

    def run(self) -> None:
        from joblib import cpu_count

        from ...simulator.chart_style import checked_chart
        from ...simulator.progress import Overall, on_terminal
        from ...simulator.requests.console import report_written, warn
        from ...simulator.requests.requested_scene import requested_scene
        from ...simulator.requests.time_estimates import note_if_long, study_parts, study_seconds
        from ...simulator.sweeps import checked_output
        from ...simulator.sweeps.units import CHANGES, accuracy_text
        from .axis import READY_MADE, axes_of, scene_table
        from .report import ENDINGS, first_lines
        from .study import with_study_settings

        default = checked_output(self.output, ENDINGS).with_suffix(".png")
        picture = checked_chart(self.chart or default)
        workers, scene = self.workers or cpu_count(), str(self.scene)
        loaded = requested_scene(scene)
        table = with_study_settings(
            scene_table(scene), self.max_frequency, self.repetitions, self.seed
        )
        count = math.prod(len(axis.values) for axis in axes_of(self.vary or READY_MADE, table))
        points = f"{count} points"
        with on_terminal() as bars:
            progress = Overall(
                "study in all",
                study_parts(loaded.parts.skin, loaded.parts.setup, count, workers),
                bars,
            )
            from .execution import warnings_of

            plan = self._plan(scene)
            for warning in warnings_of(plan.points):
                warn(f"{scene}: {warning}")
            note_if_long(
                scene, study_seconds(loaded.parts.skin, loaded.parts.setup, count, workers), points
            )
            found = plan.run(progress, rtol=self.rtol, workers=workers)
        found.write(self.output)
        found.plot(picture)
        meaning = accuracy_text(self.target, CHANGES, "sweeps of skins outside the training", scene)
        for line in (*first_lines(found.best, self.output), meaning, found.spacing):
            say(line)
        report_written(points, self.output, picture)

    def result(self) -> Study:
        """Compute the accuracy of localization while one or two numbers of a scene vary.

        Raises InputError for an invalid key or value, ToleranceError if rtol is not reached.
        """
        from joblib import cpu_count

        by_name = isinstance(self.scene, str | Path)
        plan = self._plan(str(self.scene) if by_name else scene_of(self.scene))
        return plan.run(rtol=self.rtol, workers=self.workers or cpu_count())

    def _plan(self, scene: Scene | str) -> StudyPlan:
        from .study import plan_study

        return plan_study(
            scene,
            self.vary,
            max_frequency=self.max_frequency,
            target=self.target,
            draws=self.draws,
            repetitions=self.repetitions,
            seed=self.seed,
        )


study = function(StudyScene)

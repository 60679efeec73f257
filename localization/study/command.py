"""The command `rcskin study`."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import typer

from ...simulator.requests.options import SceneName
from ...simulator.safe_text import say


def study(
    scene: SceneName,
    output: Annotated[
        Path,
        typer.Option("--output", "-o", help="OUT.csv or OUT.nc; the chart is OUT.png."),
    ],
    vary: Annotated[
        list[str] | None,
        typer.Option(
            help="KEY=START:STOP:POINTS[:log|linear], of whole numbers KEY=START:STOP, or "
            "KEY=VALUE,VALUE,...; once or twice. Real numbers are spaced logarithmically "
            "unless :linear is given. Default: skin.sheet_resistance="
            "1e3:1e6:13:log and pixels=2:10."
        ),
    ] = None,
    chart: Annotated[
        Path | None, typer.Option(help="Path of the chart, .png, .svg or .pdf; default: OUT.png.")
    ] = None,
    max_frequency: Annotated[
        float | None,
        typer.Option(
            help="The meter's upper limit in Hz: a grid of frequencies ends there, of a list "
            "those above are left out."
        ),
    ] = None,
    target: Annotated[
        str,
        typer.Option(
            help="column, row or pixel.", autocompletion=lambda: ["column", "row", "pixel"]
        ),
    ] = "column",
    draws: Annotated[int, typer.Option(help="Number of draws of skins, presses and readings.")] = 1,
    repetitions: Annotated[
        int | None,
        typer.Option(help="Presses of each pixel in a draw; default: 2000 sweeps in all."),
    ] = None,
    seed: Annotated[
        int | None, typer.Option(help="Seed of all random numbers; default: the scene's.")
    ] = None,
    rtol: Annotated[
        float | None,
        typer.Option(
            help="Largest relative error of Rs, Cp, 1e-8 to 1e-2; default: well below the noise."
        ),
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(
            help="Number of processes; default: one for each core. The results are the same."
        ),
    ] = None,
) -> None:
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
    from ...simulator.chart_style import checked_chart
    from ...simulator.progress import Overall, on_terminal
    from ...simulator.requests.console import report_written, warn
    from ...simulator.requests.requested_scene import requested_scene
    from ...simulator.requests.time_estimates import note_if_long, study_parts, study_seconds
    from ...simulator.sweeps import checked_output
    from ...simulator.sweeps.units import CHANGES, accuracy_text
    from .axis import READY_MADE, axes_of, scene_table
    from .report import ENDINGS, first_lines
    from .study import checked_workers, with_study_settings

    default = checked_output(output, ENDINGS).with_suffix(".png")
    picture = checked_chart(chart or default)
    workers = checked_workers(workers)
    loaded = requested_scene(scene)
    table = with_study_settings(scene_table(scene), max_frequency, repetitions, seed)
    count = math.prod(len(axis.values) for axis in axes_of(vary or READY_MADE, table))
    points = f"{count} points"
    with on_terminal() as bars:
        progress = Overall(
            "study in all", study_parts(loaded.parts.skin, loaded.parts.setup, count, workers), bars
        )
        from .execution import warnings_of
        from .study import plan_study

        plan = plan_study(
            scene,
            vary,
            max_frequency=max_frequency,
            target=target,
            draws=draws,
            repetitions=repetitions,
            seed=seed,
        )
        for warning in warnings_of(plan.points):
            warn(f"{scene}: {warning}")
        note_if_long(
            scene, study_seconds(loaded.parts.skin, loaded.parts.setup, count, workers), points
        )
        found = plan.run(progress, rtol=rtol, workers=workers)
    found.write(output)
    found.plot(picture)
    meaning = accuracy_text(target, CHANGES, "sweeps of skins outside the training", scene)
    for line in (*first_lines(found.best, output), meaning, found.spacing):
        say(line)
    report_written(points, output, picture)

"""What is set for a whole study: the meter's upper limit, repetitions, seed, processes."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..sweeps import InputError
from .keys import find_key, with_values

if TYPE_CHECKING:
    from .point import CrossValidate


def study_command(cross_validate: CrossValidate) -> Callable[..., None]:
    """The command, told how the localizer's accuracy is found."""

    def study(
        scene: Annotated[str, typer.Argument(help="A built-in scene's name, or a path.")],
        output: Annotated[
            Path,
            typer.Option("--output", "-o", help="OUT.csv or OUT.nc; the chart is OUT.png."),
        ],
        vary: Annotated[
            list[str] | None,
            typer.Option(
                help="KEY=START:STOP:POINTS[:log|linear], of whole numbers KEY=START:STOP, or "
                "KEY=VALUE,VALUE,...; once or twice. Without it: skin.sheet_resistance="
                "1e3:1e6:25:log and pixels=2:10."
            ),
        ] = None,
        chart: Annotated[Path | None, typer.Option(help="The chart's own name, a PNG.")] = None,
        max_frequency: Annotated[
            float | None,
            typer.Option(
                help="The meter's upper limit in Hz: a grid of frequencies ends there, of a list "
                "those above are left out."
            ),
        ] = None,
        target: Annotated[str, typer.Option(help="column, row or pixel.")] = "column",
        draws: Annotated[
            int, typer.Option(help="How often presses and readings are drawn anew.")
        ] = 3,
        repetitions: Annotated[
            int | None, typer.Option(help="Presses of each pixel in a draw; the scene's if absent.")
        ] = None,
        seed: Annotated[
            int | None, typer.Option(help="Of all random numbers; the scene's if absent.")
        ] = None,
        rtol: Annotated[
            float | None,
            typer.Option(help="Largest relative error of Rs and Cp; else what fits the noise."),
        ] = None,
        workers: Annotated[
            int | None, typer.Option(help="Processes; else one for each core. Same results.")
        ] = None,
    ) -> None:
        """How well pixels are told apart while one or two numbers of the scene vary.

        KEY is the dotted path of a number in the scene file, such as
        skin.foam.loss_tangent, contact.top-left.resistance or
        readout.phase_noise; skin.sheet_resistance stands for both sheets,
        pixels for rows and columns.

        At each point: the cross-validated accuracy of the localizer, the
        distance between classes in units of the meter's error, and the band of
        frequencies that tells neighbours best.
        """
        from ..progress import on_terminal
        from ..sweeps import checked_output
        from . import run
        from .axis import READY_MADE, parse_axes
        from .figure import draw_study
        from .keys import scene_table
        from .point import Trial
        from .report import ENDINGS, answers, experiment_told, write_table

        beside = checked_output(output, ENDINGS).with_suffix(".png")
        picture = checked_output(chart or beside, (".png",))
        rtol, workers = checked_rtol(rtol), checked_workers(workers)
        table = changed(scene_table(scene), max_frequency, repetitions, seed)
        axes = parse_axes(vary or READY_MADE, table)
        trial = Trial(target, draws)
        scenes = run.scenes_of(table, axes, trial)
        for warning in run.warnings_of(scenes):
            typer.echo(f"rcskin: warning: {scene}: {warning}", err=True)
        with on_terminal() as track:
            findings = run.study(
                scenes, axes, trial, cross_validate, track, rtol=rtol, workers=workers
            )
        write_table(findings, output)
        draw_study(findings, axes, experiment_told(table, axes), picture)
        for line in answers(findings, axes):
            typer.echo(line)

    return study


MOST_WORKERS = 256


def changed(
    table: Mapping[str, Any], max_frequency: float | None, repetitions: int | None, seed: int | None
) -> dict[str, Any]:
    """A scene's table with a study's settings; None leaves what is there. Raises InputError."""
    new = copy.deepcopy(dict(table))
    if repetitions is not None:
        new["experiment"]["repetitions"] = repetitions
    if seed is not None:
        new["experiment"]["seed"] = seed
    if max_frequency is not None:
        new["sweep"]["frequencies"] = _up_to(max_frequency, new["sweep"]["frequencies"])
    with_values(new, {find_key("experiment.seed", new): new["experiment"]["seed"]})
    return new


def checked_workers(count: int | None) -> int:
    """The number of processes, one for each core for None. Raises InputError."""
    if count is None:
        from joblib import cpu_count

        return cpu_count()
    if not 1 <= count <= MOST_WORKERS:
        raise InputError(f"--workers must be from 1 to {MOST_WORKERS}, got {count}")
    return count


def checked_rtol(rtol: float | None) -> float | None:
    """The same tolerance. Raises InputError."""
    if rtol is not None and not (math.isfinite(rtol) and rtol > 0):
        raise InputError(f"`rtol` must be finite and > 0, got {rtol:g}")
    return rtol


def _up_to(limit: float, frequencies: Any) -> Any:
    lowest = frequencies["start"] if isinstance(frequencies, dict) else min(frequencies)
    if not (math.isfinite(limit) and limit > lowest):
        raise InputError(
            f"--max-frequency must be finite and > {lowest:g} Hz, where the scene begins, "
            f"got {limit:g}"
        )
    if isinstance(frequencies, dict):
        return {**frequencies, "stop": limit}
    return [frequency for frequency in frequencies if frequency <= limit]

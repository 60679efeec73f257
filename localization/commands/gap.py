"""The command `rcskin gap`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ...simulator.safe_text import say, terminal
from . import options
from .options import with_option_names

if TYPE_CHECKING:
    from ..gap.gap_findings import GapFindings


@with_option_names
def gap(
    simulated: Annotated[Path, typer.Argument(help="Simulated sweeps, .nc, .zarr or .csv.")],
    measured: Annotated[
        list[Path], typer.Argument(help="Sweeps of the skin itself, or of a twin; joined.")
    ],
    output: Annotated[
        Path, typer.Option("--output", "-o", help="Folder for gap.html and gap.json.")
    ],
    scene: Annotated[
        str | None,
        typer.Option(
            help="Scene of the simulated sweeps; default: the scene that they store.",
            autocompletion=options.complete_scene,
        ),
    ] = None,
    target: Annotated[
        str | None,
        typer.Option(
            help="column (the default), row or pixel.",
            autocompletion=lambda: ["column", "row", "pixel"],
        ),
    ] = None,
    estimator: Annotated[
        str | None,
        typer.Option(
            help="Name of the localizer; default: ksvm-ovo.",
            autocompletion=options.complete_estimator,
        ),
    ] = None,
    own: Annotated[
        Path | None,
        typer.Option("--model", help="Test this model, MODEL.npz, instead of training one."),
    ] = None,
    seed: Annotated[int, typer.Option(help="Seed of all random numbers.")] = 0,
    draws: Annotated[int, typer.Option(help="Number of random draws of the added sweeps.")] = 5,
    calibration_touches: Annotated[
        int, typer.Option(help="Number of pressed sweeps that calibrate; they are never tested.")
    ] = 5,
    anyway: Annotated[
        bool, typer.Option("--anyway", help="Accept sweeps of another skin.")
    ] = False,
    charts: Annotated[
        str | None, typer.Option(help="Also write the charts as files: png, svg or pdf.")
    ] = None,
) -> None:
    """Compare simulated with measured sweeps, and find what explains the gap.

    The report has distances of Rs and Cp, accuracies of a localizer trained on
    simulation and on a few touches, before and after calibration, distances of
    the features' distributions, and the parameter that explains most. With
    --model, your own model is tested instead, unchanged and adapted by a few
    touches, and its probabilities are compared with the truth.
    """
    from ...simulator.chart_style import checked_ending
    from ...simulator.progress import on_terminal
    from ...simulator.requests.requested_scene import requested_scene, warn_of_earth
    from ...simulator.sweeps import checked_folder, made_folder, read, read_joined
    from ..gap.comparison import prepare_comparison
    from ..gap.gap_findings import find_gap
    from ..gap.options import gap_options
    from ..gap.pair import checked_pair
    from ..gap.report.html_report import HTML, JSON, write_report
    from .model_notes import load_model_for

    ending = None if charts is None else checked_ending(charts)
    sides = read(simulated), read_joined(measured)
    model = None if own is None else load_model_for(sides[1], measured, own, any_skin=anyway)
    settings = gap_options(target, estimator, model, seed, draws, calibration_touches)
    named = requested_scene(scene) if scene else None
    names = str(simulated), ", ".join(map(str, measured))
    pair = checked_pair(*sides, names, named, model, seed, any_skin=anyway)
    checked_folder(made_folder(output), JSON, HTML)
    with on_terminal() as progress:
        findings = find_gap(prepare_comparison(pair, settings, model), progress)
    write_report(output, findings, ending)
    _show(findings, output / HTML)
    if pair.scene is not None:
        warn_of_earth(pair.scene.name, pair.scene.parts.skin)


def _show(findings: GapFindings, report: Path) -> None:
    from ...simulator.report.files import table
    from ..gap.report.sentences import accuracy_table

    header, *rows = accuracy_table(findings)
    terminal().print(table(header, rows))
    say(*findings.summary, *findings.notes, _written(findings, report))


def _written(findings: GapFindings, report: Path) -> str:
    pair = findings.trial.pair
    ours, theirs = pair.simulated.sizes["sweep"], pair.other.sizes["sweep"]
    return f"gap: {ours} simulated and {theirs} {pair.label.adjective} sweeps -> {report}"

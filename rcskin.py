"""The front door: the `rcskin` command, wiring simulator, localization and hardware together."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hardware.cli import meter_app
from hardware.errors import MeterError
from hardware.given import SceneData, Simulation
from simulator.cli import app, run
from simulator.study.command import study_command

if TYPE_CHECKING:
    import xarray as xr

    from hardware.virtual.skin import Readout, Skin

__all__ = ["app", "main"]


@app.command()
def reproduce(
    output: Annotated[
        Path, typer.Option("--output", "-o", help="Folder for figures, tables and report.html.")
    ] = Path("results"),
) -> None:
    """Reproduce the paper: its figures and confusion matrices, and its numbers beside ours."""
    from rich.console import Console

    from localization.confusion import write_csv
    from localization.evaluation import cross_validate
    from localization.model import train
    from localization.model_file import save
    from localization.plot import draw_confusion
    from simulator.paper.localizer import Localizer
    from simulator.paper.reproduce import reproduce as reproduce_paper
    from simulator.progress import on_terminal

    localizer = Localizer(
        cross_validate=cross_validate,
        draw=draw_confusion,
        write=write_csv,
        save=lambda sweeps, path: save(path, train(sweeps)),
    )
    with on_terminal() as track:
        claims = reproduce_paper(output, localizer, track)
    agreeing = sum(claim.agrees for claim in claims)
    Console().print(
        f"{agreeing} of the paper's {len(claims)} statements agree; see {output / 'report.html'}",
        soft_wrap=True,
    )


def _accuracy(sweeps: xr.Dataset, *, target: str, folds: int, seed: int) -> float:
    from sklearn import config_context

    from localization.evaluation import cross_validate

    with config_context(assume_finite=True, skip_parameter_validation=True):
        return cross_validate(sweeps, target, folds=folds, seed=seed).accuracy


app.command("study")(study_command(_accuracy))


def _scene_data(name: str, interface: str | None) -> SceneData:
    from simulator.scene_file import load_scene, scene_text
    from simulator.specimen import checked_interface

    scene = load_scene(name)
    return SceneData(
        name=scene.name,
        text=scene_text(scene),
        frequencies=scene.sweep.frequencies,
        rows=scene.pixels.rows,
        columns=scene.pixels.columns,
        interface=checked_interface(interface, scene),
    )


def _skin(data: SceneData) -> Skin:
    from simulator.scene_file import parse_scene
    from simulator.specimen import Specimen

    return Specimen(parse_scene(data.text, data.name), data.interface)


def _readout(data: SceneData, seed: int) -> Readout:
    from simulator.scene_file import parse_scene
    from simulator.specimen import SessionErrors

    errors = SessionErrors(parse_scene(data.text, data.name), seed)
    return lambda Z, conditions: errors.read(Z, conditions.range)


app.add_typer(meter_app(Simulation(_scene_data, _skin, _readout)), name="meter")


def main() -> None:
    """Run the command line."""
    run((MeterError,))


if __name__ == "__main__":
    main()

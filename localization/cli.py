"""Commands of the localizer: study, train, evaluate, localize, adapt, gap, export, reproduce."""

from __future__ import annotations

import typer

from .commands.adapt import adapt
from .commands.evaluate import evaluate
from .commands.export import export
from .commands.gap import gap
from .commands.localize import localize
from .commands.train import train
from .paper.command import reproduce
from .study.command import study

EXAMPLES = {
    reproduce: None,
    study: "rcskin study sheet-5x5 -o study.csv",
    gap: "rcskin gap all.nc run.nc -o gap",
    train: "rcskin train skins.zarr -o columns.npz",
    adapt: "rcskin adapt columns.npz run.nc -o better.npz",
    evaluate: "rcskin evaluate columns.npz all.nc -o found",
    localize: "rcskin localize columns.npz all.nc",
    export: "rcskin export skins.zarr -o skins.csv",
}


def add_commands(app: typer.Typer) -> None:
    """Add the localizer's commands, each with an example."""
    for command, example in EXAMPLES.items():
        app.command(epilog=example and f"Example: {example}")(command)

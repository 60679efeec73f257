"""The localizer's commands: studies, training, evaluation and use of localizers."""

from __future__ import annotations

import typer

from .commands.adapt import adapt
from .commands.evaluate import evaluate
from .commands.gap import gap
from .commands.localize import localize
from .commands.train import train
from .paper.command import reproduce
from .study.command import study


def add_commands(app: typer.Typer) -> None:
    """Add the localizer's commands."""
    for command in (reproduce, study, gap, train, adapt, evaluate, localize):
        app.command()(command)

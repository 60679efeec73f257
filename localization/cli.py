"""The localizer's commands: train it, evaluate it, and let it tell where sweeps were pressed."""

from __future__ import annotations

import typer

from .commands.adapt import adapt
from .commands.evaluate import evaluate
from .commands.localize import localize
from .commands.train import train


def add_commands(app: typer.Typer) -> None:
    """Add the localizer's commands."""
    for command in (train, adapt, evaluate, localize):
        app.command()(command)

"""The localizer's commands: train it, evaluate it, and let it tell where sweeps were pressed."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

import typer

from localization.evaluate_command import evaluate_command
from localization.localize_command import localize_command
from localization.train_command import train_command

if TYPE_CHECKING:
    from localization.estimators import Estimator


def add_commands(app: typer.Typer, extra: Callable[[], Iterable[Estimator]] = tuple) -> None:
    """Add `train`, `evaluate` and `localize`; extra tells estimators beside those of here."""
    app.command("train")(train_command(extra))
    app.command("evaluate")(evaluate_command(extra))
    app.command("localize")(localize_command(extra))

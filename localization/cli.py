"""The localizer's commands: train it, evaluate it, and let it tell where sweeps were pressed."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

import typer

from .commands.adapt import adapt_command
from .commands.evaluate import evaluate_command
from .commands.localize import localize_command
from .commands.options import Progress
from .commands.train import train_command

if TYPE_CHECKING:
    from .evaluation.plan import Plan
    from .inputs.touches import Factors
    from .learners.registry import Estimator


def add_commands(
    app: typer.Typer,
    progress: Progress,
    plan: Callable[[str], Plan | None],
    checked_ending: Callable[[str], str],
    factors: Factors,
    extra: Callable[[], Iterable[Estimator]] = tuple,
) -> None:
    """Add `train`, `adapt`, `evaluate` and `localize`; extra tells estimators beside those of here.

    progress: opens what tells how far work has come. plan: of a scene's text, the skin from above.
    checked_ending: the ending of charts by its name, such as svg; raises InputError.
    factors: of touches by depth or force, from the texts of a scene and a press.
    """
    app.command("train")(train_command(extra, progress, factors))
    app.command("adapt")(adapt_command(extra, factors))
    app.command("evaluate")(evaluate_command(extra, progress, plan, checked_ending, factors))
    app.command("localize")(localize_command(extra))

"""The command `rcskin train`."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from . import options

if TYPE_CHECKING:
    from ..learners.registry import Estimator
    from ..model.model import Model


def train_command(extra: Callable[[], Iterable[Estimator]]) -> Callable[..., None]:
    """The command, told of further estimators."""

    def train(
        sweeps: Annotated[Path, typer.Argument(help=options.SWEEPS)],
        output: Annotated[Path, typer.Option("--output", "-o", help="MODEL.skops.")],
        target: options.Target = "column",
        name: options.Name = None,
        quantities: options.Quantities = options.PAPER,
        interface: options.Interfaces = None,
        certain: options.Certain = None,
        tune: options.Tune = False,
        most: options.Most = options.MOST_SWEEPS,
    ) -> None:
        """Train a localizer on sweeps whose presses are known.

        Its probabilities, or standard deviations of positions, are found on
        sweeps held out: whole sessions where there are three or more. Sweeps
        that are like none of the training are answered 'cannot tell'; that
        nothing is pressed, only where the training shows the skin at rest.
        """
        from ...simulator.sweeps import checked_output
        from ..inputs.reading import read_some
        from ..learners.registry import estimators
        from ..model.file import ENDING, save
        from ..model.model import train as train_model

        checked_output(output, (ENDING,))
        model = train_model(
            read_some(sweeps, most),
            target,
            name,
            quantities=quantities.split(","),
            interfaces=interface,
            certain=certain,
            tune=tune,
            registry=estimators(extra()),
        )
        save(output, model)
        for line in _told(model):
            typer.echo(f"{output}: {line}")

    return train


def _told(model: Model) -> list[str]:
    """What a user should know of a model just trained."""
    seen = f"{', '.join(model.quantities)} at {', '.join(model.interfaces)}"
    lines = [
        f"{model.target} by {model.estimator} from {seen}, {len(model.frequencies)} frequencies; "
        f"{model.trained_on} sweeps, {model.left_out} without a {model.target} left out",
        f"judged by {model.validation}",
    ]
    if model.certain is not None:
        lines.append(f"answers only where it is right at a rate of {model.certain:g} or more")
    if not model.knows_rest:
        lines.append("cannot tell that nothing is pressed: the sweeps show no skin at rest")
    return lines

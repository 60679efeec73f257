"""The command `rcskin localize`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from . import options

if TYPE_CHECKING:
    import xarray as xr

    from ..learners.registry import Estimator
    from ..model.model import Model


def localize_command(extra: Callable[[], Iterable[Estimator]]) -> Callable[..., None]:
    """The command; extra tells estimators beside those of this package."""

    @options.as_typed
    def localize(
        model: Annotated[Path, typer.Argument(help="MODEL.skops.")],
        sweeps: Annotated[list[Path], typer.Argument(help=options.SWEEPS)],
        output: Annotated[
            Path | None, typer.Option("--output", "-o", help="OUT.csv, instead of the terminal.")
        ] = None,
        rest: options.Rest = None,
        most: options.Most = options.MOST_SWEEPS,
        anyway: options.Anyway = False,
    ) -> None:
        """Tell where sweeps were pressed, each with its probability.

        A line for each sweep: the answer, or 'cannot tell'; how probable the best
        answer is; and of positions x and y in mm and the strength, with their
        standard deviations, where there is one touch to place.
        """
        from ...simulator.sweeps import checked_output
        from ..evaluation.report import write_table
        from ..inputs.reading import read_some
        from ..trust.answers import CANNOT_TELL
        from .asking import model_for

        if output is not None:
            checked_output(output, (".csv",))
        resting = None if rest is None else read_some(rest, most)
        asked = read_some(sweeps, most)
        told = model_for(asked, sweeps, model, extra(), anyway=anyway)
        header, rows = _table(told, asked, resting)
        if output is not None:
            write_table(output, header, rows)
            silent = sum(row[2] == CANNOT_TELL for row in rows)
            typer.echo(f"answers: {len(rows)} sweeps, {silent} cannot be told -> {output}")
            return
        for row in (header, *rows):
            typer.echo(",".join(f'"{cell}"' if "," in cell else cell for cell in row))

    return localize


def _table(
    model: Model, sweeps: xr.Dataset, rest: xr.Dataset | None
) -> tuple[list[str], list[list[str]]]:
    from ..inputs.targets import COORDINATES

    told = model.answers(sweeps, rest)
    header = ["sweep", "press", "answer", "probability"]
    places = iter(lambda: [], None)
    if model.target == "position":
        header += [*COORDINATES, *(f"{name}_deviation" for name in COORDINATES)]
        places = _places(model, sweeps, rest, told.labels == "1")
    texts = sweeps["press"].values.astype(str)
    answered = zip(texts, told.labels, told.probability, places, strict=False)
    rows = [
        [str(number), text, str(label), f"{probability:.4f}", *place]
        for number, (text, label, probability, place) in enumerate(answered)
    ]
    return header, rows


def _places(
    model: Model, sweeps: xr.Dataset, rest: xr.Dataset | None, placed: object
) -> Iterator[list[str]]:
    import numpy as np

    numbers = np.hstack(model.positions(sweeps, rest))
    for row, there in zip(numbers, np.asarray(placed), strict=True):
        yield [f"{value:.4g}" if there else "" for value in row]

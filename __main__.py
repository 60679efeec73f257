"""The front door: the `rcskin` command, wiring simulator, localization and hardware together."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from .examples import EXAMPLES, OF_THE_METER
from .hardware.cli import app as meter
from .hardware.live.command import live
from .hardware.meter.errors import MeterError
from .localization.cli import add_commands
from .simulator.asked.numbers import with_ranges
from .simulator.asked.replacing import with_replacing
from .simulator.cli import app, run, with_examples
from .simulator.progress import on_terminal
from .simulator.shown import terminal

__all__ = ["app", "main"]


@app.command()
def reproduce(
    output: Annotated[
        Path, typer.Option("--output", "-o", help="Folder for figures, tables and report.html.")
    ] = Path("results"),
    charts: Annotated[str, typer.Option(help="Figures besides: svg or pdf.")] = "png",
) -> None:
    """Reproduce the paper: its figures and confusion matrices, and its numbers beside ours."""
    from sklearn import config_context

    from .localization.evaluation.confusion import write_csv
    from .localization.evaluation.evaluation import UNCHECKED, cross_validate
    from .localization.evaluation.plot import draw_confusion
    from .localization.inputs.features import PAPER
    from .localization.model.file import save
    from .localization.model.training import train
    from .localization.paper.localizer import Localizer
    from .localization.paper.reproduce import reproduce as reproduce_paper
    from .simulator.charts import checked_ending

    ending = checked_ending(charts)
    localizer = Localizer(
        cross_validate=partial(cross_validate, quantities=PAPER),
        draw=draw_confusion,
        write=write_csv,
        save=lambda sweeps, path: save(path, train(sweeps, quantities=PAPER)),
    )
    with on_terminal() as progress, config_context(**UNCHECKED):
        claims = reproduce_paper(output, localizer, progress, ending)
    agreeing = sum(claim.agrees for claim in claims)
    terminal().print(
        f"{agreeing} of the paper's {len(claims)} statements agree; see {output / 'report.html'}",
        soft_wrap=True,
    )


add_commands(app)
app.command()(live)
app.add_typer(meter, name="meter")


with_replacing(app)
with_replacing(meter, "meter")
with_examples(app, EXAMPLES)
with_examples(meter, OF_THE_METER)
with_ranges(app)
with_ranges(meter)


def main() -> None:
    """Run the command line."""
    run((MeterError,))


if __name__ == "__main__":
    main()

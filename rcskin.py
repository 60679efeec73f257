"""The front door: the `rcskin` command, wiring simulator, localization and hardware together."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from simulator.cli import app, run

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


def main() -> None:
    """Run the command line."""
    run()


if __name__ == "__main__":
    main()

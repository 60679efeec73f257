"""The command `rcskin reproduce`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ...simulator.safe_text import terminal


def reproduce(
    output: Annotated[
        Path, typer.Option("--output", "-o", help="Folder for figures, tables and report.html.")
    ] = Path("results"),
    charts: Annotated[str, typer.Option(help="Format of additional figures: svg or pdf.")] = "png",
) -> None:
    """Reproduce the paper: its figures and confusion matrices, and its numbers next to ours."""
    from ...simulator.chart_style import checked_ending
    from ...simulator.progress import on_terminal
    from . import reproduce as paper

    ending = checked_ending(charts)
    with on_terminal() as progress:
        claims = paper.reproduce(output, progress, ending)
    agreeing = sum(claim.agrees for claim in claims)
    terminal().print(
        f"{agreeing} of the paper's {len(claims)} statements agree; see {output / 'report.html'}",
        soft_wrap=True,
    )

"""The command `rcskin reproduce`."""

from __future__ import annotations

from pathlib import Path

from ...simulator.requests.request import Writing, typed
from ...simulator.safe_text import terminal


class Reproduce(Writing):
    """Reproduce the paper: its figures and confusion matrices, and its numbers next to ours."""

    output: Path = typed(
        "Folder for figures, tables and report.html.", "--output", "-o", default=Path("results")
    )
    charts: str = typed("Format of additional figures: svg or pdf.", default="png")

    def run(self) -> None:
        from ...simulator.chart_style import checked_ending
        from ...simulator.progress import on_terminal
        from . import reproduce as paper

        ending = checked_ending(self.charts)
        with on_terminal() as progress:
            claims = paper.reproduce(self.output, progress, ending)
        agreeing = sum(claim.agrees for claim in claims)
        terminal().print(
            f"{agreeing} of the paper's {len(claims)} statements agree; "
            f"see {self.output / 'report.html'}",
            soft_wrap=True,
        )

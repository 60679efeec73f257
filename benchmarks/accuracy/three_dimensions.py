"""A three-dimensional reference: foam, air, bodies and two sheets, and what two dimensions leave.

The sheets are conductors without thickness, everything else is a static problem of dielectrics, so
that (K + s C) u = 0 holds exactly, C the charges of both sheets by their potentials. C is solved by
elements graded to the sheets' edges in the plane, and exactly across each layer. Nothing but the
scene file is shared with the package's solvers.

Checks the reference by closed forms and other programs, shows how far its grids move it, then says
how large each effect of the surroundings is, and what each term of a scene's `surroundings` leaves
of Rs, Cp and the change by a press. Ends with code 1 where a check fails.

Run: OMP_NUM_THREADS=1 python benchmarks/accuracy/three_dimensions.py [--quick]
"""

from __future__ import annotations

import pandas as pd
from rcskin.benchmarks.accuracy.three_dimensions_parts.checks import checks
from rcskin.benchmarks.accuracy.three_dimensions_parts.convergence import moved
from rcskin.benchmarks.accuracy.three_dimensions_parts.drawing import draw
from rcskin.benchmarks.accuracy.three_dimensions_parts.effects import effects
from rcskin.benchmarks.accuracy.three_dimensions_parts.terms import left
from rcskin.benchmarks.bench import Run, launch, publish

NAME = "three_dimensions"


def main(run: Run) -> int:
    """All tables and the chart; the exit code."""
    passed = known_answers(run)
    for part in (other_grids, surroundings, terms):
        part(run)
    return int(not passed)


def known_answers(run: Run) -> bool:
    """Closed forms and other programs; whether all agree."""
    lines = list(checks(run))
    table = pd.DataFrame(
        [(each.what, each.expected, each.measured, _verdict(each.passed)) for each in lines],
        columns=["what", "expected", "measured", ""],
    )
    publish(run.results, f"{NAME}_checks", "Three-dimensional solve and closed forms", table)
    return all(each.passed for each in lines)


def other_grids(run: Run) -> None:
    """By how much they move the answers."""
    title = "The three-dimensional reference on other grids"
    publish(run.results, f"{NAME}_grids", title, moved(run))


def surroundings(run: Run) -> None:
    """How large each effect is."""
    title = "What surrounds a skin: effects on the sweeps, in three dimensions"
    publish(run.results, NAME, title, effects(run))


def terms(run: Run) -> None:
    """What each term leaves, as a table and a chart."""
    found = left(run)
    title = "Largest deviation of two-dimensional terms from the three-dimensional solve"
    publish(run.results, f"{NAME}_left", title, _rounded(found))
    draw(run.results / f"{NAME}.png", found)


def _verdict(passed: bool) -> str:
    return "pass" if passed else "**FAIL**"


def _rounded(table: pd.DataFrame) -> pd.DataFrame:
    """Three significant digits."""
    return table.map(lambda each: f"{each:.3g}" if isinstance(each, float) else each)


if __name__ == "__main__":
    launch(main)

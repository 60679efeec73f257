"""What an evaluation found, as lines for people and as tables and charts in a folder."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ...simulator.shown import charting, painting
from ...simulator.sweeps import made_folder, whole_file
from ...simulator.sweeps.cells import Writer
from ..inputs.targets import COORDINATES
from ..trust.rates import rate_told
from .confusion import write_csv
from .evaluation import ClassScore, PositionScore

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from .plan import Plan
    from .result import Evaluation

WRITTEN = ("figures.csv", "confusion.*", "belief.*", "positions.*", "regions.*")
"""Patterns of the names of what is written."""
POSITIONS = [
    *(f"true_{name}" for name in COORDINATES),
    *COORDINATES,
    *(f"{name}_deviation" for name in COORDINATES),
]


def lines_of(found: Evaluation) -> list[str]:
    """On what, then a line for each figure, with its spread over folds where there are any."""
    first = f"{len(found.score.truth)} sweeps, {found.left_out}"
    rates = found.score.rates()
    lines = [f"{first}; {found.validation}"]
    for name, (value, spread) in found.figures.items():
        if name in rates:
            folds = "" if spread is None else f"; folds differ by ± {100 * spread:.2g} %"
            lines.append(f"{name}: {rate_told(*rates[name])}{folds}")
        else:
            lines.append(f"{name}: {value:.3g}" + ("" if spread is None else f" ± {spread:.2g}"))
    if not rates.get("answered", (1, 0))[0]:
        lines.append("nothing was answered: no sweep was like the training and sure enough")
    return lines


def write_report(
    folder: Path, found: Evaluation, plan: Plan | None = None, ending: str = ".png"
) -> None:
    """Figures as a table; the confusion matrix, or all positions, as a table and a chart; and a
    chart of whether the stated probabilities, or regions, can be believed.

    folder: made where it is not there. plan: of the skin that positions are on. ending: of the
    chart.
    """
    made_folder(folder)
    with charting({}):
        _write_all(folder, found, plan, ending)


def _write_all(folder: Path, found: Evaluation, plan: Plan | None, ending: str) -> None:
    score = found.score
    table = [(name, *values) for name, values in found.figures.items()]
    write_table(folder / "figures.csv", ["figure", "value", "spread"], table)
    if isinstance(score, ClassScore):
        write_csv(score.confusion, folder / "confusion.csv")
        _save(_confusion_chart(score), folder / f"confusion{ending}")
        _save(belief_chart(score.answers.probability, score.right), folder / f"belief{ending}")
    else:
        rows = zip(score.truth, score.told, score.deviation, strict=True)
        flat = [[f"{value:.6g}" for part in row for value in part] for row in rows]
        write_table(folder / "positions.csv", POSITIONS, flat)
        _save(_position_chart(score, plan), folder / f"positions{ending}")
        _save(_region_chart(score, plan), folder / f"regions{ending}")


def write_table(path: Path, header: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """A CSV, whole or not at all."""
    with (
        whole_file(path) as unfinished,
        unfinished.open("w", newline="", encoding="utf-8") as file,
    ):
        writer = Writer(file)
        writer.writerow(header)
        writer.writerows(rows)


def belief_chart(probability: NDArray[np.float64], right: NDArray[np.bool_]) -> Figure:
    """Whether probabilities can be believed; arguments as of `draw_reliability`."""
    from matplotlib.figure import Figure

    from .belief import draw_reliability, draw_risk

    figure = Figure(figsize=(9.5, 4.4), layout="constrained")
    stated, silent = figure.subplots(1, 2)
    draw_reliability(stated, probability, right)
    draw_risk(silent, probability, right)
    return figure


def _confusion_chart(score: ClassScore) -> Figure:
    from matplotlib.figure import Figure

    from .plot import draw_confusion

    confusion = score.confusion
    side = min(14.0, max(4.5, 0.55 * len(confusion.labels)))
    figure = Figure(figsize=(side, side), layout="constrained")
    draw_confusion(figure.subplots(), confusion)
    return figure


def _position_chart(score: PositionScore, plan: Plan | None) -> Figure:
    from matplotlib.figure import Figure

    from .plan import draw_plan
    from .plot import draw_error_map, draw_errors

    figure = Figure(figsize=(9.5, 4.4), layout="constrained")
    where, how_often = figure.subplots(1, 2)
    draw_error_map(where, score.truth, score.distance)
    if plan is not None:
        draw_plan(where, plan)
    draw_errors(how_often, score.distance)
    return figure


def _region_chart(score: PositionScore, plan: Plan | None) -> Figure:
    from matplotlib.figure import Figure

    from .belief import draw_coverage, draw_regions
    from .plan import draw_plan

    figure = Figure(figsize=(9.5, 4.4), layout="constrained")
    how_often, where = figure.subplots(1, 2)
    draw_coverage(how_often, score.content)
    draw_regions(where, score.truth, score.examples)
    if plan is not None:
        draw_plan(where, plan)
    return figure


def _save(figure: Figure, path: Path) -> None:
    with painting(figure), whole_file(path) as unfinished:
        figure.savefig(unfinished, dpi=150)

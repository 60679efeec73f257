"""Results of an evaluation as lines of text, tables and charts."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.chart_style import chart
from ...simulator.notebook_display import SmallChart
from ...simulator.report.findings import Chart, DataTable, Finding, Findings, Head, rate_bars
from ..inputs.targets import COORDINATES
from ..trust.answers import BOUNDING_SESSIONS, with_intervals
from .confusion import HEADER
from .evaluation import ANSWERED, RIGHT_OF_ALL, ClassScore, PositionScore, Score

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ...simulator.scene.parts import Skin
    from .result import Evaluation


def draw_skin_outline(axes: Axes, skin: Skin | None) -> None:
    """Draw the skin's outline and foils, if known; not for a mesh from a file."""
    from ...simulator.mesh.from_above import draw_foils, draw_outline

    axes.grid(False)
    if skin is not None and skin.mesh is None:
        draw_outline(axes, skin, color="0.35", zorder=0.5)
        draw_foils(axes, skin, 3.0, clip_on=False, zorder=0.7)
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16))


WRITTEN = ("figures.csv", "confusion.*", "belief.*", "positions.*", "regions.*")
"""Patterns of the names of the files."""
PAIR = 9.5, 4.4
"""Width and height of two panels side by side, inches."""
POSITIONS = [
    *(f"true_{name}" for name in COORDINATES),
    *COORDINATES,
    *(f"{name}_deviation" for name in COORDINATES),
    "answered",
]


def report_of(found: Evaluation, skin: Skin | None = None) -> Findings:
    """Sentences, tables and charts of an evaluation.

    They are a line about the sweeps, a line for each figure with its spread over folds, the
    confusion matrix (or all positions), and a chart that compares stated probabilities (or regions)
    with the truth. Charts of positions are of the answered sweeps. skin: for positions.
    """
    rows = [(name, *values) for name, values in found.figures.items()]
    heads = [
        "figure",
        Head("value", form=".4g"),
        Head("spread", "spread over folds", ".2g"),
    ]
    score = found.score
    more = _of_classes(score) if isinstance(score, ClassScore) else _of_positions(score, skin)
    return Findings(
        f"Evaluation of {found.target}",
        [
            *_lines(found),
            DataTable("figures", heads, rows, most=0, csv=True),
            *more,
        ],
        small=lambda: _small_chart(score),
    )


def _lines(found: Evaluation) -> Iterator[str]:
    yield f"{len(found.score.truth)} sweeps, {found.left_out}; {found.validation}"
    rates = found.score.rates()
    for name, (value, spread) in found.figures.items():
        if name in rates:
            folds = "" if spread is None else f"; folds differ by ± {100 * spread:.2g} %"
            yield f"{name}: {rates[name].text}{folds}"
        else:
            yield f"{name}: {value:.3g}" + ("" if spread is None else f" ± {spread:.2g}")
    if found.sessions < BOUNDING_SESSIONS:
        few = "one session" if found.sessions == 1 else f"{found.sessions} sessions"
        yield f"{few}: too few for a bound on other skins, which takes {BOUNDING_SESSIONS}"
    if not rates[ANSWERED].count:
        yield "no sweep was answered: each is unlike the training or its answer too uncertain"


def _of_classes(score: ClassScore) -> Iterator[Finding]:
    from .reliability import draw_reliability_and_risk

    shown = score.answers.probability, score.right
    yield DataTable("confusion", HEADER, list(score.confusion.table()), most=0, csv=True)
    yield Chart("confusion", "Confusion matrix", lambda path: _draw_confusion(score, path))
    yield Chart("belief", "Reliability", lambda path: draw_reliability_and_risk(path, *shown))


def _of_positions(score: PositionScore, skin: Skin | None) -> Iterator[Finding]:
    rows = np.hstack([score.truth, score.predicted, score.deviation])
    each = zip(rows.tolist(), score.answered.astype(int).tolist(), strict=True)
    flat = [[*(f"{value:.6g}" for value in row), answered] for row, answered in each]
    yield DataTable("positions", POSITIONS, flat, most=0, csv=True)
    if score.answered.any():
        own = score.of_answered
        yield Chart("positions", "Errors", lambda path: _draw_positions(own, skin, path))
        yield Chart("regions", "Regions", lambda path: _draw_regions(own, skin, path))


def _small_chart(score: Score) -> SmallChart:
    """Chart for a notebook: rates of classes with their intervals, or errors of positions."""
    from .confusion_chart import draw_errors

    if isinstance(score, ClassScore):
        return rate_bars(with_intervals(score.rates()))
    return SmallChart(lambda figure: draw_errors(figure.subplots(), score.of_answered.distance))


def _draw_confusion(score: ClassScore, path: Path) -> None:
    from .confusion_chart import draw_confusion

    side = min(14.0, max(4.5, 0.55 * len(score.confusion.labels)))
    with chart(path, side, side) as figure:
        draw_confusion(figure.subplots(), score.confusion, RIGHT_OF_ALL.capitalize())


def _draw_positions(score: PositionScore, skin: Skin | None, path: Path) -> None:
    from .confusion_chart import draw_error_map, draw_errors

    with chart(path, *PAIR) as figure:
        where, how_often = figure.subplots(1, 2)
        draw_error_map(where, score.truth, score.distance)
        draw_skin_outline(where, skin)
        draw_errors(how_often, score.distance)


def _draw_regions(score: PositionScore, skin: Skin | None, path: Path) -> None:
    from .reliability import draw_coverage, draw_regions

    with chart(path, *PAIR) as figure:
        how_often, where = figure.subplots(1, 2)
        draw_coverage(how_often, score.content)
        draw_regions(where, score.truth, score.examples)
        draw_skin_outline(where, skin)

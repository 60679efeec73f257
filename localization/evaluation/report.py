"""Results of an evaluation as lines of text, tables and charts."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.chart_style import chart
from ...simulator.notebook_display import SmallChart
from ...simulator.report.files import filled_at_once, write_rows
from ...simulator.report.page import rate_bars
from ..inputs.targets import COORDINATES
from ..trust.answers import BOUNDING_SESSIONS, with_intervals
from .confusion import write_csv
from .evaluation import ANSWERED, RIGHT_OF_ALL, ClassScore, PositionScore, Score

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ...simulator.scene.parts import Skin
    from .result import Evaluation


def draw_skin_outline(axes: Axes, skin: Skin | None) -> None:
    """Draw the skin's outline and foils, if known; not for a mesh from a file."""
    from ...simulator.report.from_above import draw_foils, draw_outline

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


def lines_of(found: Evaluation) -> list[str]:
    """A line about the sweeps, then a line for each figure, with its spread over folds."""
    first = f"{len(found.score.truth)} sweeps, {found.left_out}"
    rates = found.score.rates()
    lines = [f"{first}; {found.validation}"]
    for name, (value, spread) in found.figures.items():
        if name in rates:
            folds = "" if spread is None else f"; folds differ by ± {100 * spread:.2g} %"
            lines.append(f"{name}: {rates[name].text}{folds}")
        else:
            lines.append(f"{name}: {value:.3g}" + ("" if spread is None else f" ± {spread:.2g}"))
    if found.sessions < BOUNDING_SESSIONS:
        few = "one session" if found.sessions == 1 else f"{found.sessions} sessions"
        lines.append(f"{few}: too few for a bound on other skins, which takes {BOUNDING_SESSIONS}")
    if not rates[ANSWERED].count:
        lines.append(
            "no sweep was answered: each is unlike the training or its answer too uncertain"
        )
    return lines


def write_report(
    folder: Path, found: Evaluation, skin: Skin | None = None, ending: str = ".png"
) -> None:
    """Write tables and charts of an evaluation.

    They are a table of the figures, the confusion matrix (or all positions) as a table and a chart,
    and a chart that compares stated probabilities (or regions) with the truth. Charts of positions
    are of the answered sweeps. folder: created if absent. skin: for positions.
    ending: format of the charts.
    """
    from .reliability import draw_reliability_and_risk

    score = found.score
    table = [(name, *values) for name, values in found.figures.items()]
    with filled_at_once(folder) as made:
        write_rows(made / "figures.csv", ["figure", "value", "spread"], table)
        if isinstance(score, ClassScore):
            write_csv(score.confusion, made / "confusion.csv")
            _draw_confusion(score, made / f"confusion{ending}")
            draw_reliability_and_risk(
                made / f"belief{ending}", score.answers.probability, score.right
            )
        else:
            rows = np.hstack([score.truth, score.predicted, score.deviation])
            each = zip(rows.tolist(), score.answered.astype(int).tolist(), strict=True)
            flat = ([*(f"{value:.6g}" for value in row), answered] for row, answered in each)
            write_rows(made / "positions.csv", POSITIONS, flat)
            if score.answered.any():
                _draw_positions(score.of_answered, skin, made / f"positions{ending}")
                _draw_regions(score.of_answered, skin, made / f"regions{ending}")


def small_chart(score: Score) -> SmallChart:
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

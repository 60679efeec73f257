"""Error against time for everything that answers: touches, depths, outlines, limits.

Sweeps of pixels have a chart of their own, see `work_precision.py`. Each way is timed from the
question to the answer, with all that it sets up, unless its name says otherwise.

Run: OMP_NUM_THREADS=1 python benchmarks/speed/answers.py [--quick] [--only TITLE]
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pandas as pd
from rcskin.benchmarks.bench import Run, launch
from rcskin.benchmarks.speed.answered_limits import LIMITS
from rcskin.benchmarks.speed.answered_presses import DEPTHS, OUTLINES, TOUCHES
from rcskin.benchmarks.speed.questions import Question
from rcskin.benchmarks.speed.work_precision import curve, looks_of
from rcskin.simulator.chart_style import chart, logarithmic_axis

if TYPE_CHECKING:
    from matplotlib.axes import Axes

QUESTIONS = {
    "touches": TOUCHES,
    "depths": DEPTHS,
    "outlines": OUTLINES,
    "limits": LIMITS,
}


def draw(path: Path, asked: list[Question], tables: list[pd.DataFrame]) -> None:
    """A panel for each question."""
    with chart(path, 14, 4.6 * -(-len(asked) // 2)) as figure:
        panels = figure.subplots(-(-len(asked) // 2), 2, squeeze=False).ravel()
        for axes, question, table in zip(panels, asked, tables, strict=False):
            _panel(axes, question, table)
        for axes in panels[len(asked) :]:
            axes.set_axis_off()


def _panel(axes: Axes, question: Question, table: pd.DataFrame) -> None:
    names = list(dict.fromkeys(table["way"]))
    looks = looks_of([name for name in names if name not in question.ours], question.ours)
    for name, rows in table.groupby("way", sort=False):
        stalls = question.stalls and name not in question.ours
        curve(axes, str(name), rows, looks[str(name)], question.wrong, stalls)
    axes.set_title(question.title, loc="left")
    logarithmic_axis(axes, question.time)
    axes.set_ylabel(question.error)
    axes.legend(loc="center left", bbox_to_anchor=(1, 0.5), fontsize=8)


def rows_of(question: Question, table: pd.DataFrame) -> pd.DataFrame:
    """As they are published."""
    return pd.DataFrame(
        {
            "question": question.title,
            "way": table["way"],
            "setting": table["setting"],
            "error": table["error"].map("{:.1e}".format),
            "time (ms)": (1e3 * table["seconds"]).map("{:.3g}".format),
        }
    )


def main(run: Run) -> None:
    """Measure, publish and draw."""
    asked = [q for name, q in QUESTIONS.items() if run.asked.only in (None, name)]
    tables = [question.measured(run) for question in asked]
    whole = pd.concat([rows_of(*each) for each in zip(asked, tables, strict=True)])
    run.publish("answers", "Error and time of answers", whole)
    draw(run.results / "answers.png", asked, tables)
    print("\n".join(question.pick for question in asked))


if __name__ == "__main__":
    launch(main, {"--only": {"choices": tuple(QUESTIONS), "help": "one question"}})

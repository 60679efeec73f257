"""The command `rcskin adapt`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ...simulator.requests.request import Writing, argument, typed
from ...simulator.safe_text import say
from .options import ANYWAY, MAX_SWEEPS, MAX_SWEEPS_READ, REST

EXTRA_FIGURES = ("calibration error", "median error, mm", "90 % error, mm")
"""Figures that are shown next to the rates."""

if TYPE_CHECKING:
    from ..adaptation import Adaptation


class Adapt(Writing, example="adapt columns.npz run.nc -o better.npz"):
    """Adapt a model to your skin by a few touches whose places are known.

    A model that learned from sweeps is corrected by an offset for each class,
    or by an affine map of its positions. A model of classes that inverts the
    simulator fits the parameters of the skin that the unpressed sweeps leave
    open. The figures before and after are of the same held-out sweeps; whole
    sessions are held out in turn if there are several. The model that is
    written is fitted to all touches.
    """

    model: Path = argument("MODEL.npz.")
    touches: Sequence[Path] = argument(
        "Sweeps of a few touches of each class, or at known places: FILE.nc ..."
    )
    output: Path = typed("BETTER.npz.", "--output", "-o")
    rest: Sequence[Path] | None = typed(REST, default=None)
    most: int = typed(MAX_SWEEPS, default=MAX_SWEEPS_READ)
    anyway: bool = typed(ANYWAY, default=False)

    def run(self) -> None:
        from ...simulator.sweeps import InputError, checked_output
        from ..adaptation import adapt_classes, adapt_positions
        from ..inputs.baselines import read_first
        from ..model.localizer_file import ENDING, save
        from .model_notes import load_model_for

        checked_output(self.output, (ENDING,))
        known = read_first(self.touches, self.most)
        baselines = None if self.rest is None else read_first(self.rest, self.most)
        loaded = load_model_for(known, self.touches, self.model, any_skin=self.anyway)
        samples = loaded.samples(known, baselines)
        try:
            if samples.problem.continuous:
                counted = loaded.gate and loaded.gate.samples(known, baselines)
                found = adapt_positions(loaded, samples, counted)
            else:
                found = adapt_classes(loaded, samples)
        except InputError as error:
            files = ", ".join(map(str, self.touches))
            raise InputError(f"{files} for {self.model}: {error}") from error
        save(self.output, found.model.with_fingerprints(known.isel(sweep=samples.rows)))
        for line in _report_lines(found):
            say(line)
        say(f"model: adapted by {len(samples.X)} sweeps -> {self.output}")


def _report_lines(found: Adaptation) -> list[str]:
    """Lines with the figures before and after (on held-out sweeps), and notes."""
    lines = [found.validation]
    for name, score in (("before", found.before), ("after", found.after)):
        rates = {each: rate.text for each, rate in score.rates().items()}
        rest = {
            each: f"{value:.2g}" for each, value in score.figures().items() if each in EXTRA_FIGURES
        }
        lines.append(f"{name}: " + "; ".join(f"{k} {v}" for k, v in (rates | rest).items()))
    if _worse(found):
        lines.append(
            "the adapted model is worse than the old one on held-out touches: keep the old one"
        )
    return [*lines, *found.notes]


def _worse(found: Adaptation) -> bool:
    from ..evaluation.evaluation import MEDIAN_ERROR, ClassScore

    before, after = found.before, found.after
    if isinstance(before, ClassScore) and isinstance(after, ClassScore):
        return bool(after.right.sum() < before.right.sum())
    errors = [each.figures().get(MEDIAN_ERROR, math.inf) for each in (before, after)]
    return errors[1] > errors[0]

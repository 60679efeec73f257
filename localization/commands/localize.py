"""The command `rcskin localize`."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from ...simulator.requests.argument_types import sweeps_of, typed_paths
from ...simulator.requests.number_ranges import SECONDS, SPEED
from ...simulator.requests.request import Writing, argument, function, option, typed
from ...simulator.safe_text import say
from .model_notes import model_of
from .options import (
    ANYWAY,
    MAX_SWEEPS,
    MAX_SWEEPS_READ,
    MODEL,
    REST,
    SWEEPS,
    TOUCH_EVERY,
    TOUCH_LASTS,
    TOUCH_SPEED,
)

if TYPE_CHECKING:
    import xarray as xr

    from ...simulator.requests.argument_types import Sweeps
    from ..model.localizer_model import Model
    from ..trust.answers import Answers


class Localize(Writing, example="localize columns.npz all.nc"):
    """Localize the press of each sweep, with its probability.

    The table has a line for each sweep: the answer or 'cannot tell', and the
    probability of the best answer. A model of positions also gives x and y in
    mm and the strength, with their standard deviations, if there is one touch.
    A model that was trained with faults says which fault a sweep without an
    answer resembles: 'cannot tell: like a dead foil'.
    --filter works with any model.
    """

    model: Model | str | Path = argument(MODEL)
    sweeps: Sweeps = argument(SWEEPS)
    output: Path | None = typed("OUT.csv, instead of the terminal.", "--output", "-o", default=None)
    rest: Sweeps | None = option(REST, default=None, kw_only=False)
    most: int = typed(MAX_SWEEPS, default=MAX_SWEEPS_READ)
    anyway: bool = typed(ANYWAY, default=False)
    filtered: bool = typed(
        "Combine sweeps over time: a touch comes, moves and goes.", "--filter", default=False
    )
    touch_lasts: float = typed(
        "Mean duration of a touch in seconds, with --filter.", within=SECONDS, default=TOUCH_LASTS
    )
    touch_every: float = typed(
        "Mean seconds from a touch to the next, with --filter.", within=SECONDS, default=TOUCH_EVERY
    )
    touch_speed: float = typed(
        "Speed of a touch in mm/s, with --filter.", within=SPEED, default=TOUCH_SPEED
    )
    pace: float = typed(
        "Seconds from sweep to sweep, if the file has no times.", within=SECONDS, default=0.4
    )

    def run(self) -> None:
        from ...simulator.report.files import write_rows
        from ...simulator.sweeps import checked_output
        from ...simulator.sweeps.csv_cells import guarded
        from ..inputs.baselines import read_first
        from ..trust.answers import CANNOT_TELL
        from .model_notes import load_model_for, note_known_sweeps

        if self.output is not None:
            checked_output(self.output, (".csv",))
        (path,), files = typed_paths(self.model), typed_paths(self.sweeps)
        baselines = None if self.rest is None else read_first(typed_paths(self.rest), self.most)
        loaded = read_first(files, self.most)
        localizer = load_model_for(loaded, files, path, any_skin=self.anyway)
        if self.filtered:
            touching = self.touch_lasts, self.touch_every, self.touch_speed
            header, rows = _filtered_answers(localizer, loaded, baselines, touching, self.pace)
        else:
            header, rows = _table(localizer, loaded, baselines)
        _note_unguarded(localizer, loaded, baselines)
        note_known_sweeps(localizer, loaded, path)
        if self.output is not None:
            write_rows(self.output, header, rows)
            silent = sum(row[2].startswith(CANNOT_TELL) for row in rows)
            say(f"answers: {len(rows)} sweeps, {silent} without an answer -> {self.output}")
            return
        for row in (header, *rows):
            say(",".join(f'"{cell}"' if "," in cell else cell for cell in map(guarded, row)))

    def result(self) -> Answers:
        """Localize the press of each sweep: class or "cannot tell", and its probability.

        A sweep with a reading that is no finite number gets "cannot tell".

        Raises InputError for sweeps unlike those of the training.
        """
        baselines = None if self.rest is None else sweeps_of(self.rest, "rest")
        return model_of(self.model).answers(sweeps_of(self.sweeps), baselines)


localize = function(Localize)


def _note_unguarded(model: Model, sweeps: xr.Dataset, rest: xr.Dataset | None) -> None:
    """Print a note if two touches may pass for one because baseline sweeps are missing."""
    import numpy as np

    from ..trust.fitted import with_known_baseline

    changes = model.guard_changes(sweeps, rest, np.arange(sweeps.sizes["sweep"]))
    unguarded = 0 if changes is None else len(changes) - with_known_baseline(changes).size
    if unguarded:
        say(
            f"rcskin: note: without a baseline sweep before: {unguarded} sweeps, in which two "
            "touches may be taken for one; --rest FILE gives one",
            err=True,
        )


def _filtered_answers(
    model: Model,
    sweeps: xr.Dataset,
    rest: xr.Dataset | None,
    touching: tuple[float, float, float],
    pace: float,
) -> tuple[list[str], list[list[str]]]:
    """Header and rows with --filter: each answer uses its sweep and all previous ones."""
    from ..filtering.chain import TouchDynamics
    from ..filtering.follower import Follower
    from ..inputs.targets import COORDINATES

    answers = Follower(model, TouchDynamics(*touching)).follow_all(sweeps, rest, pace)
    header = ["sweep", "press", "answer", "probability", "changed"]
    if model.target == "position":
        header += [*COORDINATES[:2], *(f"{name}_deviation" for name in COORDINATES[:2])]
    rows = []
    for number, (text, each) in enumerate(zip(sweeps["press"].values, answers, strict=True)):
        numbers = f"{each.probability:.4f}", f"{each.changed:.4f}"
        placed = [f"{value:.4g}" for value in each.coordinates] or [""] * (len(header) - 5)
        rows.append([str(number), str(text), each.label, *numbers, *placed])
    return header, rows


def _table(
    model: Model, sweeps: xr.Dataset, rest: xr.Dataset | None
) -> tuple[list[str], list[list[str]]]:
    from ...simulator.requests.console import note
    from ..inputs.baselines import finite_sweeps
    from ..inputs.features import at_interfaces
    from ..inputs.targets import COORDINATES
    from ..trust.diagnosis import without_answer

    answers = model.answers(sweeps, rest)
    kinds = model.faults(sweeps, answers)
    labels = [
        label if answered else without_answer(kind)
        for label, answered, kind in zip(answers.labels, answers.answered, kinds, strict=True)
    ]
    unread = int((~finite_sweeps(at_interfaces(sweeps, model.interfaces))).sum())
    if unread:
        have = "sweep has" if unread == 1 else "sweeps have"
        note(f"{unread} {have} no answer: a reading is no finite number")
    early = sweeps.sizes["sweep"] - unread - model.usable_features(sweeps, rest)[1].size
    if early:
        why = "no baseline sweep was measured before in their session; --rest FILE gives one"
        say(
            f"rcskin: note: {early} sweep{' has' if early == 1 else 's have'} no answer: {why}",
            err=True,
        )
    header = ["sweep", "press", "answer", "probability"]
    places = iter(lambda: [], None)
    if model.target == "position":
        header += [*COORDINATES, *(f"{name}_deviation" for name in COORDINATES)]
        places = _places(model, sweeps, rest, answers.labels == "1")
    texts = sweeps["press"].values.astype(str)
    answered = zip(texts, labels, answers.probability, places, strict=False)
    rows = [
        [str(number), text, str(label), f"{probability:.4f}", *place]
        for number, (text, label, probability, place) in enumerate(answered)
    ]
    return header, rows


def _places(
    model: Model, sweeps: xr.Dataset, rest: xr.Dataset | None, placed: object
) -> Iterator[list[str]]:
    import numpy as np

    numbers = np.hstack(model.positions(sweeps, rest))
    for row, there in zip(numbers, np.asarray(placed), strict=True):
        yield [f"{value:.4g}" if there else "" for value in row]

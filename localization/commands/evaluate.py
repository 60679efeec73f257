"""The command `rcskin evaluate`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ...simulator.requests.argument_types import sweeps_of, typed_paths
from ...simulator.requests.number_ranges import AllowedRange
from ...simulator.requests.request import Writing, called, function, option, typed
from ...simulator.safe_text import say
from .model_notes import (
    accuracy_meaning,
    load_model_for,
    model_of,
    note_features,
    note_known_sweeps,
)
from .options import (
    ANYWAY,
    CERTAIN,
    CHARTS,
    ESTIMATOR,
    INTERFACES,
    MAX_SWEEPS,
    MAX_SWEEPS_READ,
    QUANTITIES,
    REST,
    TARGET,
    TUNE,
)

if TYPE_CHECKING:
    from ...simulator.requests.argument_types import Sweeps
    from ..evaluation.result import Evaluation
    from ..inputs.targets import Target
    from ..inversion.estimators import EstimatorName
    from ..model.localizer_model import Model


class Evaluate(Writing, example="evaluate columns.npz all.nc -o found"):
    """Accuracy of a localizer on sweeps that it was not trained on.

    With a model, all these sweeps are scored; none of them should have been
    used to train it. If sweeps have faults, a line for each fault states
    accuracy, the share of sweeps that were answered, and how many of the
    others were named as that fault. Without a model, a localizer of TARGET is trained and
    scored by nested cross-validation: a scored sweep was used for no training,
    tuning or calibration. The spread of figures over the folds is stated. Whole
    sessions are held out if there are three or more.
    """

    files: Sequence[Path] = typed(
        "A model to evaluate, MODEL.npz, if any; then sweeps: .nc, .zarr or .csv, joined.",
        "[MODEL] SWEEPS",
        placed=True,
    )
    model: Model | str | Path = called("the model or the path of its file.")
    sweeps: Sweeps = called("sweeps with known presses, or the path of their file.")
    output: Path | None = typed("A folder for tables and a chart.", "--output", "-o", default=None)
    rest: Sweeps | None = option(REST, default=None, kw_only=False)
    target: Target = typed(TARGET, default="column")
    estimator: EstimatorName | None = typed(ESTIMATOR, default=None)
    quantities: str | Sequence[str] | None = typed(QUANTITIES, default=None)
    interfaces: Sequence[str] | None = typed(INTERFACES, default=None)
    certain: float | None = typed(CERTAIN, default=None)
    tune: bool = typed(TUNE, default=False)
    folds: int = typed(
        "Folds of the outer cross-validation, >= 2.",
        within=AllowedRange(2, 1000, "each needs a training"),
        default=5,
    )
    most: int = typed(MAX_SWEEPS, default=MAX_SWEEPS_READ)
    anyway: bool = typed(ANYWAY, default=False)
    charts: str = typed(CHARTS, default="png")

    def run(self) -> None:
        from ...simulator.chart_style import checked_ending
        from ...simulator.progress import on_terminal
        from ...simulator.scene.scene_files import scene_of_sweeps
        from ...simulator.sweeps import InputError, checked_folder
        from ..evaluation.evaluation import nested
        from ..evaluation.fault_scores import FaultScore, fault_lines, fault_scores
        from ..evaluation.report import WRITTEN, report_of
        from ..evaluation.result import evaluated, evaluated_by_folds
        from ..inputs.baselines import read_first
        from ..inputs.features import default_quantities
        from ..inputs.samples import samples_of
        from ..inversion.estimators import chosen
        from ..model.localizer_file import ENDING

        by_model, by_fault = self.files[0].suffix == ENDING, list[FaultScore]()
        recordings = self.files[by_model:]
        if not recordings:
            raise InputError("no sweeps were given: rcskin evaluate MODEL.npz SWEEPS")
        ending = checked_ending(self.charts)
        folder = None if self.output is None else checked_folder(self.output, *WRITTEN)
        sweeps = read_first(recordings, self.most)
        baselines = None if self.rest is None else read_first(typed_paths(self.rest), self.most)
        if by_model:
            model = load_model_for(sweeps, recordings, self.files[0], any_skin=self.anyway)
            samples = model.samples(sweeps, baselines)
            answers = model.answers(sweeps, baselines)
            found = evaluated(model.learned, samples, answers)
            named = model.faults(sweeps, answers)
            by_fault = fault_scores(sweeps, answers, named, samples, found.score)
            problem, scored = model.problem, "given sweeps"
            note_known_sweeps(model, sweeps, self.files[0])
        else:
            used = self.quantities or default_quantities(
                sweeps, baselines, chosen(self.estimator, self.target).curve
            )
            samples = samples_of(
                sweeps, self.target, used, interfaces=self.interfaces, rest=baselines
            )
            note_features(self.quantities, samples.problem.quantities)
            problem, scored = samples.problem, "sweeps outside the training"
            estimator = chosen(self.estimator, samples.problem.target)
            with on_terminal() as progress:
                scores = nested(
                    samples,
                    estimator,
                    certain=self.certain,
                    tune=self.tune,
                    folds=self.folds,
                    progress=progress,
                )
            found = evaluated_by_folds(samples, scores)
        meaning = [] if problem.continuous else [accuracy_meaning(problem, scored, sweeps)]
        faults = fault_lines(by_fault, classes=not problem.continuous)
        known = problem.continuous and folder is not None
        scene = scene_of_sweeps(sweeps) if known else None
        report = report_of(found, scene and scene.parts.skin)
        report.show()
        for line in (*faults, *meaning):
            say(line)
        if folder is not None:
            report.write(folder, charts=[ending])
            say(f"evaluation: {len(found.score.truth)} sweeps -> {folder}")

    def result(self) -> Evaluation:
        """Evaluate a model on sweeps whose presses are known.

        The figures are too good for sweeps on which the model was trained or adapted. Sweeps with
        a reading that is no finite number count as not answered.

        Raises InputError for sweeps unlike those of the training.
        """
        from ..evaluation.result import evaluated

        baselines = None if self.rest is None else sweeps_of(self.rest, "rest")
        model, sweeps = model_of(self.model), sweeps_of(self.sweeps)
        samples, answers = model.samples(sweeps, baselines), model.answers(sweeps, baselines)
        return evaluated(model.learned, samples, answers)


evaluate = function(Evaluate)

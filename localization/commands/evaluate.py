"""The command `rcskin evaluate`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ...simulator.safe_text import say
from . import options

if TYPE_CHECKING:
    from ...simulator.progress import ProgressCallback
    from ..evaluation.result import Evaluation
    from ..inputs.samples import Samples

FILES = "A model to evaluate, MODEL.npz, if any; then sweeps: .nc, .zarr or .csv, joined."


@options.with_option_names
def evaluate(
    files: Annotated[list[Path], typer.Argument(metavar="[MODEL] SWEEPS", help=FILES)],
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="A folder for tables and a chart.")
    ] = None,
    rest: options.Rest = None,
    target: options.Target = "column",
    name: options.Name = None,
    quantities: options.Quantities = None,
    interface: options.Interfaces = None,
    certain: options.Certain = None,
    tune: options.Tune = False,
    folds: Annotated[int, typer.Option(help="Folds of the outer cross-validation, >= 2.")] = 5,
    most: options.MaxSweeps = options.MAX_SWEEPS_READ,
    anyway: options.Anyway = False,
    charts: options.Charts = "png",
) -> None:
    """Accuracy of a localizer on sweeps that it was not trained on.

    With a model, all these sweeps are scored; none of them should have been
    used to train it. If sweeps have faults, a line for each fault states
    accuracy, the share of sweeps that were answered, and how many of the
    others were named as that fault. Without a model, a localizer of TARGET is trained and
    scored by nested cross-validation: a scored sweep was used for no training,
    tuning or calibration. The spread of figures over the folds is stated. Whole
    sessions are held out if there are three or more.
    """
    from ...simulator.chart_style import checked_ending
    from ...simulator.progress import on_terminal
    from ...simulator.scene.scene_files import scene_of_sweeps
    from ...simulator.sweeps import InputError, checked_folder
    from ..evaluation.fault_scores import FaultScore, fault_lines, fault_scores
    from ..evaluation.report import WRITTEN, lines_of, write_report
    from ..evaluation.result import evaluated
    from ..inputs.baselines import read_first
    from ..inputs.features import default_quantities
    from ..inputs.samples import samples_of
    from ..inversion.estimators import chosen
    from ..model.localizer_file import ENDING
    from .model_notes import accuracy_meaning, load_model_for, note_features, note_known_sweeps

    by_model, by_fault = files[0].suffix == ENDING, list[FaultScore]()
    recordings = files[by_model:]
    if not recordings:
        raise InputError("no sweeps were given: rcskin evaluate MODEL.npz SWEEPS")
    if folds < 2:
        raise InputError(f"--folds must be >= 2, got {folds}")
    ending = checked_ending(charts)
    folder = None if output is None else checked_folder(output, *WRITTEN)
    sweeps = read_first(recordings, most)
    baselines = None if rest is None else read_first(rest, most)
    if by_model:
        model = load_model_for(sweeps, recordings, files[0], any_skin=anyway)
        samples = model.samples(sweeps, baselines)
        answers = model.answers(sweeps, baselines)
        found = evaluated(model.learned, samples, answers)
        named = model.faults(sweeps, answers)
        by_fault = fault_scores(sweeps, answers, named, samples, found.score)
        problem, scored = model.problem, "given sweeps"
        note_known_sweeps(model, sweeps, files[0])
    else:
        used = quantities or default_quantities(sweeps, baselines, chosen(name, target).curve)
        samples = samples_of(sweeps, target, used, interfaces=interface, rest=baselines)
        note_features(quantities, samples.problem.quantities)
        problem, scored = samples.problem, "sweeps outside the training"
        with on_terminal() as progress:
            found = _by_folds(
                samples, name, certain=certain, tune=tune, folds=folds, progress=progress
            )
    meaning = [] if problem.continuous else [accuracy_meaning(problem, scored, sweeps)]
    faults = fault_lines(by_fault, classes=not problem.continuous)
    for line in (*lines_of(found), *faults, *meaning):
        say(line)
    if folder is not None:
        scene = scene_of_sweeps(sweeps) if problem.continuous else None
        write_report(folder, found, scene and scene.parts.skin, ending)
        say(f"evaluation: {len(found.score.truth)} sweeps -> {folder}")


def _by_folds(
    samples: Samples,
    name: str | None,
    *,
    certain: float | None,
    tune: bool,
    folds: int,
    progress: ProgressCallback,
) -> Evaluation:
    from ..evaluation.evaluation import nested
    from ..evaluation.result import evaluated_by_folds
    from ..inversion.estimators import chosen

    estimator = chosen(name, samples.problem.target)
    found = nested(samples, estimator, certain=certain, tune=tune, folds=folds, progress=progress)
    return evaluated_by_folds(samples, found)

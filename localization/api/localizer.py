"""Features of sweeps; training, evaluation and use of models."""
# pyright: standard

from __future__ import annotations

import logging
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from .arguments import checked, model_of, path_of, sweeps_of

if TYPE_CHECKING:
    import xarray as xr

    from ..evaluation.result import Evaluation
    from ..inputs.features import Features
    from ..inputs.targets import Target
    from ..inversion.estimators import EstimatorName
    from ..model.localizer_model import Model
    from ..trust.answers import Answers

LOG = logging.getLogger(__name__)


@checked
def features(
    sweeps: xr.Dataset | str | Path,
    target: Target = "column",
    quantities: str | Sequence[str] | None = None,
) -> Features:
    """Compute features X, shape (sweep, feature), and targets y of sweeps.

    y has shape (sweep,), for positions (sweep, 3): x and y in mm, and the strength. The result
    unpacks into X and y; its `index`, shape (sweep,), numbers their sweeps among the given ones.
    Sweeps whose press has no such target, without a baseline that the features need or with a
    reading that is no finite number are left out; `left_out` says how many and why, and a warning
    is logged. sweeps: the sweeps or the path of their file. target:
    "column", "row", "pixel", "pair", "touches" or "position". quantities: names such as
    "dlnZ,dphase", as one text or a list; by default changes from the unpressed skin or, if most
    presses have no baseline sweep before them, Rs and Cp. Raises InputError for a target or a
    quantity that these sweeps do not have.
    """
    from ..inputs.features import Features
    from ..inputs.samples import samples_of

    samples = samples_of(sweeps_of(sweeps), target, quantities)
    found = Features.of(samples)
    if any(samples.left_out):
        LOG.warning("features of %s: %s", target, found.left_out)
    return found


@checked
def train(
    sweeps: xr.Dataset | str | Path,
    target: Target = "column",
    estimator: EstimatorName | None = None,
    *,
    quantities: str | Sequence[str] | None = None,
    interfaces: Sequence[str] | None = None,
    rest: xr.Dataset | str | Path | None = None,
    certain: float | None = None,
    tune: bool = False,
) -> Model:
    """Train a model that predicts the `target` of sweeps like these.

    sweeps, target, quantities: see `features`. estimator: name of the estimator; the default
    depends on the target. interfaces: names of the interfaces to use, by default all. rest: sweeps
    of the unpressed skin, if they are not among `sweeps`. certain: answer only if the accuracy of
    answers reaches this rate, 0 to 1, on held-out sweeps. tune: True chooses the estimator's
    parameters by cross-validation. Raises InputError for a value that does not fit the sweeps, and
    if all sweeps are of one class.
    """
    from ..model.training import train as trained

    return trained(
        sweeps_of(sweeps),
        target,
        estimator,
        quantities=quantities,
        interfaces=interfaces,
        rest=None if rest is None else sweeps_of(rest, "rest"),
        certain=certain,
        tune=tune,
    )


def load_model(path: str | Path) -> Model:
    """Load a model from a file that `write`, `rcskin train` or `rcskin adapt` wrote.

    path: .npz. Raises InputError in one line if the file holds no model.
    """
    from ..model.localizer_file import load

    return load(path_of(path))


@checked
def localize(
    model: Model | str | Path,
    sweeps: xr.Dataset | str | Path,
    rest: xr.Dataset | str | Path | None = None,
) -> Answers:
    """Localize the press of each sweep: class or "cannot tell", and its probability.

    model, sweeps: the objects or the paths of their files. rest: sweeps of the unpressed skin, if
    the model needs them and they are not among `sweeps`. A sweep with a reading that is no finite
    number gets "cannot tell". Raises InputError for sweeps unlike those of the training.
    """
    baselines = None if rest is None else sweeps_of(rest, "rest")
    return model_of(model).answers(sweeps_of(sweeps), baselines)


@checked
def evaluate(
    model: Model | str | Path,
    sweeps: xr.Dataset | str | Path,
    rest: xr.Dataset | str | Path | None = None,
) -> Evaluation:
    """Evaluate a model on sweeps whose presses are known.

    The figures are too good for sweeps on which the model was trained or adapted.
    Sweeps with a reading that is no finite number count as not answered.
    model, sweeps, rest: see `localize`. Raises InputError for sweeps unlike those of the training.
    """
    from ..evaluation.result import evaluated

    baselines = None if rest is None else sweeps_of(rest, "rest")
    known, given = model_of(model), sweeps_of(sweeps)
    samples, answers = known.samples(given, baselines), known.answers(given, baselines)
    return evaluated(known.learned, samples, answers)

"""The command `rcskin train`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ...simulator.requests.argument_types import sweeps_of, typed_paths
from ...simulator.requests.request import Writing, argument, function, option, typed
from ...simulator.safe_text import say
from .options import (
    CERTAIN,
    ESTIMATOR,
    INTERFACES,
    MAX_SWEEPS,
    MAX_SWEEPS_READ,
    QUANTITIES,
    REST,
    SWEEPS,
    TARGET,
    TUNE,
)

if TYPE_CHECKING:
    import xarray as xr

    from ...simulator.progress import ProgressCallback
    from ...simulator.requests.argument_types import Sweeps
    from ..inputs.targets import Target
    from ..inversion.estimators import EstimatorName
    from ..model.localizer_model import Model


class Train(Writing, example="train skins.zarr -o columns.npz"):
    """Train a localizer on sweeps whose presses are known.

    Probabilities, or standard deviations of positions, are calibrated on
    held-out sweeps: whole sessions if there are several. The answer to sweeps
    unlike the training is 'cannot tell'. "Nothing pressed" is a possible
    answer only if the training has sweeps of the unpressed skin.
    """

    sweeps: Sweeps = argument(SWEEPS)
    output: Path = typed("MODEL.npz.", "--output", "-o")
    target: Target = option(TARGET, default="column", kw_only=False)
    estimator: EstimatorName | None = option(ESTIMATOR, default=None, kw_only=False)
    quantities: str | Sequence[str] | None = option(QUANTITIES, default=None)
    interfaces: Sequence[str] | None = option(INTERFACES, default=None)
    rest: Sweeps | None = option(REST, default=None)
    certain: float | None = option(CERTAIN, default=None)
    tune: bool = option(TUNE, default=False)
    most: int = typed(MAX_SWEEPS, default=MAX_SWEEPS_READ)

    def run(self) -> None:
        from ...simulator.progress import on_terminal
        from ...simulator.sweeps import checked_output
        from ..inputs.baselines import read_first
        from ..model.localizer_file import ENDING, save
        from .model_notes import note_features

        checked_output(self.output, (ENDING,))
        known = read_first(typed_paths(self.sweeps), self.most, lazy=True)
        rest = None if self.rest is None else read_first(typed_paths(self.rest), self.most)
        with on_terminal() as progress:
            model = self._model(known, rest, progress)
        save(self.output, model)
        note_features(self.quantities, model.quantities)
        for line in [*_model_lines(model), *_meaning(model, known), *_hints(model, known)]:
            say(f"{self.output}: {line}")
        say(f"model: {_size(model)} -> {self.output}")

    def result(self) -> Model:
        """Train a model that predicts the `target` of sweeps like these.

        Raises InputError for a value that does not fit the sweeps, and if all sweeps are of one
        class.
        """
        from ...simulator.progress import silent

        rest = None if self.rest is None else sweeps_of(self.rest, "rest")
        return self._model(sweeps_of(self.sweeps), rest, silent)

    def _model(
        self, sweeps: xr.Dataset, rest: xr.Dataset | None, progress: ProgressCallback
    ) -> Model:
        from ..model.training import train as trained

        return trained(
            sweeps,
            self.target,
            self.estimator,
            quantities=self.quantities,
            interfaces=self.interfaces,
            rest=rest,
            certain=self.certain,
            tune=self.tune,
            progress=progress,
        )


train = function(Train)


def _model_lines(model: Model) -> list[str]:
    """Lines that describe a newly trained model."""
    features = f"{', '.join(model.quantities)} at {', '.join(model.interfaces)}"
    lines = [
        f"{model.target} by {model.estimator} from {features}, {len(model.frequencies)} "
        f"frequencies; {model.trained_on} sweeps, {model.left_out}",
        f"validated by {model.validation}: {model.learned.outcome}",
    ]
    if model.certain is not None:
        rate = f"answers only if answers are right at a rate of {model.certain:g} or more"
        lines.append(rate + _coverage(model))
    if not model.knows_unpressed:
        lines.append("never answers 'nothing pressed': the sweeps include no unpressed skin")
    return lines


def _meaning(model: Model, sweeps: xr.Dataset) -> list[str]:
    """Line on the kind of sweeps that the stated accuracy applies to, if there is one."""
    from .model_notes import accuracy_meaning

    if model.target == "position":
        return []
    return [accuracy_meaning(model.problem, "sweeps outside the training", sweeps)]


def _hints(model: Model, sweeps: xr.Dataset) -> list[str]:
    """Hint to use changes from the unpressed skin, if the sweeps allow it."""
    import numpy as np

    from ..inputs.features import names_of

    if not model.guards_use_changes or np.unique(sweeps["session"]).size < 2:
        return []
    changes = names_of(sweeps.variables).relative
    return [
        "uses absolute readings, which differ from skin to skin; changes from the unpressed skin "
        f"are usually more accurate: --features {','.join(changes)}"
    ]


def _coverage(model: Model) -> str:
    """Text with the number of held-out sweeps that the model or its gate answered."""
    from ..trust.answers import CONFIDENCE, CountedRate
    from ..trust.fitted import Classifier

    learned = (model.gate or model).learned
    if not isinstance(learned, Classifier):
        return ""
    answered = CountedRate(learned.answered, learned.held_out).text
    return (
        f", with {100 * CONFIDENCE:g} % confidence in sessions like these; held-out sweeps "
        f"answered: {answered}"
    )


def _size(model: Model) -> str:
    """Text with the numbers of features and of classes without "nothing pressed"."""
    from ..trust.answers import NOTHING_PRESSED

    features = f"{model.problem.features} features"
    if model.target == "position":
        return f"{features}, positions"
    if model.target == "touches":
        return f"{features}, {' or '.join(map(str, model.classes))} touches"
    known = sum(str(label) not in NOTHING_PRESSED for label in model.classes)
    return f"{features}, {known} {model.target}{'' if known == 1 else 's'}"

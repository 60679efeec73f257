"""Models from files, and the notes that commands print about models and sweeps."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ...simulator.safe_text import say

if TYPE_CHECKING:
    import xarray as xr

    from ..inputs.samples import LocalizationProblem
    from ..model.localizer_model import Model


def model_of(given: Model | str | Path) -> Model:
    """The model itself, or the one in the file. Raises InputError if it is neither."""
    from ...simulator.requests.argument_types import refuse
    from ..model.localizer_file import load
    from ..model.localizer_model import Model

    if isinstance(given, str | Path):
        return load(given)
    return given if isinstance(given, Model) else refuse("model", "a Model or a path", given)


def load_model_for(
    sweeps: xr.Dataset, files: Sequence[Path], path: Path, *, any_skin: bool
) -> Model:
    """The model in the file at `path`.

    Prints a note if the sweeps of `files` store no scene, and one if the model was trained with
    another version. any_skin: True if the model accepts sweeps of another skin too. Raises
    InputError as `load`.
    """
    from ..model.localizer_file import load

    model = load(path)
    if model.problem.scene and not sweeps.attrs.get("scene"):
        names = ", ".join(map(str, files))
        say(
            f"rcskin: note: {names}: stores no scene, so its skin cannot be compared with the "
            "model's",
            err=True,
        )
    note_version(model, path)
    return model.for_any_skin() if any_skin else model


def note_version(model: Model, path: Path) -> None:
    """Print a note if another version trained the model."""
    if model.version_difference:
        say(f"rcskin: note: {path}: was trained with {model.version_difference}", err=True)


def accuracy_meaning(problem: LocalizationProblem, scored: str, sweeps: xr.Dataset) -> str:
    """Line on the kind of sweeps that an accuracy applies to. scored: see `accuracy_text`."""
    from ...simulator.sweeps.units import CHANGES, accuracy_text
    from ..inputs.features import are_changes

    used = ", ".join(problem.quantities)
    features = CHANGES if are_changes(problem.quantities) else used
    noisy = "rtol" not in sweeps.attrs or "readout" in sweeps.attrs
    return accuracy_text(problem.target, features, scored, noisy=noisy)


def note_features(requested: str | Sequence[str] | None, used: Sequence[str]) -> None:
    """Print a note if the features are a default other than changes from the unpressed skin."""
    from ..inputs.features import RELATIVE, names_beside

    if requested is None and not set(used) & set(RELATIVE):
        changes = names_beside(used).relative[: len(used)]
        say(
            f"rcskin: note: --features {','.join(used)} is used because most presses have no sweep "
            "of the unpressed skin before them in their session; with such sweeps, "
            f"{','.join(changes)} is usually more accurate",
            err=True,
        )


def note_known_sweeps(model: Model, sweeps: xr.Dataset, path: Path) -> None:
    """Print a note if the model was trained or adapted on some of these sweeps."""
    import numpy as np

    from ..inputs.samples import fingerprints_of

    known = int(np.isin(fingerprints_of(sweeps), model.fingerprints).sum())
    if known:
        text = f"was trained or adapted on {known} of these {sweeps.sizes['sweep']} sweeps"
        say(f"rcskin: note: {path}: {text}; on other sweeps its accuracy is lower", err=True)

"""Model files: the plain parts of a model, which are checked while they are read."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from ...simulator.sweeps import InputError, checked_output, inputs, whole_file
from ...simulator.sweeps.array_files import ForeignFileError, read_arrays, write_arrays
from ...simulator.sweeps.inputs import check_file_kind
from ..parts.plain import UnsoundError
from ..parts.predictor import Chain
from .localizer_model import Model

ENDING = ".npz"
EARLIER = ".skops"
"""Ending of models of versions before 1.0, which held objects of scikit-learn."""
KIND, LAYOUT = "rcskin model", 11
"""Kind of file, and layout; a new number means that older files are not readable."""


def save(path: str | Path, model: Model) -> None:
    """Write a model completely or not at all.

    Raises InputError if `path` does not end in .npz or its folder does not exist.
    """
    description, arrays = model.described()
    with whole_file(checked_output(path, (ENDING,))) as unfinished:
        write_arrays(unfinished, KIND, LAYOUT, {"model": description}, arrays)


def load(path: str | Path) -> Model:
    """A model written by `save`.

    Raises InputError that names the file if it is absent, damaged or forged, holds no model, or has
    an earlier layout.
    """
    path = Path(path)
    if path.suffix == EARLIER:
        inputs.check_input(path, inputs.MODEL)
        raise InputError(_train_again(path))
    check_file_kind(path, "model")
    try:
        description, arrays = read_arrays(path, KIND, LAYOUT)
        return replace(_answering(Model.of(description.get("model"), arrays)), source=str(path))
    except ForeignFileError as error:
        earlier = "layout" in str(error)
        reason = _train_again(path) if earlier else f"{path}: not a model of rcskin: {error}"
        raise InputError(reason) from error
    except UnsoundError as error:
        raise InputError(f"{path}: damaged or forged: {error}; train it again") from error
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: not a model of rcskin: {error}") from error


def _train_again(path: Path) -> str:
    again = f"rcskin train SWEEPS -o {path.with_suffix(ENDING).name}"
    return f"{path}: a model of another version of rcskin: train it again ({again})"


def _answering(model: Model) -> Model:
    """The model. Raises UnsoundError if it answers a sweep of zeros by no finite number."""
    predictor = model.predictor
    if isinstance(predictor, Chain):
        sweep = np.zeros((1, predictor.features))
        with np.errstate(all="ignore"):
            positions = predictor.classes is None
            found = predictor.positions(sweep)[0] if positions else predictor.decisions(sweep)
        if not np.isfinite(found).all():
            raise UnsoundError("learned.predictor", "answers no finite number")
    return model if model.gate is None else replace(model, gate=_answering(model.gate))

"""A trained model on disk, in the format of skops: data to be checked, never code to be trusted."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import skops.io
from sklearn.pipeline import Pipeline
from sklearn.preprocessing import StandardScaler
from sklearn.svm import SVC

from localization.ecoc import ECOCClassifier
from localization.model import Model
from simulator.sweeps import InputError, checked_output, whole_file

ENDING = ".skops"
TRUSTED = [f"{ECOCClassifier.__module__}.{ECOCClassifier.__qualname__}"]
"""Types that may be built from a file, besides those of scikit-learn that skops vouches for."""
FIELDS = {
    "pipeline": Pipeline,
    "target": str,
    "quantities": tuple,
    "interfaces": tuple,
    "frequencies": tuple,
    "scene": str,
    "version": str,
}
STEPS = (StandardScaler, ECOCClassifier, SVC)
"""What the pipeline may be made of."""


def save(path: str | Path, model: Model) -> None:
    """Write a model, whole or not at all.

    Raises InputError where `path` does not end in .skops or its folder does not exist.
    """
    with whole_file(checked_output(path, (ENDING,))) as unfinished:
        skops.io.dump({name: getattr(model, name) for name in FIELDS}, unfinished)


def load(path: str | Path) -> Model:
    """A model written by `save`. Nothing in the file is built before all its types are known.

    Raises InputError naming the file where it is absent, not of skops, holds a type not in TRUSTED
    (named too), or holds something other than a model.
    """
    path = Path(path)
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from error
    fields = _trusted_content(path, data)
    if not _is_model(fields):
        raise InputError(f"{path}: holds no model of rcskin")
    return Model(**fields)


def _trusted_content(path: Path, data: bytes) -> Any:
    try:
        untrusted = sorted(set(skops.io.get_untrusted_types(data=data)) - set(TRUSTED))
        content = None if untrusted else skops.io.loads(data, trusted=TRUSTED)
    except Exception as error:  # a damaged archive can fail anywhere in zipfile, json or skops
        reason = " ".join(str(error).split())
        raise InputError(f"{path}: not a model in the format of skops: {reason}") from error
    if untrusted:
        raise InputError(f"{path}: holds the untrusted type {untrusted[0]}; not loaded")
    return content


def _is_model(fields: Any) -> bool:
    return (
        isinstance(fields, dict)
        and fields.keys() == FIELDS.keys()
        and all(isinstance(fields[name], kind) for name, kind in FIELDS.items())
        and all(isinstance(step, STEPS) for _, step in fields["pipeline"].steps)
    )

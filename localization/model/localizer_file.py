"""Model files in the format of skops: the content is checked, and no code is run."""

from __future__ import annotations

import io
import json
import warnings
from dataclasses import replace
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import skops.io
from sklearn.exceptions import InconsistentVersionWarning

from ...simulator.sweeps import InputError, checked_output, digests, inputs, whole_file
from ...simulator.sweeps.file_kinds import check_file_kind
from ..learners.registry import REMOVED, removal_message
from ..processor_count import physical_cpu_count
from ..trust.kinds import KindGuard
from ..trust.several import SeveralGuard
from .localizer_model import Model
from .model_fields import (
    ANOTHER_LAYOUT,
    OF_EARLIER,
    OWN_STEPS,
    EarlierLayoutError,
    fields_of,
    model_of,
)
from .soundness import UnsoundError, check_guard, check_sound

ENDING = ".skops"
TRUSTED = [
    f"{kind.__module__}.{kind.__qualname__}" for kind in (*OWN_STEPS, KindGuard, SeveralGuard)
]
"""Types that may be loaded from a file, in addition to those that skops trusts."""


def save(path: str | Path, model: Model) -> None:
    """Write a model completely or not at all.

    Raises InputError if `path` does not end in .skops or its folder does not exist.
    """
    with whole_file(checked_output(path, (ENDING,))) as unfinished:
        skops.io.dump(fields_of(model), unfinished)
        digests.seal_archive(unfinished)


def load(path: str | Path) -> Model:
    """A model written by `save`. All types in the file are checked before any is loaded.

    Raises InputError that names the file if it is absent, not of skops, holds a type not in TRUSTED
    (named too), does not hold a model, or has an earlier layout.
    """
    path = Path(path)
    check_file_kind(path, "model")
    data = inputs.content(path, inputs.MODEL)
    if not data:
        raise InputError(f"{path}: not a model in the format of skops: it is empty")
    fields = _trusted_content(path, data)
    try:
        physical_cpu_count()
        return replace(_sound(model_of(fields)), source=str(path))
    except EarlierLayoutError as error:
        raise InputError(f"{path}: {error}") from error
    except UnsoundError as error:
        raise InputError(f"{path}: damaged or forged: {error}; train it again") from error
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise InputError(f"{path}: holds no model of rcskin") from error


def _sound(model: Model) -> Model:
    check_sound(model.learned, model.problem.features)
    if model.diagnosis is not None:
        for kind, guard in model.diagnosis.guards.items():
            check_guard(guard, f"faults.{kind}")
    if model.gate is not None:
        _sound(model.gate)
    return model


def _trusted_content(path: Path, data: bytes) -> Any:
    try:
        inputs.check_archive(path, io.BytesIO(data))
        untrusted = sorted(set(skops.io.get_untrusted_types(data=data)) - set(TRUSTED))
        if not untrusted:
            digests.check_archive(path, io.BytesIO(data))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", InconsistentVersionWarning)  # commands note it
            content = None if untrusted else skops.io.loads(data, trusted=TRUSTED)
    except InputError:
        raise
    except Exception as error:  # a damaged archive can fail anywhere in zipfile, json or skops
        reason = " ".join(str(error).split())
        raise InputError(f"{path}: not a model in the format of skops: {reason}") from error
    if any(name.startswith(OF_EARLIER) for name in untrusted):
        name = _estimator(data)
        advice = (
            f"its estimator {removal_message(name)}, and train it again"
            if name in REMOVED
            else ANOTHER_LAYOUT
        )
        raise InputError(f"{path}: {advice}")
    if untrusted:
        raise InputError(f"{path}: holds the untrusted type {untrusted[0]}; not loaded")
    return content


def _estimator(data: bytes) -> str:
    """Name of the estimator in a file of any layout; empty if there is none."""
    try:
        schema = json.loads(ZipFile(io.BytesIO(data)).read("schema.json"))
        return str(json.loads(schema["content"]["estimator"]["content"]))
    except (KeyError, TypeError, ValueError):
        return ""

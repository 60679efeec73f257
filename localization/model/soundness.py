"""Consistency of the arrays in a model: sizes, ranges, indices, finite numbers.

Libraries trust the arrays they fitted. A model file may hold anything: libsvm reads beyond the end
of a support vector that is too short, and a scale of 0 gives a wrong answer silently.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np
from sklearn.frozen import FrozenEstimator
from sklearn.pipeline import Pipeline

from ..trust.fitted import Classifier, Guards, Regressor
from ..trust.kinds import KindGuard
from .learned_arrays import LEARNED, RULES, Inner

Sizes = dict[str, int]
DERIVED: Mapping[str, Callable[[Sizes], int]] = {
    "K-1": lambda sizes: sizes["K"] - 1,
    "pairs": lambda sizes: sizes["K"] * (sizes["K"] - 1) // 2,
    "F/2": lambda sizes: sizes["F"] // 2,
}
KINDS = {"<": "iu", "int": "iu", "bool": "b", "classes": "biuUO"}
"""Kinds of numpy types that a rule allows; without a rule floating-point numbers."""
MAY_BE_MINUS_INFINITY = "log_weight_"
"""Logarithms of probabilities, which may be zero."""
OUTPUTS = 3
"""Number of outputs of a position: x, y and strength."""


class UnsoundError(ValueError):
    """A part of a model is inconsistent; the message names it."""


def check_sound(learned: Classifier | Regressor, features: int) -> None:
    """Raises UnsoundError that names an inconsistent part of a model.

    features: number of features of a sweep.
    """
    try:
        _check_numbers(vars(learned), "model")
        check_estimator(learned.pipeline, features, "pipeline")
        _check_guards(learned.guards, features)
        if isinstance(learned, Regressor):
            _check_array(learned.factor, "3 >=0", "factor", {})
            if learned.spread is not None:
                check_estimator(learned.spread, OUTPUTS, "spread")
        else:
            _check_array(learned.sharpness, ">0", "sharpness", {})
            _check_array(learned.threshold, ">=0", "threshold", {})
        _check_prediction(learned, features)
    except UnsoundError:
        raise
    except Exception as error:  # a part of another type can raise anything
        raise UnsoundError(" ".join(str(error).split())) from error


def check_estimator(estimator: Any, features: int | None, where: str) -> int:
    """Check a fitted estimator; return the size of its output (of its input for classes).

    features: the size of its input; None if the estimator stores it. Raises UnsoundError.
    """
    if isinstance(estimator, FrozenEstimator):
        return check_estimator(estimator.estimator, features, where)
    if isinstance(estimator, Pipeline):
        for name, step in estimator.steps:
            features = check_estimator(step, features, f"{where}.{name}")
        assert features is not None
        return features
    given = vars(estimator).get("n_features_in_", features)
    if features not in (None, given):
        raise UnsoundError(f"`{where}` takes {given} numbers where there are {features}")
    sizes: Sizes = {"F": int(given), **DERIVED_FROM_NOTHING}
    for path, declared in LEARNED[type(estimator)].items():
        for value in _values(estimator, path):
            name = f"{where}.{path.rstrip('?')}"
            if isinstance(declared, Inner):
                sizes["out"] = check_estimator(value, _size(declared.takes, sizes), name)
            else:
                _check_array(value, declared, name, sizes)
    for description, holds in RULES.get(type(estimator), {}).items():
        if not holds(estimator, sizes):
            raise UnsoundError(f"`{where}` must have {description}")
    return sizes.get("out", sizes["F"])


DERIVED_FROM_NOTHING: Sizes = {str(number): number for number in (0, 2, 3, 4)}


def _values(estimator: Any, path: str) -> Iterator[Any]:
    """Values at a dotted path; `*`: each item of a list, `?` at the end: may be None."""
    found = [estimator]
    for part in path.rstrip("?").split("."):
        if part == "*":
            found = [each for value in found for each in value]
        elif part.lstrip("-").isdigit():
            found = [value[int(part)] for value in found]
        else:
            default = [None] if path.endswith("?") else []
            found = [getattr(value, part, *default) for value in found]
        if path.endswith("?"):
            found = [value for value in found if value is not None]
    yield from found


def _check_array(value: Any, declared: str, name: str, sizes: Sizes) -> None:
    """declared: names of sizes, then a rule: `>0`, `>=0`, `<SIZE` of indices, or one of KINDS."""
    words = declared.split()
    rule = words.pop() if words and (words[-1][0] in "<>" or words[-1] in KINDS) else ""
    array = np.asarray(value)
    kinds = KINDS.get(rule[:1] if rule.startswith("<") else rule, "f")
    number = not words and isinstance(value, int | float | np.number)
    if array.size and array.dtype.kind not in kinds and not number:
        raise UnsoundError(f"`{name}` is of another type, {array.dtype}")
    _check_shape(array, words, name, sizes)
    if rule and not _follows_rule(array, rule, sizes):
        raise UnsoundError(f"`{name}` must be {_rule_text(rule)} everywhere")


def _check_shape(array: np.ndarray, words: list[str], name: str, sizes: Sizes) -> None:
    if array.ndim == len(words):
        for word, size in zip(words, array.shape, strict=True):
            if word not in DERIVED:
                sizes.setdefault(word, size)
        expected = tuple(_size(word, sizes) for word in words)
        if array.shape == expected:
            return
    else:
        expected = tuple(words)
    raise UnsoundError(f"`{name}` has shape {array.shape}, where {expected} belongs")


def _size(word: str, sizes: Sizes) -> int:
    return DERIVED[word](sizes) if word in DERIVED else sizes[word]


def _follows_rule(array: np.ndarray, rule: str, sizes: Sizes) -> bool:
    if rule == "classes":
        return array.size > 1 and np.array_equal(np.unique(array), array)
    if rule in KINDS:
        return True
    if rule.startswith("<"):
        return bool(((array >= 0) & (array < _size(rule[1:], sizes))).all())
    return bool((array > 0).all() if rule == ">0" else (array >= 0).all())


def _rule_text(rule: str) -> str:
    if rule == "classes":
        return "distinct and ascending"
    return f"from 0 on and {rule}" if rule.startswith("<") else rule


def _check_guards(guards: Guards | None, features: int | None) -> None:
    """Check the guards; guards of changes use other features than the pipeline."""
    if guards is None:
        return
    for name in ("kinds", "several"):
        guard = getattr(guards, name)
        if guard is not None:
            check_estimator(guard, features, f"guards.{name}")
    _check_guards(guards.changes, None)


def check_guard(guard: KindGuard, where: str) -> None:
    """Raises UnsoundError that names an inconsistent part of a guard; where: its name."""
    try:
        _check_numbers(vars(guard), where)
        check_estimator(guard, None, where)
    except UnsoundError:
        raise
    except Exception as error:  # a part of another type can raise anything
        raise UnsoundError(" ".join(str(error).split())) from error


def _check_numbers(value: Any, name: str) -> None:
    """Raises UnsoundError if a number or an array in `value` is not finite."""
    if isinstance(value, np.ndarray | np.floating | float):
        array = np.asarray(value)
        if array.dtype.kind == "O":
            sound = all(isinstance(each, str) for each in array.ravel())
        elif isinstance(value, np.ndarray) and not name.endswith(MAY_BE_MINUS_INFINITY):
            sound = array.dtype.kind in "biuU" or bool(np.isfinite(array).all())
        else:
            sound = not np.isnan(array).any() and not (array == np.inf).any()
        if not sound:
            raise UnsoundError(f"`{name}` must be finite everywhere")
    elif isinstance(value, Mapping):
        for key, part in value.items():
            _check_numbers(part, f"{name}.{key}")
    elif isinstance(value, list | tuple):
        for number, part in enumerate(value):
            _check_numbers(part, f"{name}.{number}")
    elif hasattr(value, "__dict__") and not isinstance(value, type):
        _check_numbers(vars(value), name)


def _check_prediction(learned: Classifier | Regressor, features: int) -> None:
    """Predict one sweep of zeros, unless that requires tables from the simulator."""
    if hasattr(learned.pipeline[-1], "for_baseline"):
        return
    sweep, changes = np.zeros((1, features)), None
    if learned.guards is not None and learned.guards.changes is not None:
        guard: Any = learned.guards.changes.kinds
        changes = np.zeros((1, guard.n_features_in_))
    with np.errstate(all="ignore"):
        predicted = (
            [learned.probabilities(sweep)]
            if isinstance(learned, Classifier)
            else learned.positions(sweep)
        )
        learned.novel(sweep, changes)
    sizes = (learned.classes.size,) if isinstance(learned, Classifier) else (OUTPUTS,)
    if any(each.shape != (1, *sizes) for each in predicted):
        raise UnsoundError(f"its answers have shapes {[each.shape for each in predicted]}")
    if not np.isfinite(predicted[0]).all():
        raise UnsoundError("its answers are no finite numbers")

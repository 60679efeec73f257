"""Plain data: frozen dataclasses of arrays, numbers and names, which check themselves.

A field is a number, a name, an array, another plain object, or a tuple or mapping of these. Its
annotation states what it may hold. That of an array names its sizes; sizes of one name are equal
within an object, and to a whole number of that name. A rule may follow: `>0`, `>=0`, `<F` of
indices below a size, or one of KINDS. Without a rule an array holds finite floating-point numbers;
with `log` they may be minus infinity.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import field, fields, is_dataclass
from functools import cache
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Self, Union, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import ArrayLike, NDArray

Sizes = dict[str, int]
Arrays = dict[str, NDArray]
KINDS = {"<": "iu", "int": "iu", "bool": "b", "classes": "biuU", "labels": "biuU", "log": "f"}
"""Kinds of numpy types that a rule allows; others take floating-point numbers of 4 or 8 bytes."""
CLOSE = 1e-6
"""Relative tolerance of a quantity that follows from others."""
KIND = "kind"
"""Key of the name of the class in a description."""


class UnsoundError(ValueError):
    """A field is not what its object declares; the message names it."""

    def __init__(self, name: str, reason: str) -> None:
        super().__init__(f"`{name}` {reason}")
        self.name, self.reason = name, reason

    def within(self, path: str) -> UnsoundError:
        """This error, named from the object that holds the faulty one at a path."""
        return UnsoundError(f"{path}.{self.name}" if path else self.name, self.reason)


def transient(**default: Any) -> Any:
    """A field that is neither checked nor stored. default: as for `dataclasses.field`."""
    return field(compare=False, repr=False, metadata={"transient": True}, **default)


class Plain:
    """Base of plain data, to be a frozen dataclass. Raises UnsoundError when it is made."""

    def __post_init__(self) -> None:
        sizes: Sizes = {}
        for name, hint in _hints(type(self)).items():
            value = _checked(getattr(self, name), hint, name, sizes)
            object.__setattr__(self, name, value)
            if isinstance(value, int):
                sizes[name] = value
        self._check(sizes)

    def _check(self, sizes: Sizes) -> None:
        """Raises UnsoundError if fields do not fit each other."""

    def described(self) -> tuple[dict[str, Any], Arrays]:
        """The object as a tree for JSON, and its arrays by the names in the tree."""
        arrays: Arrays = {}
        return _encoded(self, "", arrays), arrays

    @classmethod
    def of(cls, description: Any, arrays: Arrays) -> Self:
        """The object of `described`. Raises UnsoundError if a part is missing or unsound."""
        used: set[str] = set()
        found = _decoded(description, cls, arrays, "", used)
        if used != arrays.keys():
            raise UnsoundError(min(arrays.keys() - used), "is an array without a place")
        return found


def require(holds: object, name: str, reason: str) -> None:
    """Raises UnsoundError unless a condition holds."""
    if not holds:
        raise UnsoundError(name, reason)


def is_close(one: ArrayLike, other: ArrayLike) -> bool:
    """True if equal up to rounding, relative to the largest value."""
    size = max(float(np.abs(other).max(initial=0.0)), np.finfo(float).tiny)
    return bool((np.abs(np.asarray(one) - other) <= CLOSE * size).all())


def require_orthonormal(rows: NDArray, name: str) -> None:
    """Raises UnsoundError unless the rows of each matrix, (..., k, F), are orthonormal."""
    products = rows @ np.swapaxes(rows, -1, -2)
    require(is_close(products, np.eye(rows.shape[-2])), name, "must be orthonormal")


@cache
def _hints(kind: Any) -> dict[str, Any]:
    """Annotations of the stored fields."""
    hints = get_type_hints(kind, include_extras=True)
    return {
        each.name: hints[each.name] for each in fields(kind) if not each.metadata.get("transient")
    }


def _parted(hint: Any) -> tuple[Any, str, bool]:
    """The type (or plain types), the rule of an annotation, and True if it may be None."""
    rule, optional = "", False
    if get_origin(hint) in (Union, UnionType):
        kinds = tuple(each for each in get_args(hint) if each is not NoneType)
        optional = len(kinds) < len(get_args(hint))
        hint = kinds[0] if len(kinds) == 1 else kinds
    if get_origin(hint) is Annotated:
        hint, rule = get_args(hint)
    return hint, rule, optional


def _checked(value: Any, hint: Any, name: str, sizes: Sizes) -> Any:
    """The value, as its annotation says. Raises UnsoundError."""
    hint, rule, optional = _parted(hint)
    if optional and value is None:
        return None
    origin = get_origin(hint)
    if hint is np.ndarray or origin is np.ndarray:
        return _checked_array(value, rule, name, sizes)
    if origin is tuple:
        require(isinstance(value, tuple), name, "must be a list")
        return tuple(
            _checked(each, own, f"{name}.{k}", sizes)
            for k, (each, own) in enumerate(_items(value, hint, name))
        )
    if origin in (Mapping, dict):
        require(isinstance(value, Mapping), name, "must be a table")
        own = get_args(hint)[1]
        return {
            str(key): _checked(each, own, f"{name}.{key}", sizes) for key, each in value.items()
        }
    if origin is Literal:
        allowed = ", ".join(map(repr, get_args(hint)))
        require(value in get_args(hint), name, f"must be one of {allowed}")
        return value
    return _checked_single(value, hint, rule, name)


def _checked_single(value: Any, kind: Any, rule: str, name: str) -> Any:
    wanted = {float: (int, float, np.floating), int: (int, np.integer)}.get(kind, kind)
    if not isinstance(value, wanted) or (kind in (int, float) and isinstance(value, bool)):
        raise UnsoundError(name, "is of another type")
    if kind in (int, float):
        small = abs(value) < 2**63 if isinstance(value, int) else math.isfinite(value)
        require(small, name, "must be finite")
        require(_follows(np.asarray(value), rule, {}), name, f"must be {rule}")
        return kind(value)
    return value


def _items(value: tuple, hint: Any, name: str) -> Iterator[tuple[Any, Any]]:
    """Items of a tuple with their annotations."""
    own = get_args(hint)
    if own[-1] is Ellipsis:
        return ((each, own[0]) for each in value)
    require(len(value) == len(own), name, f"must have {len(own)} items")
    return zip(value, own, strict=True)


def _checked_array(value: Any, declared: str, name: str, sizes: Sizes) -> NDArray:
    require(isinstance(value, np.ndarray), name, "must be an array")
    *words, rule = [*declared.split(), ""]
    if words and (words[-1][0] in "<>" or words[-1] in KINDS):
        rule = words.pop()
    kinds = KINDS.get(rule[:1] if rule.startswith("<") else rule, "f")
    real = kinds != "f" or value.dtype.itemsize in (4, 8)
    require(value.dtype.kind in kinds and real, name, f"is of another type, {value.dtype}")
    _check_shape(value, words, name, sizes)
    if value.dtype.kind == "f":
        finite = np.isfinite(value) | (value == -np.inf if rule == "log" else False)
        require(finite.all(), name, "must be finite everywhere")
    require(_follows(value, rule, sizes), name, f"must be {_rule_text(rule)} everywhere")
    return value


def _check_shape(array: NDArray, words: list[str], name: str, sizes: Sizes) -> None:
    expected = tuple(words)
    if array.ndim == len(words):
        for word, size in zip(words, array.shape, strict=True):
            sizes.setdefault(word, int(word) if word.isdigit() else size)
        expected = tuple(sizes[word] for word in words)
    if array.shape != expected:
        raise UnsoundError(name, f"has shape {array.shape}, where {expected} belongs")


def _follows(array: NDArray, rule: str, sizes: Sizes) -> bool:
    if rule == "classes":
        return array.size > 1 and np.array_equal(np.unique(array), array)
    if rule.startswith("<"):
        return bool(((array >= 0) & (array < sizes[rule[1:]])).all())
    if rule.startswith(">"):
        return bool((array > 0).all() if rule == ">0" else (array >= 0).all())
    return True


def _rule_text(rule: str) -> str:
    if rule == "classes":
        return "distinct and ascending"
    return f"from 0 on and {rule}" if rule.startswith("<") else rule


def _encoded(value: Any, path: str, arrays: Arrays) -> Any:
    def below(name: object) -> str:
        return f"{path}.{name}" if path else str(name)

    if isinstance(value, Plain):
        own = {name: getattr(value, name) for name in _hints(type(value))}
        return {KIND: type(value).__name__, **_encoded(own, path, arrays)}
    if isinstance(value, np.ndarray):
        arrays[path] = value
        return path
    if isinstance(value, Mapping):
        return {key: _encoded(each, below(key), arrays) for key, each in value.items()}
    if isinstance(value, tuple):
        return [_encoded(each, below(k), arrays) for k, each in enumerate(value)]
    return value


def _decoded(tree: Any, hint: Any, arrays: Arrays, path: str, used: set[str]) -> Any:
    def below(own: Any, kind: Any, name: object) -> Any:
        return _decoded(own, kind, arrays, f"{path}.{name}" if path else str(name), used)

    hint, _, optional = _parted(hint)
    if optional and tree is None:
        return None
    origin = get_origin(hint)
    if hint is np.ndarray or origin is np.ndarray:
        require(isinstance(tree, str) and tree in arrays, path, "is missing")
        used.add(tree)
        return arrays[tree]
    if origin is tuple:
        require(isinstance(tree, list), path, "must be a list")
        items = _items(tuple(tree), hint, path)
        return tuple(below(each, own, k) for k, (each, own) in enumerate(items))
    if origin in (Mapping, dict):
        require(isinstance(tree, dict), path, "must be a table")
        return {key: below(each, get_args(hint)[1], key) for key, each in tree.items()}
    bases = hint if isinstance(hint, tuple) else (hint,)
    if origin is Literal or not issubclass(bases[0], Plain):
        return tree
    kind = _kind(tree, bases, path)
    hints = _hints(kind)
    require(tree.keys() - {KIND} == hints.keys(), path or KIND, "has other fields than its kind")
    own = {name: below(tree[name], each, name) for name, each in hints.items()}
    try:
        return kind(**own)
    except UnsoundError as error:
        raise error.within(path) from None


def _kind(tree: Any, bases: tuple[type[Plain], ...], path: str) -> type[Plain]:
    """The class that a description names: one of these, or derived from one."""
    require(isinstance(tree, dict) and KIND in tree, path or KIND, "is no object")
    known = {each.__name__: each for base in bases for each in _derived(base) if is_dataclass(each)}
    require(isinstance(tree[KIND], str) and tree[KIND] in known, path or KIND, "is of another kind")
    return known[tree[KIND]]


def _derived(base: type[Plain]) -> Iterator[type[Plain]]:
    yield base
    for each in base.__subclasses__():
        yield from _derived(each)

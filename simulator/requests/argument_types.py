"""Checks that arguments of public functions have the annotated types."""
# pyright: standard

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import wraps
from inspect import signature
from numbers import Integral, Real
from pathlib import Path
from typing import (
    TYPE_CHECKING,
    Any,
    NamedTuple,
    NoReturn,
    ParamSpec,
    TypeAlias,
    TypeGuard,
    TypeVar,
)

if TYPE_CHECKING:
    import xarray as xr

    from ..scene.scene import Scene

    Sweeps: TypeAlias = xr.Dataset | str | Path | Sequence[str | Path]

Given = ParamSpec("Given")
Made = TypeVar("Made")


def typed(function: Callable[Given, Made]) -> Callable[Given, Made]:
    """Decorator: raises InputError for an argument that does not have the annotated type."""

    @wraps(function)
    def call(*given: Given.args, **named: Given.kwargs) -> Made:
        own = signature(function)
        for name, value in own.bind(*given, **named).arguments.items():
            check_type(name, value, str(own.parameters[name].annotation))
        return function(*given, **named)

    return call


def check_type(name: str, value: object, annotation: str) -> None:
    """Raises InputError for a value that does not have the annotated type."""
    kind = annotation.removesuffix(" | None")
    if kind not in KINDS or (value is None and kind != annotation):
        return
    expected, fits, _ = KINDS[kind]
    if not fits(value):
        refuse(name, expected, value)


def whole(value: object) -> TypeGuard[int]:
    """True for a whole number, also of NumPy, but not for True and False."""
    return isinstance(value, Integral) and not isinstance(value, bool)


def real(value: object) -> TypeGuard[float]:
    """True for a real number, also of NumPy, but not for True and False."""
    return isinstance(value, Real) and not isinstance(value, bool)


def _all(kind: Callable[[object], bool]) -> Callable[[object], bool]:
    return lambda value: isinstance(value, list | tuple) and all(map(kind, value))


def _text(value: object) -> bool:
    return isinstance(value, str)


def _path(value: object) -> bool:
    return isinstance(value, str | Path)


def _band(value: object) -> bool:
    return _text(value) or (_all(real)(value) and len(value) == 2)  # type: ignore[arg-type]


def _scene(value: object) -> bool:
    from ..scene.scene import Scene

    return isinstance(value, str | Path | Scene)


class Kind(NamedTuple):
    """What an annotation allows: in words, a test of a value, the type on the command line."""

    expected: str
    fits: Callable[[object], bool]
    typed: Any


KINDS = {
    "int": Kind("a whole number", whole, int),
    "float": Kind("a number", real, float),
    "bool": Kind("True or False", lambda value: isinstance(value, bool), bool),
    "str": Kind("a text", _text, str),
    "str | Path": Kind("a path", _path, Path),
    "Path": Kind("a path", _path, Path),
    "Sequence[str]": Kind("a list of texts", _all(_text), list[str]),
    "Sequence[int]": Kind("a list of whole numbers", _all(whole), list[int]),
    "Sequence[float]": Kind("a list of numbers", _all(real), list[float]),
    "Sequence[Path]": Kind("a list of paths", _all(_path), list[Path]),
    "str | tuple[float, float]": Kind("two numbers", _band, str),
    "Scene | str | Path": Kind("a Scene, a name or a path", _scene, str),
    "Sweeps": Kind("sweeps", lambda value: True, list[Path]),
    "Iterable[str]": Kind("a list of texts", lambda value: not _text(value), list[str]),
}
"""The kind of each annotation that is checked."""


def scene_of(given: Scene | str | Path) -> Scene:
    """The scene itself, or the scene with that name or path. Raises InputError."""
    from ..scene.scene import Scene
    from ..scene.scene_files import load_scene

    if isinstance(given, str | Path):
        return load_scene(given)
    if isinstance(given, Scene):
        return given
    refuse("scene", "a Scene, a name or a path", given)


def sweeps_of(given: Sweeps, name: str = "sweeps") -> xr.Dataset:
    """The sweeps themselves, or those in the file or files. name: the argument's.

    Raises InputError.
    """
    import xarray as xr

    from ..sweeps import read, read_joined

    if isinstance(given, str | Path):
        return read(given)
    if isinstance(given, xr.Dataset):
        return given
    if given and _all(_path)(given):
        return read_joined([Path(each) for each in given])
    refuse(name, "an xarray.Dataset or a path", given)


def path_of(given: str | Path, name: str = "path") -> str | Path:
    """The path. name: the argument's. Raises InputError if it is not a path."""
    return given if isinstance(given, str | Path) else refuse(name, "a path", given)


def typed_paths(given: object) -> list[Path]:
    """The paths that were typed."""
    return given if isinstance(given, list) else [Path(str(given))]


def refuse(name: str, allowed: str, given: object) -> NoReturn:
    """Raises InputError that names the argument and the allowed values."""
    from ..sweeps.errors import InputError, named

    text = repr(given)
    brief = text if len(text) <= 60 and "\n" not in text else f"a {type(given).__name__}"
    raise InputError(f"{named(name)} must be {allowed}, got {brief}")

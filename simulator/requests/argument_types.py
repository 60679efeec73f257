"""Checks that arguments of public functions have the annotated types."""
# pyright: standard

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import wraps
from numbers import Integral, Real
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn, ParamSpec, TypeGuard, TypeVar

if TYPE_CHECKING:
    from ..scene.scene import Scene

Given = ParamSpec("Given")
Made = TypeVar("Made")


def typed(function: Callable[Given, Made]) -> Callable[Given, Made]:
    """Decorator: raises InputError for an argument that does not have the annotated type."""

    @wraps(function)
    def call(*given: Given.args, **named: Given.kwargs) -> Made:
        arguments_of(function, given, named)
        return function(*given, **named)

    return call


def arguments_of(
    function: Callable[..., object], given: tuple[object, ...], named: Mapping[str, Any]
) -> dict[str, Any]:
    """The arguments by the function's parameters.

    Raises InputError, in one line that names the parameter, for a value that does not have the
    annotated type. Annotations that KINDS lacks are not checked.
    """
    from inspect import signature

    own = signature(function)
    bound = own.bind(*given, **named).arguments
    for name, value in bound.items():
        _check_type(name, value, str(own.parameters[name].annotation))
    return bound


def _check_type(name: str, value: object, annotation: str) -> None:
    kind = annotation.removesuffix(" | None")
    if kind not in KINDS or (value is None and kind != annotation):
        return
    expected, fits = KINDS[kind]
    if not fits(value):
        refuse(name, expected, value)


def whole(value: object) -> TypeGuard[int]:
    """True for a whole number, also of NumPy, but not for True and False."""
    return isinstance(value, Integral) and not isinstance(value, bool)


def real(value: object) -> TypeGuard[float]:
    """True for a real number, also of NumPy, but not for True and False."""
    return isinstance(value, Real) and not isinstance(value, bool)


def _texts(value: object) -> bool:
    return isinstance(value, list | tuple) and all(isinstance(each, str) for each in value)


def _two_numbers(value: object) -> bool:
    return isinstance(value, list | tuple) and len(value) == 2 and all(map(real, value))


def _scene(value: object) -> bool:
    from ..scene.scene import Scene

    return isinstance(value, str | Path | Scene)


KINDS: dict[str, tuple[str, Callable[[object], bool]]] = {
    "int": ("a whole number", whole),
    "float": ("a number", real),
    "bool": ("True or False", lambda value: isinstance(value, bool)),
    "str": ("a text", lambda value: isinstance(value, str)),
    "Sequence[str]": ("a list of texts", _texts),
    "Iterable[str]": ("a list of texts", lambda value: not isinstance(value, str)),
    "tuple[float, float]": ("two numbers", _two_numbers),
    "Scene | str | Path": ("a Scene, a name or a path", _scene),
}
"""Description of each annotation, and a function that tests a value."""


def scene_of(given: Scene | str | Path) -> Scene:
    """The scene itself, or the scene with that name or path. Raises InputError."""
    from ..scene.scene import Scene
    from ..scene.scene_files import load_scene

    if isinstance(given, str | Path):
        return load_scene(given)
    if isinstance(given, Scene):
        return given
    refuse("scene", "a Scene, a name or a path", given)


def refuse(name: str, allowed: str, given: object) -> NoReturn:
    """Raises InputError that names the argument and the allowed values."""
    from ..sweeps import InputError

    text = repr(given)
    brief = text if len(text) <= 60 and "\n" not in text else f"a {type(given).__name__}"
    raise InputError(f"`{name}` must be {allowed}, got {brief}")

"""Checks of the arguments of public functions: an object or the path of its file."""
# pyright: standard

from __future__ import annotations

import re
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn, ParamSpec, TypeVar

if TYPE_CHECKING:
    import xarray as xr

    from ...simulator.scene.scene import Scene

Given = ParamSpec("Given")
Made = TypeVar("Made")
OPTION = re.compile(r"--([a-z][a-z-]*)")
"""Matches a command line option in an error message."""


def checked(function: Callable[Given, Made]) -> Callable[Given, Made]:
    """Decorator: checks the arguments like those of the command of the same name.

    Raises InputError, in one line that names the parameter, for a number outside its range and for
    a value that does not have the annotated type.
    """

    @wraps(function)
    def call(*given: Given.args, **named: Given.kwargs) -> Made:
        from inspect import signature

        from ...simulator.requests.number_ranges import check_numbers
        from ...simulator.sweeps import InputError

        own = signature(function)
        bound = own.bind(*given, **named).arguments
        for name, value in bound.items():
            _check_kind(name, value, str(own.parameters[name].annotation))
        check_numbers(function.__name__, bound)
        try:
            return function(*given, **named)
        except InputError as error:
            text = OPTION.sub(lambda match: _as_parameter(match, own.parameters), str(error))
            if text == str(error):
                raise
            raise InputError(text) from error

    return call


def _as_parameter(option: re.Match[str], parameters: Any) -> str:
    """The option as a parameter, `max_frequency` for --max-frequency, if it is one."""
    name = option[1].replace("-", "_")
    return f"`{name}`" if name in parameters else option[0]


def _check_kind(name: str, value: object, annotation: str) -> None:
    """Raises InputError if the value does not have the annotated type."""
    kind = annotation.removesuffix(" | None")
    if kind not in KINDS or (value is None and kind != annotation):
        return
    expected, fits = KINDS[kind]
    if not fits(value):
        refuse(name, expected, value)


def _whole(value: object) -> bool:
    from numbers import Integral

    return isinstance(value, Integral) and not isinstance(value, bool)


def _real(value: object) -> bool:
    from numbers import Real

    return isinstance(value, Real) and not isinstance(value, bool)


def _texts(value: object) -> bool:
    return isinstance(value, list | tuple) and all(isinstance(each, str) for each in value)


def _two_numbers(value: object) -> bool:
    return isinstance(value, list | tuple) and len(value) == 2 and all(map(_real, value))


KINDS: dict[str, tuple[str, Callable[[object], bool]]] = {
    "int": ("a whole number", _whole),
    "float": ("a number", _real),
    "bool": ("True or False", lambda value: isinstance(value, bool)),
    "Sequence[str]": ("a list of texts", _texts),
    "tuple[float, float]": ("two numbers", _two_numbers),
}
"""Description of each annotation, and a function that tests a value."""


def scene_of(given: Scene | str | Path) -> Scene:
    """The scene itself, or the scene with that name or path. Raises InputError."""
    from ...simulator.scene.scene import Scene
    from ...simulator.scene.scene_files import load_scene

    if isinstance(given, str | Path):
        return load_scene(given)
    if isinstance(given, Scene):
        return given
    refuse("scene", "a Scene, a name or a path", given)


def sweeps_of(given: xr.Dataset | str | Path, name: str = "sweeps") -> xr.Dataset:
    """The sweeps themselves, or those in the file. name: the argument's. Raises InputError."""
    import xarray as xr

    from ...simulator.sweeps import read

    if isinstance(given, str | Path):
        return read(given)
    if isinstance(given, xr.Dataset):
        return given
    refuse(name, "an xarray.Dataset or a path", given)


def path_of(given: str | Path, name: str = "path") -> str | Path:
    """The path. name: the argument's. Raises InputError if it is not a path."""
    return given if isinstance(given, str | Path) else refuse(name, "a path", given)


def refuse(name: str, allowed: str, given: object) -> NoReturn:
    """Raises InputError that names the argument and the allowed values."""
    from ...simulator.sweeps import InputError

    text = repr(given)
    brief = text if len(text) <= 60 and "\n" not in text else f"a {type(given).__name__}"
    raise InputError(f"`{name}` must be {allowed}, got {brief}")

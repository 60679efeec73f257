"""Checks of the arguments of public functions: an object or the path of its file."""
# pyright: standard

from __future__ import annotations

import re
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

from ...simulator.requests.argument_types import arguments_of, refuse

if TYPE_CHECKING:
    import xarray as xr

    from ..model.localizer_model import Model

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

        bound = arguments_of(function, given, named)
        check_numbers(function.__name__, bound)
        try:
            return function(*given, **named)
        except InputError as error:
            known = signature(function).parameters
            text = OPTION.sub(lambda match: _as_parameter(match, known), str(error))
            if text == str(error):
                raise
            raise InputError(text) from error

    return call


def _as_parameter(option: re.Match[str], parameters: Any) -> str:
    """The option as a parameter, if it is one: `max_frequency`, or `overwrite=True` for a flag."""
    name = option[1].replace("-", "_")
    if name not in parameters:
        return option[0]
    return f"`{name}=True`" if parameters[name].default is False else f"`{name}`"


def sweeps_of(given: xr.Dataset | str | Path, name: str = "sweeps") -> xr.Dataset:
    """The sweeps themselves, or those in the file. name: the argument's. Raises InputError."""
    import xarray as xr

    from ...simulator.sweeps import read

    if isinstance(given, str | Path):
        return with_view(read(given))
    if isinstance(given, xr.Dataset):
        return with_view(given)
    refuse(name, "an xarray.Dataset or a path", given)


def with_view(sweeps: xr.Dataset) -> xr.Dataset:
    """The sweeps themselves; from now on all have the attribute `rcskin` that shows them."""
    from ...simulator.check import sweeps_view  # noqa: F401

    return sweeps


def model_of(given: Model | str | Path) -> Model:
    """The model itself, or the one in the file. Raises InputError if it is neither."""
    from ..model.localizer_file import load
    from ..model.localizer_model import Model

    if isinstance(given, str | Path):
        return load(given)
    return given if isinstance(given, Model) else refuse("model", "a Model or a path", given)


def path_of(given: str | Path, name: str = "path") -> str | Path:
    """The path. name: the argument's. Raises InputError if it is not a path."""
    return given if isinstance(given, str | Path) else refuse(name, "a path", given)

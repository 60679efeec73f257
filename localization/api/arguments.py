"""Checks of the arguments of public functions: an object or the path of its file."""
# pyright: standard

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

from ...simulator.requests.argument_types import arguments_of, refuse

if TYPE_CHECKING:
    import xarray as xr

    from ...simulator.check.sweep_curves import Quantity
    from ...simulator.scene.scene import Scene
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


def read(path: str | Path) -> xr.Dataset:
    """Read sweeps from a file, simulated or measured.

    path: .nc, .csv or .zarr. Raises InputError in one line if the file holds no sweeps.
    """
    return sweeps_of(path_of(path))


@checked
def write(
    given: xr.Dataset | Model | Scene,
    path: str | Path,
    *,
    overwrite: bool = False,
    overwrite_measured: bool = False,
) -> None:
    """Write sweeps into .nc, .csv or .zarr, a model into .npz, or a scene into .toml.

    The file is written completely or not at all. given: sweeps, a model or a scene. path: file to
    write. overwrite: True replaces a file that exists. overwrite_measured: True replaces even
    measured sweeps. Raises InputError for another ending, an absent folder, or a file that exists
    and may not be replaced.
    """
    from ...simulator.sweeps.output_files import replacing

    with replacing(overwrite, overwrite_measured):
        _written(given, path_of(path))


def _written(given: xr.Dataset | Model | Scene, path: str | Path) -> None:
    import xarray as xr

    from ...simulator.scene.scene import Scene
    from ...simulator.scene.scene_files import write_scene
    from ...simulator.sweeps import write as write_sweeps

    if isinstance(given, xr.Dataset):
        return write_sweeps(given, path)
    if isinstance(given, Scene):
        return write_scene(path, given)
    from ..model.localizer_file import save
    from ..model.localizer_model import Model

    if isinstance(given, Model):
        return save(path, given)
    refuse("given", "sweeps (an xarray.Dataset), a Model or a Scene", given)


@checked
def plot(
    sweeps: xr.Dataset | str | Path,
    path: str | Path,
    what: Sequence[Quantity] = (),
    *,
    overwrite: bool = False,
) -> Path:
    """Plot quantities of each press against frequency, as a picture or as a page to zoom.

    sweeps: the sweeps or the path of their file. path: .png, .svg, .pdf or .html; the function
    returns it. what: any of "Rs", "Cp", "change-Rs", "change-Cp" (from the unpressed skin), "phase"
    and "nyquist"; by default Rs and Cp and, if the unpressed skin was measured, their changes.
    overwrite: True replaces a file that exists. Raises InputError for another ending, an absent
    folder, or a file that exists and may not be replaced.
    """
    from ...simulator.check.sweep_curves import draw
    from ...simulator.sweeps.output_files import replacing

    with replacing(overwrite):
        return draw([sweeps_of(sweeps)], path_of(path), what)

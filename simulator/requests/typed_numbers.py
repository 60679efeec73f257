"""Numbers of options as they are typed: with a unit and a prefix, or without."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from copy import copy
from functools import wraps
from typing import Annotated, Any, get_args, get_origin

import typer

from .number_ranges import option_name, range_of

NUMBERS = {
    float: (float, "a number"),
    float | None: (float, "a number"),
    list[float] | None: (float, "a number"),
    int: (int, "a whole number"),
    int | None: (int, "a whole number"),
    list[int] | None: (int, "a whole number"),
}
"""Kind of number of each annotation, in code and in words."""


def with_units(commands: typer.Typer) -> None:
    """Makes the numeric options of every command take a unit, such as "10 kHz" in place of 1e4."""
    for each in commands.registered_commands:
        assert each.callback is not None
        each.callback = _with_units(each.callback, each.name or each.callback.__name__)


def _with_units(callback: Callable[..., Any], command: str) -> Callable[..., Any]:
    @wraps(callback)
    def call(*arguments: Any, **given: Any) -> Any:
        return callback(*arguments, **given)

    signature = inspect.signature(callback, eval_str=True)
    annotations = {}
    for name, parameter in signature.parameters.items():
        annotation = annotations[name] = parameter.annotation
        kind, *metadata = get_args(annotation) if get_origin(annotation) is Annotated else [None]
        if kind in NUMBERS:
            option: Any = copy(metadata[0])
            option.parser = _parser(command, name, option_name(callback, name), *NUMBERS[kind])
            option.metavar = f"<{getattr(kind, '__name__', str(kind)).removesuffix(' | None')}>"
            annotations[name] = Annotated[kind, option]
    call.__annotations__ = {**callback.__annotations__, **annotations}
    call.__dict__["__signature__"] = signature.replace(
        parameters=[
            each.replace(annotation=annotations[name])
            for name, each in signature.parameters.items()
        ]
    )
    return call


def _parser(
    command: str, name: str, option: str, kind: type[int] | type[float], in_words: str
) -> Callable[[str | float], float]:
    """Function from what is typed to the number. A default is a number already."""
    unit = range_of(command, name).unit

    def parse(given: str | float) -> float:
        from ..sweeps.units import quantity

        if not isinstance(given, str):
            return given
        try:
            return kind(given)
        except ValueError:
            pass
        try:
            value = quantity(given, unit)
            if kind is float or value.is_integer():
                return kind(value)
        except ValueError:
            pass
        of_unit = f" in {unit}" if unit else ""
        raise typer.TyperException(f"{option} must be {in_words}{of_unit}, got {given!r}")

    return parse

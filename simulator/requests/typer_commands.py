"""Commands of the command line, made from the classes of their requests."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import MISSING, Field
from inspect import Parameter, Signature
from typing import Annotated, Any, get_args

import typer

from .argument_types import KINDS
from .request import How, Request, Writing, fields_of, paragraphs, way

NUMBERS = {float: "a number", int: "a whole number"}
WARNERS = r"(sklearn|rcskin\.localization)(\.|$)"
"""Modules to which scikit-learn's warnings are attributed: its own and their callers. Users cannot
act on them."""


def add_commands(app: typer.Typer, *requests: type[Request]) -> None:
    """Add the commands of these requests, each with its help and its example."""
    for request in requests:
        add = app.command(
            request.command_name,
            short_help=" ".join(paragraphs(request)[0].split()),
            epilog=f"Example: rcskin {request.example}" if request.example else None,
        )
        add(callback_of(request))


def callback_of(request: Any) -> Callable[..., None]:
    """Function of what is typed, as typer reads it."""
    own = [each for each in fields_of(request) if way(each).typed]
    options = {each.name: option_name(each) for each in own if not way(each).placed}

    def call(**given: Any) -> None:
        from ..sweeps.errors import named_as_typed

        names = {_parameter_name(each): each.name for each in own}
        typed = {names[name]: value for name, value in given.items()}
        with named_as_typed(options), warnings.catch_warnings():
            warnings.filterwarnings("ignore", module=WARNERS)
            made = request.of(typed)
            with _replacing(made):
                code = made.run()
        if code:
            raise typer.Exit(code)

    call.__doc__ = request.__doc__
    parameters = [_parameter(each) for each in own]
    call.__dict__["__signature__"] = Signature(parameters)
    call.__annotations__ = {each.name: each.annotation for each in parameters}
    return call


def _replacing(request: Request) -> AbstractContextManager[None]:
    if not isinstance(request, Writing):
        return nullcontext()
    from ..sweeps.output_files import replacing

    return replacing(request.overwrite, request.overwrite_measured)


def option_name(given: Field[Any]) -> str:
    """What is typed for an option."""
    flags = way(given).how.flags
    return flags[0].partition("/")[0] if flags else f"--{given.name.replace('_', '-')}"


def _parameter_name(given: Field[Any]) -> str:
    flags = way(given).how.flags
    return flags[0] if way(given).placed and flags and flags[0].isidentifier() else given.name


def _parameter(given: Field[Any]) -> Parameter:
    """The parameter of a field, annotated for typer."""
    how, placed = way(given).how, way(given).placed
    kind, default = _kind(given), _default(given)
    more: dict[str, Any] = {"help": how.help, "autocompletion": how.complete or _completion(how)}
    number = next((each for each in (kind, *get_args(kind)) if each in NUMBERS), None)
    if number is not None:
        more["parser"] = _parser(option_name(given), number, how.within.unit)
        more["metavar"] = f"<{getattr(kind, '__name__', '') if kind is number else kind}>"
    if default is None:
        kind = kind | None
    if not placed:
        flags = how.flags or ((option_name(given),) if bool in (kind, *get_args(kind)) else ())
        described = typer.Option(*flags, **more)
    else:
        name = how.flags[0] if how.flags and not how.flags[0].isidentifier() else None
        described = typer.Argument(metavar=name, **more)
    name = _parameter_name(given)
    return Parameter(
        name, Parameter.KEYWORD_ONLY, default=default, annotation=Annotated[kind, described]
    )


def _completion(how: How) -> Callable[[], list[str]] | None:
    return (lambda: list(how.among)) if how.among else None


def _kind(given: Field[Any]) -> Any:
    """The type on the command line, without None."""
    known = KINDS.get(str(given.type).removesuffix(" | None"))
    return way(given).how.kind or (known.typed if known else str)


def _default(given: Field[Any]) -> Any:
    default = way(given).typed_default
    default = given.default if default is MISSING else default
    if default in (MISSING, ...):
        return Parameter.empty
    return None if default == () else default


def _parser(option: str, kind: Any, unit: str | None) -> Callable[[str | float], float]:
    """Function from what is typed to the number. A default is a number already."""

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
        raise typer.TyperException(f"{option} must be {NUMBERS[kind]}{of_unit}, got {given!r}")

    return parse

"""Options of every command that writes: what it may replace (see `sweeps.output_files`)."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import wraps
from typing import Annotated, Any

import typer

OUTPUTS = ("output", "log")
"""Parameters that name what a command writes."""
OPTIONS = {
    "overwrite": "Replace files and folders that exist.",
    "overwrite_measured": "Replace even measured sweeps, and damaged files that may hold some.",
}


def with_overwrite_options(commands: typer.Typer) -> None:
    """Adds the overwrite options to every command that writes."""
    for each in commands.registered_commands:
        callback = each.callback
        if callback and {*OUTPUTS} & {*inspect.signature(callback).parameters}:
            each.callback = _with_overwrite(callback)


def _with_overwrite(command: Callable[..., Any]) -> Callable[..., Any]:
    @wraps(command)
    def run(*, overwrite: bool, overwrite_measured: bool, **given: Any) -> Any:
        from ..sweeps.output_files import replacing

        with replacing(overwrite, overwrite_measured):
            return command(**given)

    signature = inspect.signature(command, eval_str=True)
    switches = {
        option: Annotated[bool, typer.Option(f"--{option.replace('_', '-')}", help=text)]
        for option, text in OPTIONS.items()
    }
    more = [
        inspect.Parameter(option, inspect.Parameter.KEYWORD_ONLY, default=False, annotation=kind)
        for option, kind in switches.items()
    ]
    run.__annotations__ = {**command.__annotations__, **switches}
    run.__dict__["__signature__"] = signature.replace(
        parameters=[*signature.parameters.values(), *more]
    )
    return run

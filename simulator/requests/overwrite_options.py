"""Options of every command that writes: what it may overwrite (see `sweeps.writing`)."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable
from functools import wraps
from pathlib import Path
from typing import Annotated, Any

import typer

OUTPUTS = ("output", "log")
"""Parameters that name what a command writes."""
OPTIONS = {
    "overwrite": "Overwrite even files that this command did not make.",
    "overwrite_measured": "Overwrite even measured sweeps.",
}


def with_overwrite_options(commands: typer.Typer, above: str = "") -> None:
    """Adds the overwrite options to every command that writes.

    above: the parent command, such as `meter`.
    """
    for each in commands.registered_commands:
        callback = each.callback
        if callback and {*OUTPUTS} & {*inspect.signature(callback).parameters}:
            name = each.name or callback.__name__
            each.callback = _with_overwrite(callback, f"{above} {name}".strip())


def _with_overwrite(command: Callable[..., Any], name: str) -> Callable[..., Any]:
    @wraps(command)
    def run(*, overwrite: bool, overwrite_measured: bool, **given: Any) -> Any:
        from ..sweeps.writing import WriteContext, in_write_context

        others = (value for key, value in given.items() if key not in OUTPUTS)
        with in_write_context(WriteContext(name, _paths(others), overwrite, overwrite_measured)):
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


def _paths(given: Iterable[Any]) -> tuple[Path, ...]:
    """Parameter values that may be paths of files."""
    flat = (part for each in given for part in (each if isinstance(each, list) else [each]))
    return tuple(Path(each) for each in flat if isinstance(each, str | Path) and each)

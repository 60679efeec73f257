"""Options that several commands share, and what those that write may replace."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import wraps
from typing import Annotated, Any

import typer


def complete_scene(incomplete: str) -> list[str]:
    """Completes names and paths of scenes in the shell."""
    from ..sweeps.builtin import scenes_beginning

    return scenes_beginning(incomplete)


SceneName = Annotated[
    str,
    typer.Argument(help="A built-in scene's name, or a path.", autocompletion=complete_scene),
]
Interfaces = Annotated[
    list[str] | None, typer.Option(help="Use only this interface of the scene; may be repeated.")
]
TouchSide = Annotated[
    float | None, typer.Option(help="Side of a square touch in mm; default: the sides of a pixel.")
]
TouchFactor = Annotated[
    float | None, typer.Option(help="Capacitance under the touch over that of the unpressed skin.")
]
BASELINE_SWEEPS = 3
"""Default number of baseline sweeps whose mean each sweep is compared with."""
AgainstRest = Annotated[
    int, typer.Option(help="Sweeps of the unpressed skin that each sweep is compared with.")
]
Charts = Annotated[
    str,
    typer.Option(
        help="File format of charts: png, svg or pdf.", autocompletion=lambda: ["png", "svg", "pdf"]
    ),
]


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

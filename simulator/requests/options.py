"""Options that several commands share."""

from typing import Annotated

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

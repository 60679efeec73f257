"""Options that several commands have, each said once."""

from typing import Annotated

import typer


def complete_scene(incomplete: str) -> list[str]:
    """Names and paths of scenes for the shell."""
    from ..sweeps.builtin import scenes_beginning

    return scenes_beginning(incomplete)


SceneName = Annotated[
    str,
    typer.Argument(help="A built-in scene's name, or a path.", autocompletion=complete_scene),
]
Interfaces = Annotated[
    list[str] | None, typer.Option(help="Only this one of the scene's; may be repeated.")
]
TouchSide = Annotated[
    float | None, typer.Option(help="Side of a square touch in mm; else a pixel's sides.")
]
TouchFactor = Annotated[
    float | None, typer.Option(help="Capacitance under the touch over that at rest.")
]
BASELINE_SWEEPS = 3
"""Sweeps of the unpressed skin whose mean localizers compare a sweep with."""
AgainstRest = Annotated[
    int, typer.Option(help="Sweeps of the skin at rest that each sweep is compared with.")
]
Charts = Annotated[
    str,
    typer.Option(
        help="What charts are: png, svg or pdf.", autocompletion=lambda: ["png", "svg", "pdf"]
    ),
]

"""The command `rcskin describe`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..requests.options import SceneName
from ..safe_text import say


def describe(
    scene: SceneName,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="A drawing: OUT.png, .svg or .pdf.")
    ] = None,
) -> None:
    """Describe a scene in words, and draw it.

    The output names sizes, sheets, foam, capacitance, foils and interfaces;
    the cut-off frequency and the frequencies of the sweep; rows and columns
    that no meter can distinguish; the noise of the meter; and the defaults
    of keys that the file does not set.
    """
    from ..press.pixels import pixels_with_skin
    from ..requests.console import report_written
    from ..requests.requested_scene import requested_scene, warn_of_model
    from ..sweeps import checked_output
    from .facts import described
    from .scene_drawing import ENDINGS, draw_scene

    if output is not None:
        checked_output(output, ENDINGS)
    loaded = requested_scene(scene)
    warn_of_model(scene, loaded)
    say(*described(loaded).splitlines())
    if output is not None:
        report_written("drawing", draw_scene(loaded, pixels_with_skin(loaded.parts.skin), output))

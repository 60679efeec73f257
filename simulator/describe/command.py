"""The command `rcskin describe`."""

from __future__ import annotations

from pathlib import Path

from ..requests.options import SCENE
from ..requests.request import Writing, argument, typed
from ..safe_text import say


class Describe(Writing, example="describe sheet-5x5 -o sheet.png"):
    """Describe a scene in words, and draw it.

    The output names sizes, sheets, foam, capacitance, foils and interfaces;
    the cut-off frequency and the frequencies of the sweep; rows and columns
    that no meter can distinguish; the noise of the meter; and the defaults
    of keys that the file does not set.
    """

    scene: str = argument(SCENE)
    output: Path | None = typed("A drawing: OUT.png, .svg or .pdf.", "--output", "-o", default=None)

    def run(self) -> None:
        from ..press.pixels import pixels_with_skin
        from ..requests.console import report_written
        from ..requests.requested_scene import requested_scene, warn_of_model
        from ..sweeps import checked_output
        from .facts import described
        from .scene_drawing import ENDINGS, draw_scene

        if self.output is not None:
            checked_output(self.output, ENDINGS)
        loaded = requested_scene(self.scene)
        warn_of_model(self.scene, loaded)
        say(*described(loaded).splitlines())
        if self.output is not None:
            report_written(
                "drawing", draw_scene(loaded, pixels_with_skin(loaded.parts.skin), self.output)
            )

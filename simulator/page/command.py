"""The command `rcskin page`."""

from __future__ import annotations

from pathlib import Path

from ..requests.number_ranges import AllowedRange
from ..requests.options import EXACTNESS, SCENE
from ..requests.request import Writing, argument, typed

CELLS = 2


class Page(Writing, example="page sheet-5x5 -o skin.html"):
    """Write a page on which the skin is pressed: one file, for any browser, offline.

    It shows the meter's readings, the field, and where a localizer places the
    touch; sliders change the sheets and the foam. `rcskin view -o OUT.png`
    draws a single press in space instead.
    """

    scene: str = argument(SCENE)
    output: Path = typed("OUT.html.", "--output", "-o")
    rtol: float = typed(EXACTNESS, default=1e-3)
    cells: int = typed(
        "Cells along each side of a pixel, 1 to 6, for touches anywhere.",
        within=AllowedRange(1, 6, "the page grows with their square"),
        default=CELLS,
    )

    def run(self) -> None:
        from ..models.mechanics.force_depths import pressed_by_factors
        from ..progress import Overall, on_terminal
        from ..requests.console import note, report_written
        from ..requests.requested_scene import note_if_noise_free, requested_scene
        from ..requests.time_estimates import page_parts
        from ..scene.frequency import LOSSLESS
        from ..scene.supports import supported
        from ..sweeps import checked_output, whole_file

        checked_output(self.output, (".html",))
        requested = requested_scene(self.scene)
        pressed = pressed_by_factors(supported("a page", requested.parts), spread=False)
        skin, setup = pressed.skin, pressed.setup
        note_if_noise_free(self.scene, setup, pressed.meter)
        with on_terminal() as bars:
            progress = Overall("page in all", page_parts(skin, setup, self.rtol, self.cells), bars)
            from ..models.reduced.touches import scene_spreads_presses
            from .document import document
            from .packed import page_data, reduced_for_page

            reduced = reduced_for_page(pressed, self.rtol, self.cells, progress)
            text = document(page_data(pressed, reduced))
        if scene_spreads_presses(requested.parts.skin, requested.press):
            factor = f"{pressed.plan.press.capacitance_factor:.4g} x C"
            spread = "the spread of a press by the foam's tension is left out"
            note(f"{self.scene}: the page presses whole pixels uniformly, by {factor}; {spread}")
        if skin.around is not None and skin.foam.loss != LOSSLESS:
            lossless = "rcskin sweep takes air without loss"
            note(
                f"{self.scene}: the page gives the air around the skin the foam's loss; {lossless}"
            )
        with whole_file(self.output) as path:
            path.write_text(text, encoding="utf-8")
        report_written(f"page of {skin.name}, {len(text) / 1e6:.1f} MB", self.output)

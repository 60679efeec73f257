"""The command `rcskin frequencies`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..requests.number_ranges import FREQUENCIES
from ..requests.options import (
    AGAINST_REST,
    BASELINE_SWEEPS,
    INTERFACES,
    SCENE,
    TOUCH_FACTOR,
    TOUCH_SIDE,
)
from ..requests.request import Request, argument, typed
from ..safe_text import say, terminal

if TYPE_CHECKING:
    from ..report.findings import Findings
    from .frequency_design import FrequencyDesign


class Frequencies(Request, example="frequencies sheet-5x5 -n 8"):
    """Choose the best n frequencies; compare with Eq. 6 of the paper and log spacing.

    Any two differ by at least 10 %, if there is room for n of them: nearer
    ones would repeat a reading. The last line says what the choice is optimal
    for: touch, noise, criterion and candidates. For positions, the table shows the median
    error as `limits` does; sets are compared by the rms bound. In a pipe the
    output is one frequency in Hz per line, and the comparison goes to standard
    error.
    """

    scene: str = argument(SCENE)
    n: int = typed("Number of frequencies.", "-n", within=FREQUENCIES)
    criterion: str = typed(
        "position: the bound on the position error, rms over the sheet; column or pixel: "
        "the distance of the nearest two in the meter's errors.",
        among=("position", "column", "pixel"),
        default="position",
    )
    band: str | None = typed(
        "LOW:HIGH in Hz; default: the scene's lowest and highest frequency.", default=None
    )
    among: str | None = typed(
        "The only candidates: scene (the scene's frequencies), or F,F,... in Hz.", default=None
    )
    grid: int = typed("Number of candidate frequencies.", default=60)
    interface: Sequence[str] | None = typed(INTERFACES, default=None)
    size: float | None = typed(TOUCH_SIDE, default=None)
    factor: float | None = typed(TOUCH_FACTOR, default=None)
    against_rest: int = typed(AGAINST_REST, default=BASELINE_SWEEPS)
    repeats: bool = typed("A frequency may be chosen more than once.", default=False)

    def run(self) -> None:
        from ..bounds.frequency_sets import chosen_band, frequencies_among
        from ..bounds.position_bound import chosen_touch
        from ..models.mechanics.force_depths import pressed_by_factors
        from ..progress import on_terminal
        from ..requests.requested_scene import requested_scene
        from ..scene.supports import supported
        from .frequency_design import check_design, design
        from .survey import with_interfaces

        by_factors = pressed_by_factors(supported("a limit", requested_scene(self.scene).parts))
        loaded = with_interfaces(by_factors, self.interface or [])
        chosen_from = frequencies_among(self.among, loaded.setup)
        check_design(
            self.n, self.grid if chosen_from is None else len(chosen_from), self.repeats, self.grid
        )
        with on_terminal() as progress:
            found = design(
                loaded,
                self.n,
                chosen_band(self.band, loaded.setup),
                chosen_touch(
                    loaded.skin,
                    loaded.plan.press,
                    None if self.size is None else 1e-3 * self.size,
                    self.factor,
                ),
                criterion=self.criterion,
                grid=self.grid,
                against_rest=self.against_rest,
                repeats=self.repeats,
                among=chosen_from,
                progress=progress,
            )
        if terminal().is_terminal:
            return _findings(found).show()
        for frequency in found.best:
            say(f"{frequency:.6g}")
        for name in found.sets:
            say(f"{name}: {found.comparison(name)}", err=True)
        say(found.optimal_for, err=True)
        return None


def _findings(found: FrequencyDesign) -> Findings:
    from ..report.findings import DataTable, Findings

    heads = ["", "frequencies (Hz)", found.heading, found.over]
    rows = [
        [
            name,
            ", ".join(f"{frequency:.6g}" for frequency in chosen),
            found.figure_text(name),
            f"{found.ratio(name):.3g}",
        ]
        for name, chosen in found.sets.items()
    ]
    return Findings("Frequencies", [DataTable("sets", heads, rows), found.optimal_for])

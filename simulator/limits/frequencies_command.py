"""The command `rcskin frequencies`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from ..requests.options import (
    BASELINE_SWEEPS,
    AgainstRest,
    Interfaces,
    SceneName,
    TouchFactor,
    TouchSide,
)
from ..safe_text import say, terminal

if TYPE_CHECKING:
    from rich.table import Table

    from .frequency_design import FrequencyDesign


def frequencies(
    scene: SceneName,
    n: Annotated[int, typer.Option("-n", help="Number of frequencies.")],
    criterion: Annotated[
        str,
        typer.Option(
            autocompletion=lambda: ["position", "column", "pixel"],
            help="position: the bound on the position error, rms over the sheet; column or pixel: "
            "the distance of the nearest two in the meter's errors.",
        ),
    ] = "position",
    band: Annotated[
        str | None,
        typer.Option(help="LOW:HIGH in Hz; default: the scene's lowest and highest frequency."),
    ] = None,
    among: Annotated[
        str | None,
        typer.Option(
            help="The only candidates: scene (the scene's frequencies), or F,F,... in Hz."
        ),
    ] = None,
    grid: Annotated[int, typer.Option(help="Number of candidate frequencies.")] = 60,
    interface: Interfaces = None,
    size: TouchSide = None,
    factor: TouchFactor = None,
    against_rest: AgainstRest = BASELINE_SWEEPS,
    repeats: Annotated[
        bool, typer.Option("--repeats", help="A frequency may be chosen more than once.")
    ] = False,
) -> None:
    """Choose the best n frequencies; compare with Eq. 6 of the paper and log spacing.

    Any two differ by at least 10 %, if there is room for n of them: nearer
    ones would repeat a reading. The last line says what the choice is optimal
    for: touch, noise, criterion and candidates. For positions, the table shows the median
    error as `limits` does; sets are compared by the rms bound. In a pipe the
    output is one frequency in Hz per line, and the comparison goes to standard
    error.
    """

    from ..bounds.frequency_sets import chosen_band, frequencies_among
    from ..bounds.position_bound import chosen_touch
    from ..models.mechanics.force_depths import pressed_by_factors
    from ..progress import on_terminal
    from ..requests.requested_scene import requested_scene
    from .frequency_design import check_design, checked_criterion, design
    from .survey import with_interfaces

    by_factors = pressed_by_factors(requested_scene(scene).parts, "a limit")
    loaded = with_interfaces(by_factors, interface or [])
    chosen_from = frequencies_among(among, loaded.setup)
    check_design(n, grid if chosen_from is None else len(chosen_from), repeats, grid)
    with on_terminal() as progress:
        found = design(
            loaded,
            n,
            chosen_band(band, loaded.setup),
            chosen_touch(
                loaded.skin, loaded.plan.press, None if size is None else 1e-3 * size, factor
            ),
            criterion=checked_criterion(criterion),
            grid=grid,
            against_rest=against_rest,
            repeats=repeats,
            among=chosen_from,
            progress=progress,
        )
    console = terminal()
    if console.is_terminal:
        console.print(_table(found))
        say(found.optimal_for)
        return
    for frequency in found.best:
        say(f"{frequency:.6g}")
    for name in found.sets:
        say(f"{name}: {found.comparison(name)}", err=True)
    say(found.optimal_for, err=True)


def _table(found: FrequencyDesign) -> Table:
    from ..report.files import table

    heads = ["", "frequencies (Hz)", found.heading, found.over]
    rows = (
        [
            name,
            ", ".join(f"{frequency:.6g}" for frequency in chosen),
            found.figure_text(name),
            f"{found.ratio(name):.3g}",
        ]
        for name, chosen in found.sets.items()
    )
    return table(heads, rows)

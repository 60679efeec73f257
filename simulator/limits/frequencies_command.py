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

    from .design import Design


def frequencies(
    scene: SceneName,
    n: Annotated[int, typer.Option("-n", help="How many.")],
    criterion: Annotated[
        str,
        typer.Option(
            autocompletion=lambda: ["position", "column", "pixel"],
            help="position: the bound on the distance from the touch, rms over the sheet; column "
            "or pixel: the distance of the nearest two in the meter's errors.",
        ),
    ] = "position",
    band: Annotated[
        str | None,
        typer.Option(help="LOW:HIGH in Hz; what is absent is the scene's lowest or highest."),
    ] = None,
    among: Annotated[
        str | None,
        typer.Option(
            help="Choose from these alone: scene, for those of the scene, or F,F,... in Hz."
        ),
    ] = None,
    grid: Annotated[int, typer.Option(help="How many to choose from.")] = 60,
    interface: Interfaces = None,
    size: TouchSide = None,
    factor: TouchFactor = None,
    against_rest: AgainstRest = BASELINE_SWEEPS,
    repeats: Annotated[
        bool, typer.Option("--repeats", help="A frequency may be read more than once.")
    ] = False,
) -> None:
    """The n frequencies that tell most, beside Eq. 6 of the paper and log spacing.

    Any two differ by 10 % or more, as far as n find room; nearer ones would
    repeat a reading. By position, the error is the median error that `limits`
    shows; sets are compared by the rms bound. In a pipe one frequency in Hz a
    line; the comparison then goes to standard error.
    """

    from ..bounds.position import chosen_touch
    from ..bounds.sets import chosen_band, frequencies_among
    from ..models.mechanics.force_depths import foldable
    from ..progress import on_terminal
    from ..requests.requested_scene import requested_scene
    from .criteria import checked_criterion
    from .design import check_design, design
    from .survey import with_interfaces

    plain = foldable(requested_scene(scene), "a limit")
    loaded = with_interfaces(plain, interface or [])
    chosen_from = frequencies_among(among, loaded)
    check_design(n, grid if chosen_from is None else len(chosen_from), repeats, grid)
    with on_terminal() as progress:
        found = design(
            loaded,
            n,
            chosen_band(band, loaded),
            chosen_touch(loaded, None if size is None else 1e-3 * size, factor),
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
        return
    for frequency in found.best:
        say(f"{frequency:.6g}")
    for name in found.sets:
        say(f"{name}: {found.comparison(name)}", err=True)


def _table(found: Design) -> Table:
    from ..report.terminal import table

    heads = ["", "frequencies (Hz)", found.heading, found.over]
    rows = (
        [
            name,
            ", ".join(f"{frequency:.6g}" for frequency in chosen),
            found.told(name),
            f"{found.ratio(name):.3g}",
        ]
        for name, chosen in found.sets.items()
    )
    return table(heads, rows)

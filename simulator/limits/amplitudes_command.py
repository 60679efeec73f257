"""The command `rcskin amplitudes`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..requests.options import (
    BASELINE_SWEEPS,
    AgainstRest,
    SceneName,
    TouchFactor,
    TouchSide,
)
from ..safe_text import say, terminal

if TYPE_CHECKING:
    from rich.table import Table

    from .amplitude_shares import AmplitudeShares


def amplitudes(
    scene: SceneName,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output", "-o", help="Scene file with these amplitudes and their resistance, .toml."
        ),
    ] = None,
    criterion: Annotated[
        str,
        typer.Option(
            autocompletion=lambda: ["position", "column", "pixel"],
            help="position: the bound on the position error, rms over the sheet; column or pixel: "
            "the distance of the nearest two in the reader's errors.",
        ),
    ] = "position",
    size: TouchSide = None,
    factor: TouchFactor = None,
    against_rest: AgainstRest = BASELINE_SWEEPS,
) -> None:
    """Share the voltage of a multisine reader among its tones.

    The scene's interfaces have reader = "multisine". The shares minimize a
    limit of `limits`, at the peak voltage of the source. The feedback
    resistance follows: the amplifier's output for the unpressed skin peaks at
    70 % of the converter's range. The table compares them with equal
    amplitudes at their own resistance. In a pipe the output is one amplitude
    per line, relative to equal ones, and the comparison goes to standard
    error.
    """
    from ..bounds.position_bound import chosen_touch
    from ..models.mechanics.force_depths import foldable
    from ..progress import on_terminal
    from ..requests.requested_scene import requested_scene
    from ..scene.scene_files import write_scene
    from ..sweeps import checked_output
    from .amplitude_shares import shared_amplitudes
    from .criteria import checked_criterion

    loaded = foldable(requested_scene(scene), "a limit")
    if output is not None:
        checked_output(output, (".toml",))
    with on_terminal() as progress:
        found = shared_amplitudes(
            loaded,
            chosen_touch(loaded, None if size is None else 1e-3 * size, factor),
            criterion=checked_criterion(criterion),
            against_rest=against_rest,
            progress=progress,
        )
    if output is not None:
        write_scene(output, found.shared)
    console = terminal()
    if console.is_terminal:
        console.print(_table(found))
    else:
        for amplitude in found.amplitudes:
            say(f"{amplitude:.3g}")
    for line in found.summary:
        say(line, err=True)


def _table(found: AmplitudeShares) -> Table:
    from ..report.terminal import table

    heads = ["frequency (Hz)", "amplitude over equal", "noise, equal (%)", "noise, shared (%)"]
    columns = found.shared.frequencies, found.amplitudes, *(100 * d for d in found.deviations)
    rows = (
        [f"{f:.6g}", f"{amplitude:.3g}", f"{equal:.2g}", f"{shared:.2g}"]
        for f, amplitude, equal, shared in zip(*columns, strict=True)
    )
    return table(heads, rows, range(4))

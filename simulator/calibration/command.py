"""The command `rcskin calibrate`."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from .fit import Tell


def calibrate(
    scene: Annotated[str, typer.Argument(help="A built-in scene's name, or a path.")],
    measured: Annotated[Path, typer.Argument(help="Sweeps: FILE.nc, FILE.zarr or FILE.csv.")],
    output: Annotated[
        Path, typer.Option("--output", "-o", help="Folder for calibrated.toml, tables and charts.")
    ] = Path("calibration"),
    fit: Annotated[
        list[str] | None,
        typer.Option(help="A parameter to fit; may be repeated. Without it: all that are told."),
    ] = None,
    fix: Annotated[
        list[str] | None,
        typer.Option(help="A parameter to leave as the scene has it; may be repeated."),
    ] = None,
    band: Annotated[str | None, typer.Option(help="LOW:HIGH in Hz; either may be absent.")] = None,
    session: Annotated[int | None, typer.Option(help="The only session that counts.")] = None,
    fixed_strength: Annotated[
        bool, typer.Option("--fixed-strength", help="Take the strengths of presses as stated.")
    ] = False,
    prior: Annotated[
        str,
        typer.Option(
            help="What is known beforehand: wide (within ten times), or session (as the scene's "
            "dataset.session draws)."
        ),
    ] = "wide",
    charts: Annotated[str, typer.Option(help="What charts are: png, svg or pdf.")] = "png",
) -> None:
    """Fit a scene's parameters to measured sweeps, at rest and pressed.

    Parameters: sheet_resistance, sheet_mismatch, capacitance,
    contact_resistance (factors), loss_tangent, phase_exponent,
    lead_resistance, lead_inductance, stray_capacitance.

    Sweeps may have other frequencies than the scene, and some of its
    interfaces. The meter's errors are those of the scene's readout; where it
    states none, repeated sweeps at rest tell them, or what the fit leaves.

    FOLDER/calibrated.toml is the scene with the fitted values.
    """
    from rich.console import Console

    from ..asked.scene import asked_scene
    from ..charts import checked_ending
    from ..models.plain import plain_scene
    from ..scene.frequency import parse_band
    from ..sweeps import read
    from .choice import Options
    from .prior import checked_kind
    from .report import checked_folder, correlation_table, explanations, table, write_report
    from .run import calibrate as calibrated

    folder, ending = checked_folder(output), checked_ending(charts)
    options = Options(
        tuple(fit or ()),
        tuple(fix or ()),
        None if band is None else parse_band(band, (0.0, math.inf)),
        session,
        not fixed_strength,
        checked_kind(prior),
    )
    start, sweeps = plain_scene(asked_scene(scene), "a calibration"), read(measured)
    with telling() as tell:
        calibration = calibrated(start, sweeps, options, tell=tell)
    names = write_report(calibration, measured.name, folder, ending)
    console = Console()
    console.print(table(calibration))
    if len(calibration.intervals) > 1:
        console.print(correlation_table(calibration))
    for line in explanations(calibration):
        console.print(line, soft_wrap=True, markup=False, highlight=False)
    console.print(f"{folder}: {', '.join(names)}", soft_wrap=True, markup=False, highlight=False)


@contextmanager
def telling() -> Iterator[Tell]:
    """Shows what goes on, on a terminal; silence in a pipe."""
    from rich.console import Console

    from .fit import silent

    console = Console(stderr=True)
    if not console.is_terminal:
        yield silent
        return
    with console.status("fitting") as status:
        yield lambda told: status.update(told)

"""The commands on data: bring sweeps in from other tools, check any, make and export many."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    import xarray as xr

    from simulator.sweeps.imports import Defaults

FLAGGED = 1


def import_sweeps(
    files: Annotated[list[Path], typer.Argument(help="Tables of other tools; joined in order.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="OUT.nc or OUT.csv.")],
    press: Annotated[
        list[str] | None,
        typer.Option(
            help="The press of a file without a press column: 'none', ROW,COLUMN[:FACTOR] or any "
            "text. Given once it holds for every file, else once for each."
        ),
    ] = None,
    interface: Annotated[
        list[str] | None,
        typer.Option(help="The interface of a file without such a column, once or for each."),
    ] = None,
    session: Annotated[
        list[int] | None,
        typer.Option(help="The session of a file without such a column, once or for each."),
    ] = None,
) -> None:
    """Bring in measured sweeps from tables of other tools.

    A table has named columns in any order, with units: a frequency, as
    `Frequency (kHz)` or `f/Hz`, and Rs and X (`Z'`, `-Z''`), |Z| and phase
    (`theta (deg)`), Rs and Cs, or Rs and Cp. Of the two reactances that Rs and
    Cp leave open (X1 X2 = Rs^2), X is the one with |X| >= Rs, a phase between
    -90 and -45 degrees; the result says so in its attribute `branch_rule`.

    Separators are comma, semicolon or tab; decimal commas, comments (# % ;) and
    lines above the header are understood. Columns of a sweep, press, row,
    column, repetition, interface or session label the lines; without them a
    sweep begins where the frequencies start over.
    """
    from simulator.sweeps import checked_output, write
    from simulator.sweeps.imports import import_files

    checked_output(output)
    sweeps = import_files(files, _defaults(len(files), press, interface, session))
    write(sweeps, output)
    counts = ", ".join(f"{name} {size}" for name, size in sweeps.sizes.items())
    typer.echo(f"{output}: {counts}")
    if "branch_rule" in sweeps.attrs:
        typer.echo(f"{output}: {sweeps.attrs['branch_rule']}")


def _defaults(
    files: int, press: Sequence | None, interface: Sequence | None, session: Sequence | None
) -> list[Defaults]:
    from simulator.sweeps.imports import Defaults

    given = {"press": press, "interface": interface, "session": session}
    spread = [_for_each(name, values, files) for name, values in given.items()]
    return [Defaults(*each) for each in zip(*spread, strict=True)]


def _for_each(name: str, values: Sequence[Any] | None, files: int) -> list[Any]:
    from simulator.sweeps import InputError

    values = values or [None]
    if len(values) not in (1, files):
        raise InputError(f"--{name} must be given once or {files} times, got {len(values)}")
    return list(values) * (files if len(values) == 1 else 1)


def check(
    file: Annotated[Path, typer.Argument(help="Sweeps: FILE.nc, FILE.zarr, or a CSV of any tool.")],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="REPORT.png, or a folder for the chart and tables."),
    ] = None,
    noise: Annotated[
        float | None,
        typer.Option(
            help="Relative standard deviation of a reading, where it is known. Without it, it is "
            "told from repeated sweeps of one press, or from the residuals."
        ),
    ] = None,
    tolerance: Annotated[
        float, typer.Option(help="Largest rms residual of the Kramers-Kronig fit, over |Z|.")
    ] = 0.02,
) -> None:
    """Check sweeps against the laws of passive RC networks; code 1 where one is broken.

    Re Z >= 0 and Im Z <= 0; Rs, Cp and Cs do not increase with frequency; and
    the nearest sum of R, L, C and RC elements, all >= 0, follows every reading
    within the noise (Kramers-Kronig).
    """
    from rich.console import Console

    from simulator.check import checked_report, explanations, verdict_table, write_report
    from simulator.sweeps import InputError
    from simulator.sweeps.examination import examine

    report = None if output is None else checked_report(output)
    sweeps = _read(file)
    try:
        judgements = examine(sweeps, noise, tolerance)
    except InputError as error:
        raise InputError(f"{file}: {error}") from error
    console = Console()
    console.print(verdict_table(judgements))
    for line in explanations(judgements):
        console.print(line, soft_wrap=True, markup=False, highlight=False)
    if report is not None:
        write_report(judgements, report)
    flagged = sum(bool(each.broken) for each in judgements)
    console.print(f"{flagged} of {len(judgements)} spectra flagged", highlight=False)
    if flagged:
        raise typer.Exit(FLAGGED)


def _read(file: Path) -> xr.Dataset:
    from simulator.sweeps import read
    from simulator.sweeps.imports import import_file

    return read(file) if file.suffix in (".nc", ".zarr") else import_file(file)


def dataset(
    scene: Annotated[str, typer.Argument(help="A built-in scene's name, or a path.")],
    sweeps: Annotated[int, typer.Option(help="How many sweeps.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="OUT.zarr.")],
    seed: Annotated[int, typer.Option(help="Decides every draw.")] = 1,
    rtol: Annotated[
        float, typer.Option(help="Largest relative error of Rs and of Cp, before the readout.")
    ] = 1e-4,
    workers: Annotated[
        int | None, typer.Option(help="Processes on this machine; all cores without it.")
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(help="Address of a Dask scheduler, whose workers see the same folder."),
    ] = None,
) -> None:
    """Make a data set of randomised skins and presses, as the meter would show them.

    What is drawn, and how, stands in the scene's tables `dataset.press` and
    `dataset.session`; the meter's errors in `readout`. Killed at any point, the
    same command goes on. The bytes depend on the scene, SWEEPS, SEED, RTOL and
    the version only, and sweep k on neither SWEEPS nor who computes it.
    """
    from simulator.dataset import Plan, generate
    from simulator.dataset.bar import on_terminal
    from simulator.electrical import plain_scene
    from simulator.scene_file import load_scene
    from simulator.sweeps import InputError, open_zarr

    if workers is not None and workers < 1:
        raise InputError(f"--workers must be >= 1, got {workers}")
    plan = Plan(plain_scene(load_scene(scene), "a data set"), sweeps, seed, rtol)
    with on_terminal(plan.scene.name, sweeps) as advance:
        generate(plan, output, processes=workers or _cores(), scheduler=scheduler, advance=advance)
    told = open_zarr(output).attrs
    typer.echo(
        f"{output}: {sweeps} sweeps; {told['audit_sample']} certified, largest bound on the "
        f"relative error {told['audit_bound']:.1e}; {told['fallbacks']} solved in full"
    )
    if "cells_error" in told:
        typer.echo(
            f"{output}: touches are laid on cells, which changes Rs and Cp by up to "
            f"{told['cells_error']:.1e}; more cells_per_pixel change less"
        )


def _cores() -> int:
    """Processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def export(
    data: Annotated[Path, typer.Argument(help="A data set, DATA.zarr.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="OUT.nc, OUT.csv or OUT.parquet.")],
) -> None:
    """Write a data set as NetCDF, CSV or Parquet.

    NetCDF keeps everything. CSV is the long form of sweeps, a line for each
    frequency. Parquet has one row a sweep: labels, touches, and columns
    Rs_INTERFACE_HERTZ, X_INTERFACE_HERTZ and Cp_INTERFACE_HERTZ.
    """
    from simulator.dataset.export import export as write_as

    write_as(data, output)

"""The commands of data sets: make one, and write one in other formats."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer


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
    from ..models.plain import plain_scene
    from ..scene.files import load_scene
    from ..sweeps import InputError, open_zarr
    from ..sweeps.errors import InterruptedWorkError
    from .bar import on_terminal
    from .plan import Plan
    from .run import generate

    if workers is not None and workers < 1:
        raise InputError(f"--workers must be >= 1, got {workers}")
    plan = Plan(plain_scene(load_scene(scene), "a data set"), sweeps, seed, rtol)
    processes = workers or _cores()
    try:
        with on_terminal(plan.scene.name, sweeps) as advance:
            generate(plan, output, processes=processes, scheduler=scheduler, advance=advance)
    except KeyboardInterrupt:
        raise InterruptedWorkError("the same command goes on from here") from None
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
    from .export import export as write_as

    write_as(data, output)

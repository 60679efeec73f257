"""The command `rcskin dataset`."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Annotated

import typer

from ..requests.options import SceneName
from ..safe_text import say

READINGS_A_SECOND = 6e5
"""Approximate speed of one process: 32 800 sweeps of 20 frequencies per second."""


def dataset(
    scene: SceneName,
    sweeps: Annotated[int, typer.Option(help="Number of sweeps.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="OUT.zarr.")],
    seed: Annotated[int, typer.Option(help="Seed of all random draws.")] = 1,
    rtol: Annotated[
        float,
        typer.Option(help="Largest relative error of exact Rs and of Cp, 1e-8 to 1e-2."),
    ] = 1e-4,
    workers: Annotated[
        int | None, typer.Option(help="Number of processes on this machine; default: one per core.")
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(help="Address of a Dask scheduler, whose workers see the same folder."),
    ] = None,
) -> None:
    """Make a data set of randomised skins and presses, as the meter would show them.

    The scene's tables `dataset.press` and `dataset.session` define what is
    drawn, `readout` the meter's errors. If the command is killed, running it
    again continues. The bytes depend only on the scene, SWEEPS, SEED, RTOL and
    the version; sweep k depends neither on SWEEPS nor on the number of workers.
    """
    from ..models.mechanics.force_depths import pressed_by_factors
    from ..progress import on_terminal
    from ..requests.console import report_written
    from ..requests.requested_scene import note_if_noise_free, requested_scene
    from ..requests.time_estimates import note_if_long
    from ..sweeps import sizes_text
    from ..sweeps.errors import InterruptedWorkError
    from .dataset_plan import DatasetPlan, readings
    from .generation import generate, is_complete
    from .store import finished_attributes, readings_along

    loaded = requested_scene(scene)
    plan = DatasetPlan(
        pressed_by_factors(loaded.parts, "a data set", creeps=True), sweeps, seed, rtol
    )
    if is_complete(plan, output):
        return say(f"{output}: is complete, nothing was computed; --overwrite makes it anew")
    note_if_noise_free(scene, loaded.parts.setup, loaded.parts.meter)
    processes = workers or _cpu_count()
    seconds = sweeps * readings(plan.parts.setup) / (READINGS_A_SECOND * processes)
    note_if_long(scene, 0 if scheduler else seconds, f"{sweeps} sweeps on {processes} processes")
    try:
        with on_terminal("sweeps") as progress:
            generate(plan, output, processes=processes, scheduler=scheduler, progress=progress)
    except KeyboardInterrupt:
        raise InterruptedWorkError("the same command continues from here") from None
    attributes = finished_attributes(output) or {}
    say(
        f"{output}: the errors of {attributes['audit_sample']} of the "
        f"{plan.sessions * plan.session_sweeps} sweeps of whole sessions were bounded, the largest "
        f"by {attributes['audit_bound']:.1e} of Rs and Cp; {attributes['fallbacks']} sweeps were "
        "solved without the reduced model"
    )
    if "cells_error" in attributes:
        changed = " and ".join(plan.parts.setup.kind.with_errors)
        say(
            f"{output}: rasterizing touches on cells changes {changed} by up to "
            f"{attributes['cells_error']:.1e}; a larger cells_per_pixel reduces it"
        )
    if "deflection_error" in attributes:
        say(
            f"{output}: of that change, solving the foam's deflection on a lattice causes up to "
            f"{attributes['deflection_error']:.1e}"
        )
    if one_skin := plan.one_skin("--sweeps {}"):
        say(f"{output}: {one_skin}")
    report_written(sizes_text(readings_along(plan)), output)


def _cpu_count() -> int:
    """Number of processors that this process may use."""
    if sys.platform == "linux" and hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1

"""The command `rcskin dataset`."""

from __future__ import annotations

import logging
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from ..requests.argument_types import scene_of
from ..requests.number_ranges import RTOL, SEED, SWEEPS, WORKERS
from ..requests.options import SCENE
from ..requests.request import Writing, argument, function, option, typed
from ..safe_text import say

LOG = logging.getLogger(__name__)
READINGS_A_SECOND = 6e5
"""Approximate speed of one process: 32 800 sweeps of 20 frequencies per second."""


if TYPE_CHECKING:
    import xarray as xr

    from ..scene.scene import Scene
    from .dataset_plan import DatasetPlan


class Dataset(Writing, example="dataset sheet-5x5 --sweeps 2000 -o skins.zarr"):
    """Make a data set of randomised skins and presses, as the meter would show them.

    The scene's tables `dataset.press` and `dataset.session` define what is
    drawn, `readout` the meter's errors. If the command is killed, running it
    again continues. The bytes depend only on the scene, SWEEPS, SEED, RTOL and
    the version; sweep k depends neither on SWEEPS nor on the number of workers.
    """

    scene: Scene | str | Path = argument(SCENE)
    sweeps: int = option(
        "Number of sweeps.",
        within=SWEEPS,
        called="number of sweeps, all in memory.",
        default=2000,
        typed_default=...,
        kw_only=False,
    )
    output: Path = typed("OUT.zarr.", "--output", "-o")
    seed: int = option("Seed of all random draws.", within=SEED, default=1)
    rtol: float = option(
        "Largest relative error of exact Rs and of Cp, 1e-8 to 1e-2.", within=RTOL, default=1e-4
    )
    workers: int | None = typed(
        "Number of processes on this machine; default: one per core.", within=WORKERS, default=None
    )
    scheduler: str | None = typed(
        "Address of a Dask scheduler, whose workers see the same folder.", default=None
    )

    def run(self) -> None:
        from ..progress import on_terminal
        from ..requests.console import report_written
        from ..requests.requested_scene import note_if_noise_free, requested_scene
        from ..requests.time_estimates import note_if_long
        from ..sweeps import sizes_text
        from ..sweeps.errors import InterruptedWorkError
        from .dataset_plan import readings
        from .generation import generate, is_complete
        from .store import finished_attributes, readings_along

        name = str(self.scene)
        loaded = requested_scene(name)
        plan = self._plan(loaded)
        if is_complete(plan, self.output):
            return say(
                f"{self.output}: is complete, nothing was computed; --overwrite makes it anew"
            )
        note_if_noise_free(name, loaded.parts.setup, loaded.parts.meter)
        processes = self.workers or _cpu_count()
        seconds = self.sweeps * readings(plan.parts.setup) / (READINGS_A_SECOND * processes)
        note_if_long(
            name, 0 if self.scheduler else seconds, f"{self.sweeps} sweeps on {processes} processes"
        )
        try:
            with on_terminal("sweeps") as progress:
                generate(
                    plan,
                    self.output,
                    processes=processes,
                    scheduler=self.scheduler,
                    progress=progress,
                )
        except KeyboardInterrupt:
            raise InterruptedWorkError("the same command continues from here") from None
        attributes = finished_attributes(self.output) or {}
        say(
            f"{self.output}: the errors of {attributes['audit_sample']} of the "
            f"{plan.sessions * plan.session_sweeps} sweeps of whole sessions were bounded, the "
            f"largest by {attributes['audit_bound']:.1e} of Rs and Cp; {attributes['fallbacks']} "
            "sweeps were solved without the reduced model"
        )
        if "cells_error" in attributes:
            changed = " and ".join(plan.parts.setup.kind.with_errors)
            say(
                f"{self.output}: rasterizing touches on cells changes {changed} by up to "
                f"{attributes['cells_error']:.1e}; a larger cells_per_pixel reduces it"
            )
        if "deflection_error" in attributes:
            say(
                f"{self.output}: of that change, solving the foam's deflection on a lattice causes "
                f"up to {attributes['deflection_error']:.1e}"
            )
        if one_skin := plan.one_skin("--sweeps {}"):
            say(f"{self.output}: {one_skin}")
        report_written(sizes_text(readings_along(plan)), self.output)

    def result(self) -> xr.Dataset:
        """Simulate sweeps of random skins and presses, with the meter's noise.

        They serve to train and to test models. The scene's tables `dataset.press` and
        `dataset.session` define the distributions. Logs a warning if all sweeps are of one skin,
        and if the meter has no noise.

        Raises InputError if a number is out of range, ToleranceError if rtol cannot be kept.
        """
        from ..requests.requested_scene import noise_free
        from .memory_dataset import in_memory

        plan = self._plan(scene_of(self.scene))
        exact = noise_free(plan.parts.setup, plan.parts.meter)
        for text in filter(None, (exact, plan.one_skin("sweeps={}"))):
            LOG.warning("%s: %s", plan.parts.skin.name, text)
        return in_memory(plan)

    def _plan(self, scene: Scene) -> DatasetPlan:
        from ..models.mechanics.force_depths import pressed_by_factors
        from ..scene.supports import supported
        from .dataset_plan import DatasetPlan

        parts = pressed_by_factors(supported("a data set", scene.parts))
        return DatasetPlan(parts, self.sweeps, self.seed, self.rtol)


dataset = function(Dataset)


def _cpu_count() -> int:
    """Number of processors that this process may use."""
    if sys.platform == "linux" and hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1

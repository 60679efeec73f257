"""Presses on a scene, solved and put into the schema of sweeps."""

from __future__ import annotations

from collections.abc import Iterable
from importlib.metadata import version
from typing import TYPE_CHECKING

import numpy as np

from simulator.fidelity import Answer, Solver
from simulator.press import Press
from simulator.scene_file import check_press, scene_text
from simulator.sweeps import build

if TYPE_CHECKING:
    import xarray as xr


def simulate(solver: Solver, presses: Iterable[Press]) -> xr.Dataset:
    """Noise-free sweeps, one for each press, with their estimated numerical errors.

    Raises InputError where a press does not fit the scene, ToleranceError where the tolerance is
    not reached.
    """
    answered = [(p, solver.solve(check_press(p, solver.scene))) for p in presses]
    return gather(solver, answered)


def gather(solver: Solver, answered: Iterable[tuple[Press, Answer]]) -> xr.Dataset:
    """Sweeps from presses that were answered already."""
    presses, answers = zip(*answered, strict=True)
    return build(
        np.stack([answer.Z for answer in answers]),
        solver.scene.frequencies,
        interface=[interface.name for interface in solver.scene.interfaces],
        press=[str(press) for press in presses],
        row=[press.pixel[0] for press in presses],
        column=[press.pixel[1] for press in presses],
        errors={
            "Rs_error": np.stack([answer.Rs_error for answer in answers]),
            "Cp_error": np.stack([answer.Cp_error for answer in answers]),
        },
        attributes={
            "scene": scene_text(solver.scene),
            "model": "; ".join(dict.fromkeys(answer.model for answer in answers)),
            "rtol": solver.rtol,
            "seed": solver.scene.experiment.seed,
            "software": f"rcskin {version('rcskin')}",
        },
    )

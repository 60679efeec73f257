"""Arguments that several commands share."""

from __future__ import annotations

from .number_ranges import BASELINES, FACTOR, MILLIMETRES, RTOL, SEED
from .request import How


def complete_scene(incomplete: str) -> list[str]:
    """Completes names and paths of scenes in the shell."""
    from ..sweeps.builtin import scenes_beginning

    return scenes_beginning(incomplete)


SCENE = How(
    "A built-in scene's name, or a path.",
    complete=complete_scene,
    called="the scene, its name or its path, see `load`.",
)
INTERFACES = How("Use only this interface of the scene; may be repeated.")
TOUCH_SIDE = How("Side of a square touch in mm; default: the sides of a pixel.", within=MILLIMETRES)
TOUCH_FACTOR = How("Capacitance under the touch over that of the unpressed skin.", within=FACTOR)
BASELINE_SWEEPS = 3
"""Default number of baseline sweeps whose mean each sweep is compared with."""
AGAINST_REST = How(
    "Sweeps of the unpressed skin that each sweep is compared with.", within=BASELINES
)
CHARTS = How("File format of charts: png, svg or pdf.", complete=lambda: ["png", "svg", "pdf"])
EXACTNESS = How("Largest relative error of Rs and of Cp, 1e-8 to 1e-2.", within=RTOL)
SEED_OF_ALL = How("Seed of all random numbers.", within=SEED)

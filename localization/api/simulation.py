"""Simulated sweeps of a scene: noise-free, as measured, as a data set; reduced models."""
# pyright: standard

from __future__ import annotations

import logging
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ...simulator.requests.argument_types import refuse, scene_of
from .arguments import checked, path_of, sweeps_of, with_view

if TYPE_CHECKING:
    import xarray as xr

    from ...simulator.models.reduced.reduced_model import Reduced
    from ...simulator.models.solver import ModelName
    from ...simulator.press.press import Press
    from ...simulator.scene.parts import Pressing, Skin
    from ...simulator.scene.scene import Scene

LOG = logging.getLogger(__name__)


def load(scene: str | Path) -> Scene:
    """Load a scene.

    scene: the name of a built-in scene, or the path of a TOML file. Raises InputError in one line
    that names the file, the key, the value and the allowed range.
    """
    from ...simulator.scene.scene_files import load_scene

    return load_scene(path_of(scene, "scene"))


@checked
def sweep(
    scene: Scene | str | Path,
    presses: Sequence[str | Press] | None = None,
    *,
    rtol: float = 1e-4,
    model: ModelName = "auto",
) -> xr.Dataset:
    """Simulate noise-free sweeps of presses, with the estimated errors of Rs and Cp.

    On foam that creeps the presses follow each other in this order, as in a session.
    scene: the scene, its name or its path, see `load`. presses: texts ("2,3", "1,1:1.5+4,4",
    "none") or objects `Press`; by default the unpressed skin, then every pixel. rtol: largest
    relative error of Rs and of Cp, 1e-8 to 1e-2. model: "auto", "lumped", "line", "sheet" or
    "reduced". Raises InputError for a press that does not fit the scene, ToleranceError if rtol
    cannot be kept.
    """
    from ...simulator.measure.simulate import check_fits, simulate
    from ...simulator.models.solver import Solver, checked_model
    from ...simulator.press.press import every_press

    scene = scene_of(scene)
    if isinstance(presses, Sequence) and not isinstance(presses, str):
        check_fits(scene.parts.setup, len(presses))
    parsed = (
        every_press(scene.parts.skin, scene.press)
        if presses is None
        else _presses(scene.parts.skin, scene.press, presses)
    )
    check_fits(scene.parts.setup, len(parsed))
    return with_view(simulate(Solver(scene.parts, rtol, checked_model(model)), parsed))


def _presses(skin: Skin, pressing: Pressing, given: Sequence[str | Press]) -> list[Press]:
    from ...simulator.press.press import Press, press_on

    each = [given] if isinstance(given, str | Press) else given
    if not isinstance(each, Sequence) or not all(isinstance(one, str | Press) for one in each):
        refuse("presses", 'a list of texts such as "2,3" or of Press', given)
    return [press_on(skin, pressing, one) if isinstance(one, str) else one for one in each]


@checked
def measured(sweeps: xr.Dataset | str | Path, seed: int = 1) -> xr.Dataset:
    """Add the noise and errors of the scene's meter to simulated sweeps, session by session.

    sweeps: the sweeps or the path of their file. seed: seed of the noise. Raises InputError if the
    sweeps store no scene.
    """
    from ...simulator.measure.simulate import read_by_meter
    from ...simulator.scene.scene_files import scene_of_sweeps
    from ...simulator.sweeps import InputError

    sweeps = sweeps_of(sweeps)
    scene = scene_of_sweeps(sweeps)
    if scene is None:
        raise InputError(
            "the sweeps store no scene; its `readout` is needed for the errors of the meter"
        )
    return read_by_meter(sweeps, scene.parts.meter, seed)


@checked
def dataset(
    scene: Scene | str | Path, sweeps: int = 2000, *, seed: int = 1, rtol: float = 1e-4
) -> xr.Dataset:
    """Simulate sweeps of random skins and presses, with the meter's noise.

    They serve to train and to test models.

    scene: the scene, its name or its path, see `load`; its tables `dataset.press` and
    `dataset.session` define the distributions. sweeps: number of sweeps, all in memory. seed: seed
    of all random numbers. rtol: largest relative error of Rs and of Cp before the noise. Logs a
    warning if all sweeps are of one skin, and if the meter has no noise. Raises InputError if a
    number is out of range, ToleranceError if rtol cannot be kept.
    """
    from ...simulator.dataset.dataset_plan import DatasetPlan
    from ...simulator.dataset.memory_dataset import in_memory
    from ...simulator.models.mechanics.force_depths import pressed_by_factors
    from ...simulator.requests.requested_scene import noise_free

    plan = DatasetPlan(
        pressed_by_factors(scene_of(scene).parts, "a data set", creeps=True), sweeps, seed, rtol
    )
    for text in filter(
        None, (noise_free(plan.parts.setup, plan.parts.meter), plan.one_skin("sweeps={}"))
    ):
        LOG.warning("%s: %s", plan.parts.skin.name, text)
    return with_view(in_memory(plan))


@checked
def reduce(scene: Scene | str | Path, rtol: float = 1e-4) -> Reduced:
    """Train a reduced model of all skins and presses of the scene; it answers in microseconds.

    scene: the scene, its name or its path. rtol: largest relative error of Rs and of Cp. Raises
    InputError for a scene that cannot be reduced, ToleranceError if rtol is not reached.
    """
    from ...simulator.models.reduced.greedy import reduce as reduced

    return reduced(scene_of(scene).parts, rtol)

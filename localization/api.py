"""Public functions that are no commands: features of sweeps, models and their files."""
# pyright: standard

from __future__ import annotations

import logging
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..simulator.requests.argument_types import path_of, refuse, sweeps_of, typed

if TYPE_CHECKING:
    import xarray as xr

    from ..simulator.requests.argument_types import Sweeps
    from ..simulator.scene.scene import Scene
    from .inputs.features import Features
    from .inputs.targets import Target
    from .model.localizer_model import Model

LOG = logging.getLogger(__name__)


def features(
    sweeps: Sweeps, target: Target = "column", quantities: str | Sequence[str] | None = None
) -> Features:
    """Compute features X, shape (sweep, feature), and targets y of sweeps.

    y has shape (sweep,), for positions (sweep, 3): x and y in mm, and the strength. The result
    unpacks into X and y; its `index`, shape (sweep,), numbers their sweeps among the given ones.
    Sweeps whose press has no such target, without a baseline that the features need or with a
    reading that is no finite number are left out; `left_out` says how many and why, and a warning
    is logged. sweeps: the sweeps or the path of their file. target:
    "column", "row", "pixel", "pair", "touches" or "position". quantities: names such as
    "dlnZ,dphase", as one text or a list; by default changes from the unpressed skin or, if most
    presses have no baseline sweep before them, Rs and Cp. Raises InputError for a target or a
    quantity that these sweeps do not have.
    """
    from .inputs.features import Features
    from .inputs.samples import samples_of

    samples = samples_of(sweeps_of(sweeps), target, quantities)
    found = Features.of(samples)
    if any(samples.left_out):
        LOG.warning("features of %s: %s", target, found.left_out)
    return found


def load_model(path: str | Path) -> Model:
    """Load a model from a file that `write`, `rcskin train` or `rcskin adapt` wrote.

    path: .npz. Raises InputError in one line if the file holds no model.
    """
    from .model.localizer_file import load

    return load(path_of(path))


@typed
def write(
    given: xr.Dataset | Model | Scene,
    path: str | Path,
    *,
    overwrite: bool = False,
    overwrite_measured: bool = False,
) -> None:
    """Write sweeps into .nc, .csv or .zarr, a model into .npz, or a scene into .toml.

    The file is written completely or not at all. given: sweeps, a model or a scene. path: file to
    write. overwrite: True replaces a file that exists. overwrite_measured: True replaces even
    measured sweeps. Raises InputError for another ending, an absent folder, or a file that exists
    and may not be replaced.
    """
    import xarray as xr

    from ..simulator.scene.scene import Scene
    from ..simulator.scene.scene_files import write_scene
    from ..simulator.sweeps import write as write_sweeps
    from ..simulator.sweeps.output_files import replacing
    from .model.localizer_file import save
    from .model.localizer_model import Model

    with replacing(overwrite, overwrite_measured):
        match given:
            case xr.Dataset():
                write_sweeps(given, path)
            case Scene():
                write_scene(path, given)
            case Model():
                save(path, given)
            case _:
                refuse("given", "sweeps (an xarray.Dataset), a Model or a Scene", given)

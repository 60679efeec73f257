"""Read and write sweeps, models and scenes; plot sweeps."""
# pyright: standard

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ...simulator.requests.argument_types import refuse
from .arguments import checked, path_of, sweeps_of

if TYPE_CHECKING:
    import xarray as xr

    from ...simulator.check.sweep_curves import Quantity
    from ...simulator.scene.scene import Scene
    from ..model.localizer_model import Model


def read(path: str | Path) -> xr.Dataset:
    """Read sweeps from a file, simulated or measured.

    path: .nc, .csv or .zarr. Raises InputError in one line if the file holds no sweeps.
    """
    return sweeps_of(path_of(path))


@checked
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
    from ...simulator.sweeps.output_files import replacing

    with replacing(overwrite, overwrite_measured):
        _written(given, path_of(path))


def _written(given: xr.Dataset | Model | Scene, path: str | Path) -> None:
    import xarray as xr

    from ...simulator.scene.scene import Scene
    from ...simulator.scene.scene_files import write_scene
    from ...simulator.sweeps import write as write_sweeps

    if isinstance(given, xr.Dataset):
        return write_sweeps(given, path)
    if isinstance(given, Scene):
        return write_scene(path, given)
    from ..model.localizer_file import save
    from ..model.localizer_model import Model

    if isinstance(given, Model):
        return save(path, given)
    refuse("given", "sweeps (an xarray.Dataset), a Model or a Scene", given)


@checked
def plot(
    sweeps: xr.Dataset | str | Path,
    path: str | Path,
    what: Sequence[Quantity] = (),
    *,
    overwrite: bool = False,
) -> Path:
    """Plot quantities of each press against frequency, as a picture or as a page to zoom.

    sweeps: the sweeps or the path of their file. path: .png, .svg, .pdf or .html; the function
    returns it. what: any of "Rs", "Cp", "change-Rs", "change-Cp" (from the unpressed skin), "phase"
    and "nyquist"; by default Rs and Cp and, if the unpressed skin was measured, their changes.
    overwrite: True replaces a file that exists. Raises InputError for another ending, an absent
    folder, or a file that exists and may not be replaced.
    """
    from ...simulator.check.curve_page import draw
    from ...simulator.sweeps.output_files import replacing

    with replacing(overwrite):
        return draw([sweeps_of(sweeps)], path_of(path), what)

"""Sweeps from files and into files, and their picture."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from .arguments import checked, path_of, sweeps_of

if TYPE_CHECKING:
    import xarray as xr

    from ..simulator.check.curves import Quantity


def read(path: str | Path) -> xr.Dataset:
    """Sweeps from a file, simulated or measured; raises InputError in one line."""
    return sweeps_of(path_of(path))


@checked
def write(
    sweeps: xr.Dataset,
    path: str | Path,
    *,
    overwrite: bool = False,
    overwrite_measured: bool = False,
) -> None:
    """Sweeps into a file, .nc, .csv or .zarr, whole or not at all.

    What a script wrote before is replaced with a note in the log. overwrite: replace also what was
    not made so. overwrite_measured: replace even measured sweeps. Raises InputError.
    """
    from ..simulator.sweeps import write as write_sweeps
    from ..simulator.sweeps.writing import Occasion, on_occasion

    now = Occasion(overwrite=overwrite, overwrite_measured=overwrite_measured)
    with on_occasion(now):
        write_sweeps(sweeps_of(sweeps), path_of(path))


@checked
def plot(sweeps: xr.Dataset | str | Path, path: str | Path, what: Sequence[Quantity] = ()) -> Path:
    """Quantities of each press against frequency, as a picture or as a page to zoom.

    sweeps: or the path of their file. path: .png, .svg, .pdf or .html; given back. what: of "Rs",
    "Cp", "change-Rs", "change-Cp" (from the skin at rest), "phase" and "nyquist"; by default Rs and
    Cp and, where the skin at rest was measured, their changes. Raises InputError for another ending
    or an absent folder.
    """
    from ..simulator.check.curves import draw_curves

    return draw_curves([sweeps_of(sweeps)], path_of(path), what)

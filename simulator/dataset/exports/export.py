"""Writes data sets and sweeps in the formats of other programs, in bounded memory."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from ...sweeps import (
    InputError,
    checked_data_folder,
    checked_output,
    open_zarr,
    read,
    require_packages,
    whole_file,
)
from ...sweeps.formats.netcdf import write_netcdf
from ...sweeps.schema import DIMENSIONS
from . import lerobot
from .exported_sweeps import Exported, variable_parts
from .lerobot import write_lerobot
from .mcap import write_mcap
from .tables import write_csv, write_parquet


@dataclass(frozen=True)
class ExportFormat:
    """A format of exports.

    ending: of the output, empty for a folder. write: writes sweeps to a path. extra, packages: what
    it needs. marker: file by which a folder of this format is known.
    """

    ending: str
    write: Callable[[Exported, Path], None]
    extra: str = "robots"
    packages: tuple[str, ...] = ()
    marker: str = ""


def _write_netcdf(exported: Exported, path: Path) -> None:
    """Writes NetCDF with all variables and attributes, part by part."""
    write_netcdf(exported.sweeps, path, partial(variable_parts, data=exported.data))


FORMATS = {
    "netcdf": ExportFormat(".nc", _write_netcdf),
    "csv": ExportFormat(".csv", write_csv),
    "parquet": ExportFormat(".parquet", write_parquet, "scale", ("pyarrow",)),
    "mcap": ExportFormat(".mcap", write_mcap, packages=("mcap_ros2",)),
    "lerobot": ExportFormat("", write_lerobot, packages=("pyarrow",), marker=lerobot.MARKER),
}
"""Formats by name."""


def export(data: Path, output: Path, name: str | None = None) -> Mapping[str, int]:
    """Writes a data set or sweeps in a format, whole or not at all.

    name: of the format; by default that of the output's ending. Returns the numbers of sweeps,
    interfaces and frequencies by dimension.

    Raises InputError if the data set is absent or damaged, if the format or the ending is not
    supported, and if a package is missing.
    """
    chosen = _format_of(output, name)
    if chosen.marker:
        output = checked_data_folder(output, chosen.marker)
    else:
        output = checked_output(output, (chosen.ending,))
    require_packages(output, chosen.extra, *chosen.packages)
    opened = open_zarr(data) if data.suffix == ".zarr" else read(data)
    with opened as sweeps:
        exported = Exported(data, sweeps)
        with whole_file(output, folder=not chosen.ending) as unfinished:
            chosen.write(exported, unfinished)
        return {dimension: sweeps.sizes[dimension] for dimension in DIMENSIONS}


def _format_of(output: Path, name: str | None) -> ExportFormat:
    """The format of a name, or of the output's ending. Raises InputError if there is none."""
    if name is None:
        by_ending = {each.ending: each for each in FORMATS.values() if each.ending}
        if output.suffix in by_ending:
            return by_ending[output.suffix]
        raise InputError(
            f"{output}: must end in {' or '.join(by_ending)}, got {output.suffix!r}; a folder "
            f"needs --format {_names(lambda each: not each.ending)}"
        )
    if name not in FORMATS:
        raise InputError(f"--format: must be {_names(lambda each: True)}, got {name!r}")
    return FORMATS[name]


def _names(wanted: Callable[[ExportFormat], bool]) -> str:
    return " or ".join(name for name, each in FORMATS.items() if wanted(each))

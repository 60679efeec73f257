"""The command `rcskin export`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def export(
    data: Annotated[Path, typer.Argument(help="A data set, DATA.zarr, or sweeps, .nc or .csv.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="OUT.nc, OUT.csv or OUT.parquet.")],
) -> None:
    """Write a data set or sweeps as NetCDF, CSV or Parquet.

    NetCDF keeps everything. CSV is the long form of sweeps, a line for each
    frequency. Parquet has one row a sweep: labels, touches, and columns
    Rs_INTERFACE_HERTZ, X_INTERFACE_HERTZ and Cp_INTERFACE_HERTZ.
    """
    _export_sweeps(data, output)


def _export_sweeps(data: Path, output: Path) -> None:
    from ...simulator.dataset.export import export as write_as
    from ...simulator.requests.console import report_written
    from ...simulator.sweeps import sizes_text

    report_written(sizes_text(write_as(data, output)), output)

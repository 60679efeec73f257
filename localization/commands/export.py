"""The command `rcskin export`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

FORMATS = "netcdf, csv, parquet, mcap, tactile-zarr, lerobot or hugging-face"


def export(
    data: Annotated[Path, typer.Argument(help="A data set, DATA.zarr, or sweeps, .nc or .csv.")],
    output: Annotated[
        Path,
        typer.Option(
            "--output", "-o", help="OUT.nc, OUT.csv, OUT.parquet, OUT.mcap, OUT.zarr, or a folder."
        ),
    ],
    format_: Annotated[
        str | None,
        typer.Option(
            "--format",
            help=f"{FORMATS}; default: by the ending of OUT.",
            autocompletion=lambda: FORMATS.replace(" or ", ", ").split(", "),
        ),
    ] = None,
    images: Annotated[
        list[Path] | None,
        typer.Option(
            help="Folder of a camera: CAMERA/episode-000000/*.png, an image for each sweep. May be "
            "repeated.",
        ),
    ] = None,
) -> None:
    """Write a data set or sweeps as NetCDF, CSV, Parquet, or for robot learning.

    NetCDF keeps everything. CSV is the long form of sweeps, a line for each
    frequency. Parquet has one row a sweep: labels, touches, and columns
    Rs_INTERFACE_HERTZ, X_INTERFACE_HERTZ and Cp_INTERFACE_HERTZ.

    mcap has messages of ROS 2. tactile-zarr (OUT.zarr) is the layout of
    Open-X-Tactile. lerobot is a folder in LeRobot's format v3.0, hugging-face
    a folder for `datasets`. Episodes are runs of sweeps of one session.
    """
    _export_sweeps(data, output, format_, images or [])


def _export_sweeps(data: Path, output: Path, name: str | None, images: list[Path]) -> None:
    from ...simulator.dataset.exports.export import export as write_as
    from ...simulator.requests.console import report_written
    from ...simulator.sweeps import sizes_text

    report_written(sizes_text(write_as(data, output, name, images)), output)

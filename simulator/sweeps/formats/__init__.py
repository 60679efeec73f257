"""Formats of files of sweeps: one reader and one writer each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .csv import csv_marks, read_csv, write_csv
from .netcdf import netcdf_marks, read_netcdf, write_netcdf
from .zarr import read_zarr, write_zarr, zarr_marks

if TYPE_CHECKING:
    import xarray as xr

    from ..schema import SweepTable


@dataclass(frozen=True)
class Format:
    """A format of files of sweeps.

    marks: names of variables and attributes, which show whether a file holds measured sweeps; empty
    for files of other kinds. It raises any exception for a damaged file.
    """

    read: Callable[[Path], xr.Dataset]
    write: Callable[[xr.Dataset | SweepTable, Path], None]
    marks: Callable[[Path], tuple[set[str], dict[str, Any]]]


FORMATS = {
    ".nc": Format(read_netcdf, write_netcdf, netcdf_marks),
    ".csv": Format(read_csv, write_csv, csv_marks),
    ".zarr": Format(read_zarr, write_zarr, zarr_marks),
}
"""Formats by ending."""
ENDINGS = tuple(FORMATS)

"""Exports data sets to other formats block by block, in bounded memory."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from ..sweeps import InputError, checked_output, open_zarr, read, require_packages, whole_file
from ..sweeps.digests import seal_binary, seal_text
from ..sweeps.formats import netcdf
from ..sweeps.formats.csv import append_csv
from ..sweeps.reading_quantities import kind_of
from ..sweeps.schema import DIMENSIONS, TAKEN, taken_of

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

VALUES_AT_ONCE = 2**20
Part = TypeVar("Part", "xr.Dataset", "xr.Variable")


def export(data: Path, output: Path) -> Mapping[str, int]:
    """Writes a data set or sweeps as `.nc`, `.csv` or `.parquet`, whole or not at all.

    Returns the numbers of sweeps, interfaces and frequencies by dimension.

    Raises InputError if the data set is absent or damaged, or if the ending is not supported.
    """
    writers = {".nc": _write_netcdf, ".csv": _write_csv, ".parquet": _write_parquet}
    output = checked_output(output, tuple(writers))
    if not data.exists():
        raise InputError(f"{data}: no such file")
    if output.suffix == ".parquet":
        require_packages(output, "scale", "pyarrow")
    opened = open_zarr(data) if data.suffix == ".zarr" else read(data)
    with opened as sweeps, whole_file(output) as unfinished:
        writers[output.suffix](sweeps, unfinished, data)
        return {name: sweeps.sizes[name] for name in DIMENSIONS}


def wide_table(sweeps: xr.Dataset) -> pd.DataFrame:
    """Table with one row per sweep: labels of the press, then all quantities of all readings."""
    import pandas as pd

    known = [name for name in sweeps.variables if sweeps[name].dims in (("sweep",), LONG)]
    columns, taken = {}, taken_of(sweeps)
    for name in sorted(map(str, known)):
        columns |= _columns(name, sweeps[name].values)
    for name in kind_of(sweeps).names:
        columns |= _spectrum(name, sweeps[name].transpose(*DIMENSIONS), taken)
    return pd.DataFrame(columns)


LONG = ("sweep", "touch")


def _columns(name: str, values: np.ndarray) -> dict[str, np.ndarray]:
    if values.ndim == 1:
        return {name: values}
    return {f"{name}_{touch + 1}": each for touch, each in enumerate(values.T)}


def _spectrum(name: str, quantity: xr.DataArray, taken: np.ndarray | None) -> dict[str, np.ndarray]:
    values = quantity.values
    return {
        f"{name}_{interface}_{frequency:.10g}": values[:, i, f]
        for i, interface in enumerate(quantity["interface"].values)
        for f, frequency in enumerate(quantity["frequency"].values)
        if taken is None or taken[i, f]
    }


def _in_memory(part: Part, data: Path) -> Part:
    """Loads a part of a data set. Raises InputError naming the data set if it is corrupt."""
    try:
        return part.load()
    except netcdf.DAMAGED as error:
        reason = " ".join(str(error).split())
        raise InputError(f"{data}: damaged, cannot be read: {reason}; use another copy") from error


def _parts(sweeps: xr.Dataset, data: Path) -> Iterator[tuple[int, xr.Dataset]]:
    """Yields the number of the first sweep of each part, and the part in memory."""
    chunk = (
        sweeps[kind_of(sweeps).names[0]]
        .encoding.get("preferred_chunks", {})
        .get("sweep", VALUES_AT_ONCE)
    )
    for first in range(0, sweeps.sizes["sweep"], chunk):
        yield first, _in_memory(sweeps.isel(sweep=slice(first, first + chunk)), data)


def _write_csv(sweeps: xr.Dataset, path: Path, data: Path) -> None:
    written = (*kind_of(sweeps).names, TAKEN)
    kept = sweeps.drop_vars([name for name in sweeps.data_vars if name not in written])
    for first, part in _parts(kept, data):
        append_csv(part, path, first)
    seal_text(path)


def _write_parquet(sweeps: xr.Dataset, path: Path, data: Path) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    kept = sweeps.drop_dims("drawn_session", errors="ignore")
    attributes = {key: str(value) for key, value in sweeps.attrs.items()}
    writer = None
    try:
        for _, part in _parts(kept, data):
            table = pa.Table.from_pandas(wide_table(part), preserve_index=False)
            table = table.replace_schema_metadata({**(table.schema.metadata or {}), **attributes})
            writer = writer or pq.ParquetWriter(path, table.schema, compression="zstd")
            writer.write_table(table)
    finally:
        if writer is not None:
            writer.close()


def _write_netcdf(sweeps: xr.Dataset, path: Path, data: Path) -> None:
    """Writes NetCDF variable by variable and chunk by chunk."""
    import netCDF4

    with netcdf.LOCK, netCDF4.Dataset(path, "w", format="NETCDF4") as file:
        file.setncatts(_plain(sweeps.attrs))
        for name, size in sweeps.sizes.items():
            file.createDimension(str(name), size)
        for name, variable in sweeps.variables.items():
            _copy(file, str(name), variable, _labels(sweeps, str(name)), data)
    seal_binary(path)


def _copy(file: Any, name: str, variable: xr.Variable, labels: str, data: Path) -> None:
    text = variable.dtype.kind in "OUT"
    target = netcdf.create_variable(file, name, variable.dtype, variable.dims)
    target.setncatts(_plain(variable.attrs) | ({"coordinates": labels} if labels else {}))
    rows = max(1, VALUES_AT_ONCE * variable.shape[0] // max(1, variable.size))
    for first in range(0, variable.shape[0], rows):
        part = _in_memory(variable[first : first + rows], data).values
        target[first : first + rows] = part.astype(object) if text else part


def _labels(sweeps: xr.Dataset, name: str) -> str:
    """Names of a variable's coordinates that are not dimensions."""
    if name in sweeps.coords or "sweep" not in sweeps[name].dims:
        return ""
    return " ".join(sorted(str(c) for c in sweeps[name].coords if c not in sweeps.dims))


def _plain(attributes: Mapping[Any, Any]) -> dict[str, Any]:
    return {str(name): value for name, value in attributes.items()}

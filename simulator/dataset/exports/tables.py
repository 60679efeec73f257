"""Sweeps as tables: CSV in long form, and Parquet with one row for each sweep."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ...sweeps.formats.csv import write_csv_parts
from ...sweeps.reading_quantities import kind_of
from ...sweeps.schema import CONTACT, DIMENSIONS, TAKEN, taken_of
from .exported_sweeps import Exported
from .sweep_parts import parts

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr


def write_csv(exported: Exported, path: Path) -> None:
    """Writes CSV, one line for each reading."""
    sweeps = exported.sweeps
    written = (*kind_of(sweeps).names, TAKEN)
    kept = sweeps.drop_vars([name for name in sweeps.data_vars if name not in written])
    write_csv_parts((part for _, part in parts(kept, exported.data)), path)


def write_parquet(exported: Exported, path: Path) -> None:
    """Writes Parquet, one row for each sweep."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    sweeps = exported.sweeps
    kept = sweeps.drop_dims("drawn_session", errors="ignore")
    attributes = {key: str(value) for key, value in sweeps.attrs.items()}
    writer = None
    try:
        for _, part in parts(kept, exported.data):
            table = pa.Table.from_pandas(wide_table(part), preserve_index=False)
            table = table.replace_schema_metadata({**(table.schema.metadata or {}), **attributes})
            writer = writer or pq.ParquetWriter(path, table.schema, compression="zstd")
            writer.write_table(table)
    finally:
        if writer is not None:
            writer.close()


def wide_table(sweeps: xr.Dataset) -> pd.DataFrame:
    """Table with one row per sweep: labels of the press, then all quantities of all readings."""
    import pandas as pd

    several = ("sweep",), ("sweep", "touch"), ("sweep", CONTACT)
    known = [name for name in sweeps.variables if sweeps[name].dims in several]
    columns, taken = {}, taken_of(sweeps)
    for name in sorted(map(str, known)):
        columns |= _columns(name, sweeps[name].values)
    for name in kind_of(sweeps).names:
        columns |= _spectrum(name, sweeps[name].transpose(*DIMENSIONS), taken)
    return pd.DataFrame(columns)


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

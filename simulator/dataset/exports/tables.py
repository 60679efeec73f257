"""Sweeps as tables: CSV in long form, and Parquet with one row for each sweep.

The columns of Parquet files are arrays of known shape, cut into files of limited size; the schema
describes them as the library `datasets` of Hugging Face does.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ...sweeps.formats.csv import write_csv_parts
from ...sweeps.reading_quantities import kind_of
from ...sweeps.schema import CONTACT, DIMENSIONS, TAKEN, taken_of
from .exported_sweeps import Exported, parts

if TYPE_CHECKING:
    import pandas as pd
    import pyarrow as pa
    import xarray as xr

MAX_BYTES = 100 * 2**20
"""Uncompressed size at which a file ends."""


@dataclass(frozen=True)
class ParquetColumn:
    """A column. dtype: `float32` ... or `string`. shape: of a cell, () for one value,
    (size,) for a vector."""

    name: str
    dtype: str
    shape: tuple[()] | tuple[int] = ()

    @property
    def feature(self) -> dict[str, Any]:
        """Description as a feature of `datasets`."""
        value = {"dtype": self.dtype, "_type": "Value"}
        if not self.shape:
            return value
        return {"feature": value, "length": self.shape[0], "_type": "Sequence"}

    @property
    def type(self) -> pa.DataType:
        """Type in Arrow."""
        import pyarrow as pa

        found = pa.type_for_alias(self.dtype)
        return pa.list_(found, self.shape[0]) if self.shape else found

    def array(self, values: Any) -> pa.Array:
        """The cells of the column. values: shape (row, *shape), or a list of texts."""
        import pyarrow as pa

        if self.dtype == "string" or not self.shape:
            return pa.array(values, self.type)
        flat = pa.array(np.ravel(values), pa.type_for_alias(self.dtype))
        return pa.FixedSizeListArray.from_arrays(flat, self.shape[0])


def schema_of(columns: Sequence[ParquetColumn]) -> pa.Schema:
    """Schema of columns with their features."""
    import pyarrow as pa

    features = {column.name: column.feature for column in columns}
    info = json.dumps({"info": {"features": features}}, ensure_ascii=False)
    return pa.schema([(each.name, each.type) for each in columns], {"huggingface": info})


class ParquetFiles:
    """Writes rows into numbered Parquet files.

    path: of the file of a number. A file ends at MAX_BYTES, but only where `divide` is called.
    """

    def __init__(self, columns: Sequence[ParquetColumn], path: Callable[[int], Path]) -> None:
        self.columns, self.number = columns, 0
        self._path, self._schema, self._writer, self._size = path, schema_of(columns), None, 0

    def divide(self) -> None:
        """Begin another file here if this one has its size."""
        if self._size >= MAX_BYTES:
            self.close()
            self.number, self._size = self.number + 1, 0

    def write(self, values: Mapping[str, Any]) -> None:
        """Append rows. values: by name of the column, see `ParquetColumn.array`."""
        import pyarrow as pa
        import pyarrow.parquet as pq

        arrays = [column.array(values[column.name]) for column in self.columns]
        table = pa.Table.from_arrays(arrays, schema=self._schema)
        if self._writer is None:
            path = self._path(self.number)
            path.parent.mkdir(parents=True, exist_ok=True)
            self._writer = pq.ParquetWriter(path, self._schema, compression="zstd")
        self._writer.write_table(table)
        self._size += table.nbytes

    def close(self) -> None:
        """End the present file."""
        if self._writer is not None:
            self._writer.close()
            self._writer = None


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

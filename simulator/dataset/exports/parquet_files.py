"""Parquet files whose columns are arrays of known shape, cut into files of limited size.

The schema describes the columns as the library `datasets` of Hugging Face does.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import pyarrow as pa

IMAGE = "image"
MAX_BYTES = 100 * 2**20
"""Uncompressed size at which a file ends."""


@dataclass(frozen=True)
class ParquetColumn:
    """A column. dtype: `float32` ..., `string` or IMAGE. shape: of a cell, () for one value."""

    name: str
    dtype: str
    shape: tuple[int, ...] = ()

    @property
    def feature(self) -> dict[str, Any]:
        """Description as a feature of `datasets`."""
        if self.dtype == IMAGE:
            return {"_type": "Image"}
        value = {"dtype": self.dtype, "_type": "Value"}
        if not self.shape:
            return value
        if len(self.shape) == 1:
            return {"feature": value, "length": self.shape[0], "_type": "Sequence"}
        shape = list(self.shape)
        return {"shape": shape, "dtype": self.dtype, "_type": f"Array{len(shape)}D"}

    @property
    def type(self) -> pa.DataType:
        """Type in Arrow."""
        import pyarrow as pa

        if self.dtype == IMAGE:
            return pa.struct({"bytes": pa.binary(), "path": pa.string()})
        found = pa.type_for_alias(self.dtype)
        if len(self.shape) == 1:
            return pa.list_(found, self.shape[0])
        for _ in self.shape:
            found = pa.list_(found)
        return found

    @property
    def field(self) -> pa.Field:
        """Field in Arrow; arrays of several dimensions have the extension type of `datasets`."""
        import pyarrow as pa

        dimensions = len(self.shape)
        extension = {
            "ARROW:extension:name": f"datasets.features.features.Array{dimensions}DExtensionType",
            "ARROW:extension:metadata": json.dumps([list(self.shape), self.dtype]),
        }
        return pa.field(self.name, self.type, metadata=extension if dimensions > 1 else None)

    def array(self, values: Any) -> pa.Array:
        """The cells of the column. values: shape (row, *shape), or a list of texts or images."""
        import pyarrow as pa

        if self.dtype in (IMAGE, "string") or not self.shape:
            return pa.array(values, self.type)
        values = np.ascontiguousarray(values)
        if len(self.shape) == 1:
            flat = pa.array(values.ravel(), pa.type_for_alias(self.dtype))
            return pa.FixedSizeListArray.from_arrays(flat, self.shape[0])
        found: pa.Array = pa.array(values.ravel(), pa.type_for_alias(self.dtype))
        for size in reversed(self.shape):
            ends = np.arange(0, len(found) + 1, size, dtype=np.int32)
            found = pa.ListArray.from_arrays(pa.array(ends), found)
        return found


def schema_of(columns: Sequence[ParquetColumn], more: Mapping[str, Any] | None = None) -> pa.Schema:
    """Schema of columns with their features. more: JSON objects by name, stored beside."""
    import pyarrow as pa

    features = {column.name: column.feature for column in columns}
    described = {"huggingface": {"info": {"features": features}}, **(more or {})}
    metadata = {name: json.dumps(value, ensure_ascii=False) for name, value in described.items()}
    return pa.schema([column.field for column in columns], metadata)


class ParquetFiles:
    """Writes rows into numbered Parquet files.

    path: of the file of a number. A file ends at MAX_BYTES, but only where `divide` is called.
    """

    def __init__(
        self, columns: Sequence[ParquetColumn], path: Callable[[int], Path], more: Mapping[str, Any]
    ) -> None:
        self.columns, self.number = columns, 0
        self._path, self._schema, self._writer, self._size = path, schema_of(columns, more), None, 0

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

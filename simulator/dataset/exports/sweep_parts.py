"""Parts of sweeps that are read from a file one after the other, in bounded memory."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from ...sweeps import inputs
from ...sweeps.reading_quantities import kind_of

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

VALUES_AT_ONCE = 2**20
"""Largest number of values of a variable that are in memory at once."""
Part = TypeVar("Part", "xr.Dataset", "xr.Variable")


def in_memory(part: Part, data: Path) -> Part:
    """Loads a part of a data set. Raises InputError naming the data set if it is corrupt."""
    with inputs.named_damage(data, "damaged, cannot be read", inputs.ANOTHER_COPY):
        return part.load()


def variable_parts(variable: xr.Variable, data: Path) -> Iterator[tuple[slice, NDArray[Any]]]:
    """Yields the place and the values of each part of a variable along its first dimension."""
    rows = max(1, VALUES_AT_ONCE * variable.shape[0] // max(1, variable.size))
    for first in range(0, variable.shape[0], rows):
        place = slice(first, first + rows)
        yield place, in_memory(variable[place], data).values


def parts(sweeps: xr.Dataset, data: Path) -> Iterator[tuple[int, xr.Dataset]]:
    """Yields the number of the first sweep of each part, and the part in memory."""
    readings = sweeps[kind_of(sweeps).names[0]]
    at_once = max(1, VALUES_AT_ONCE * sweeps.sizes["sweep"] // max(1, readings.size))
    chunk = readings.encoding.get("preferred_chunks", {}).get("sweep", at_once)
    for first in range(0, sweeps.sizes["sweep"], chunk):
        yield first, in_memory(sweeps.isel(sweep=slice(first, first + chunk)), data)

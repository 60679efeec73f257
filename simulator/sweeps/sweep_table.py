"""Sweeps as plain arrays without xarray, for commands that only write them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

DIMENSIONS = ("sweep", "interface", "frequency")


@dataclass(frozen=True)
class SweepVariable:
    """An array with the names of its dimensions and its attributes (`long_name`, `units`)."""

    dims: tuple[str, ...]
    values: NDArray[Any]
    attrs: Mapping[str, str]


@dataclass(frozen=True)
class SweepTable:
    """Quantities, coordinates and attributes, in the layout of an `xarray.Dataset`."""

    quantities: Mapping[str, SweepVariable]
    coordinates: Mapping[str, SweepVariable]
    attrs: Mapping[str, Any]

    @property
    def variables(self) -> dict[str, SweepVariable]:
        """All arrays by name: quantities first, then coordinates."""
        return {**self.quantities, **self.coordinates}

    @property
    def sizes(self) -> dict[str, int]:
        """Lengths of the dimensions by name."""
        shape = next(iter(self.quantities.values())).values.shape
        return dict(zip(DIMENSIONS, shape, strict=True))

    def dataset(self) -> xr.Dataset:
        """The sweeps as an `xarray.Dataset`."""
        import xarray as xr

        quantities, coordinates = (
            {name: (each.dims, each.values, dict(each.attrs)) for name, each in group.items()}
            for group in (self.quantities, self.coordinates)
        )
        return xr.Dataset(quantities, coordinates, attrs=dict(self.attrs))


def table_of(sweeps: xr.Dataset, names: Sequence[str]) -> SweepTable:
    """The named variables of sweeps that exist; quantities have the order of DIMENSIONS."""
    there = [name for name in names if name in sweeps.variables]
    taken = {name: sweeps[name] for name in there}
    ordered = {
        name: each.transpose(*DIMENSIONS) if each.ndim == len(DIMENSIONS) else each
        for name, each in taken.items()
    }
    plain = {
        name: SweepVariable(tuple(map(str, each.dims)), np.asarray(each.values), each.attrs)
        for name, each in ordered.items()
    }
    quantities = {name: each for name, each in plain.items() if len(each.dims) == len(DIMENSIONS)}
    rest = {name: each for name, each in plain.items() if name not in quantities}
    return SweepTable(quantities, rest, sweeps.attrs)

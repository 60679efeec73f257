"""Sweeps written as NetCDF without xarray, whose import takes longer than to simulate them.

The file is what `xarray.Dataset.to_netcdf` makes of the same sweeps.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..table import DIMENSIONS, Table


def write_table(sweeps: Table, path: Path) -> None:
    """Write sweeps as NetCDF 4; texts as strings, numbers to the same bits."""
    from netCDF4 import Dataset

    indices = {name for name in sweeps.coordinates if name in DIMENSIONS}
    named = " ".join(sorted(set(sweeps.coordinates) - indices))
    with Dataset(path, "w", format="NETCDF4") as file:
        file.setncatts({name: _attribute(value) for name, value in sweeps.attrs.items()})
        for name, size in sweeps.sizes.items():
            file.createDimension(name, size)
        for name, each in sweeps.variables.items():
            text = each.values.dtype == object
            fill = np.nan if each.values.dtype.kind == "f" else None
            variable = file.createVariable(
                name, str if text else each.values.dtype, each.dims, fill_value=fill
            )
            told = {**each.attrs, **({"coordinates": named} if name in sweeps.quantities else {})}
            variable.setncatts(told)
            variable[:] = each.values


def _attribute(value: object) -> object:
    return np.asarray(value) if isinstance(value, int | float) else value

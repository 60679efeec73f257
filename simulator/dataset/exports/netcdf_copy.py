"""Sweeps as NetCDF, variable by variable and chunk by chunk."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...sweeps.digests import seal_binary
from ...sweeps.formats import netcdf
from .exported_sweeps import Exported
from .sweep_parts import VALUES_AT_ONCE, in_memory

if TYPE_CHECKING:
    import xarray as xr


def write_netcdf(exported: Exported, path: Path) -> None:
    """Writes NetCDF with all variables and attributes."""
    import netCDF4

    sweeps, data = exported.sweeps, exported.data
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
        part = in_memory(variable[first : first + rows], data).values
        target[first : first + rows] = part.astype(object) if text else part


def _labels(sweeps: xr.Dataset, name: str) -> str:
    """Names of a variable's coordinates that are not dimensions."""
    if name in sweeps.coords or "sweep" not in sweeps[name].dims:
        return ""
    return " ".join(sorted(str(c) for c in sweeps[name].coords if c not in sweeps.dims))


def _plain(attributes: Mapping[Any, Any]) -> dict[str, Any]:
    return {str(name): value for name, value in attributes.items()}

"""Label of the sweeps that simulation is compared with: measurement, twin or simulation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ...simulator.sweeps import InputError
from ...simulator.sweeps.same_skin import check_same_skin
from ...simulator.sweeps.schema import MEASURED, VIRTUAL

if TYPE_CHECKING:
    import xarray as xr

VIRTUAL_SERIAL = "000000000"
"""Serial number of the virtual meter; older recordings are recognized only by it."""


@dataclass(frozen=True)
class SideLabel:
    """Names of the other side in the report: `the measurement`, `measured sweeps`."""

    name: str
    adjective: str


MEASUREMENT = SideLabel("measurement", "measured")
TWIN = SideLabel("twin", "twin")
SECOND = SideLabel("second simulation", "second simulated")


def label_of_side(sweeps: xr.Dataset) -> SideLabel:
    """The label, from the attributes: `twin`, the virtual meter, or a simulation's tolerance."""
    attributes = sweeps.attrs
    virtual = VIRTUAL_SERIAL in str(attributes.get("meter", "")).split(",")
    if "twin" in attributes or virtual or attributes.get("model") == VIRTUAL:
        return TWIN
    simulated = "rtol" in attributes and attributes.get("model") != MEASURED
    return SECOND if simulated else MEASUREMENT


def check_simulated(sweeps: xr.Dataset, path: object) -> None:
    """Raises InputError if sweeps given as simulated are marked as measured."""
    if sweeps.attrs.get("model") in (MEASURED, VIRTUAL) or "twin" in sweeps.attrs:
        called = label_of_side(sweeps).adjective
        raise InputError(f"{path}: contains {called} sweeps; name the simulated sweeps first")


def check_other(sweeps: xr.Dataset, scene: str, path: object) -> None:
    """Raises InputError if the other side's sweeps are of another skin than the scene's.

    scene: TOML text, empty if unknown.
    """
    check_same_skin(str(sweeps.attrs.get("scene", "")), scene, str(path))

"""Sweeps: simulated and measured impedance spectra in one schema, and the files that hold them."""

from simulator.sweeps.errors import InputError, ToleranceError
from simulator.sweeps.files import checked_output, open_zarr, read, whole_file, write
from simulator.sweeps.impedance import (
    branch_reactance,
    parallel_capacitance,
    series_capacitance,
)
from simulator.sweeps.passivity import Violation, violations
from simulator.sweeps.schema import UNPRESSED, build, check, concatenate, impedance, side_by_side

__all__ = [
    "UNPRESSED",
    "InputError",
    "ToleranceError",
    "Violation",
    "branch_reactance",
    "build",
    "check",
    "checked_output",
    "concatenate",
    "impedance",
    "open_zarr",
    "parallel_capacitance",
    "read",
    "series_capacitance",
    "side_by_side",
    "violations",
    "whole_file",
    "write",
]

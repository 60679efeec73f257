"""Sweeps: simulated and measured impedance spectra in one schema, and the files that hold them."""

from .errors import InputError, OutputError, ToleranceError
from .formats.zarr import loaded, open_zarr
from .input_files import read, sizes_text
from .joining import concatenate, read_joined, side_by_side
from .optional_packages import require_packages
from .output_files import (
    checked_data_folder,
    checked_folder,
    checked_output,
    made_folder,
    whole_file,
    write,
)
from .passivity import violations
from .reading_quantities import parallel_capacitance
from .schema import (
    OPENING,
    UNPRESSED,
    SweepTable,
    build,
    check,
    impedance,
)
from .writing import kept_file

__all__ = [
    "OPENING",
    "UNPRESSED",
    "InputError",
    "OutputError",
    "SweepTable",
    "ToleranceError",
    "build",
    "check",
    "require_packages",
    "checked_data_folder",
    "checked_folder",
    "checked_output",
    "concatenate",
    "sizes_text",
    "impedance",
    "kept_file",
    "loaded",
    "made_folder",
    "open_zarr",
    "parallel_capacitance",
    "read",
    "read_joined",
    "side_by_side",
    "violations",
    "whole_file",
    "write",
]

"""Recognizes files of measured sweeps, which cannot be made again."""

from __future__ import annotations

from pathlib import Path

from ..input_files import ENDINGS, open_zarr, read, sizes_text
from ..schema import MEASURED, VIRTUAL


def measured_description(path: Path, known: bool) -> str | None:
    """Describes a file of measured sweeps in words; None for any other file.

    Sweeps count as measured if a meter recorded them, or if they state no tolerance of a
    simulation, unless the current command is known to have made them.
    """
    if path.suffix not in ENDINGS:
        return None
    try:
        sweeps = open_zarr(path) if path.suffix == ".zarr" else read(path)
    except Exception:  # of whatever library: then these are no sweeps
        return None
    attributes = sweeps.attrs
    recorded = attributes.get("model") in (MEASURED, VIRTUAL)
    if not recorded and (known or "rtol" in attributes):
        return None
    begun = attributes.get("begun")
    return f"{sizes_text(sweeps.sizes)} that were measured" + (f", begun {begun}" if begun else "")

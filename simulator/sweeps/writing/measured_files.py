"""Whether a file holds sweeps that were measured: these cannot be had again."""

from __future__ import annotations

from pathlib import Path

from ..input_files import ENDINGS, open_zarr, read, sizes_text
from ..schema import MEASURED, VIRTUAL


def measured(path: Path, known: bool) -> str | None:
    """What a file of measured sweeps holds, for people; None for anything else.

    A meter's count, and those that do not say with which tolerance they were simulated, unless it
    is known that the command at hand made them of something else.
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

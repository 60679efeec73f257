"""Fingerprints of sweeps: a model stores those of its training sweeps."""

from __future__ import annotations

from hashlib import blake2b
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...simulator.sweeps.reading_quantities import kind_of
from .features import in_blocks

if TYPE_CHECKING:
    import xarray as xr

FINGERPRINT_BYTES = 8


def fingerprints_of(sweeps: xr.Dataset) -> NDArray[np.uint64]:
    """A 64-bit number for the readings of each sweep, shape (sweep,).

    Readings are rounded to single precision, which text files keep too.
    """
    parts = in_blocks(np.arange(sweeps.sizes["sweep"]))
    return np.concatenate([_fingerprints(sweeps.isel(sweep=part)) for part in parts])


def _fingerprints(sweeps: xr.Dataset) -> NDArray[np.uint64]:
    names = kind_of(sweeps.variables).sufficient
    readings = np.stack([sweeps[name].values for name in names], axis=1)
    rows = np.ascontiguousarray(readings.reshape(len(readings), -1), dtype=np.float32)
    digests = b"".join(
        blake2b(row.tobytes(), digest_size=FINGERPRINT_BYTES).digest() for row in rows
    )
    return np.frombuffer(digests, dtype=np.uint64)

"""Noise over frequency as the scene of sweeps states it, to estimate their noise in proportion."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..sweeps.reading_subset import read_at
from ..sweeps.schema import complex_readings

if TYPE_CHECKING:
    import xarray as xr

    from ..arrays import Real
    from ..scene.parts import Meter


def noise_profiles(meter: Meter | None, sweeps: xr.Dataset) -> dict[str, Real]:
    """Relative noise at the frequencies of each interface, by its name: rms over all sweeps.

    Empty without a meter, and for a readout whose noise is 0 or the same at all frequencies.
    """
    if meter is None or meter.readout.uniform or not meter.readout.noisy:
        return {}
    names = map(str, sweeps["interface"].values)
    return {name: _profile(meter, read_at(sweeps, name)) for name in names}


def _profile(meter: Meter, sweeps: xr.Dataset) -> Real:
    """Profile at the only interface of the sweeps, shape (frequency,)."""
    reading, frequency = complex_readings(sweeps), sweeps["frequency"].values
    noise = meter.readout.noise(reading, frequency)
    return np.sqrt(np.mean(np.square(noise), axis=(0, 1, 2)))

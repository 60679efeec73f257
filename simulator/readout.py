"""What a meter would show: |Z| and phase with their errors, and values of so many digits.

A meter measures |Z| and phase; everything else it calculates. Each has a part that stays fixed for
a session (a mounting, a day, a calibration) and a part that is new with every reading.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from simulator.scene import Readout
from simulator.sweeps import build, impedance, parallel_capacitance

if TYPE_CHECKING:
    import xarray as xr


class Meter:
    """A meter in one session: its fixed errors are drawn once, at each interface.

    gain: factor on |Z|, turn: added to the phase [rad], both of shape (interface, 1).
    """

    def __init__(self, readout: Readout, interfaces: int, random: np.random.Generator) -> None:
        self._readout, self._random = readout, random
        magnitude, phase = random.standard_normal((2, interfaces, 1))
        self.gain = 1 + readout.magnitude_accuracy * magnitude
        self.turn = readout.phase_accuracy * phase

    def measure(self, Z: NDArray[np.complex128]) -> NDArray[np.complex128]:
        """Z in ohm as measured, one reading for each; shape (sweep, interface, frequency)."""
        magnitude, phase = self._random.standard_normal((2, *Z.shape))
        gain = self.gain * (1 + self._readout.magnitude_noise * magnitude)
        return Z * gain * np.exp(1j * (self.turn + self._readout.phase_noise * phase))


def displayed(value: NDArray[np.float64], digits: int) -> NDArray[np.float64]:
    """Values rounded to that many significant digits, as a meter displays them."""
    exponent = np.floor(np.log10(np.abs(value), out=np.zeros(value.shape), where=value != 0))
    step = 10.0 ** (exponent + 1 - digits)
    return np.round(value / step) * step


def read_out(
    sweeps: xr.Dataset, readout: Readout, random: np.random.Generator, session: int = 0
) -> xr.Dataset:
    """The sweeps as a meter would show them in one session; numerical errors no longer apply."""
    frequency = sweeps["frequency"].values
    Z = Meter(readout, sweeps.sizes["interface"], random).measure(impedance(sweeps))
    Rs, X, Cp = (
        displayed(value, readout.display_digits)
        for value in (Z.real, Z.imag, parallel_capacitance(Z, frequency))
    )
    return build(
        Rs + 1j * X,
        frequency,
        interface=list(sweeps["interface"].values),
        press=list(sweeps["press"].values),
        row=list(sweeps["row"].values),
        column=list(sweeps["column"].values),
        session=[session] * sweeps.sizes["sweep"],
        Cp=Cp,
        attributes={**sweeps.attrs, "readout": readout.model_dump_json()},
    )

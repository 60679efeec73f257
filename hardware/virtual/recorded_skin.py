"""A recorded skin: its sweeps are played back instead of a simulation."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

from ...simulator.sweeps import InputError, impedance
from ...simulator.sweeps.reading_subset import read_at

if TYPE_CHECKING:
    import xarray as xr

    from ...simulator.meters.accuracy_table import ReadingConditions


class RecordedSkin:
    """Plays the sweeps of one interface; each check of a press takes its next repetition."""

    def __init__(self, sweeps: xr.Dataset, interface: str | None = None) -> None:
        """interface: default the first. Raises InputError if the sweeps lack it."""
        names = [str(name) for name in sweeps["interface"].values]
        if interface is not None and interface not in names:
            raise InputError(f"`interface` must be one of {', '.join(names)}, got {interface!r}")
        own = read_at(sweeps, interface or names[0])
        self._Z = impedance(own)[:, 0]
        self._frequency = own["frequency"].values
        self._presses = [str(press) for press in sweeps["press"].values]
        self._pixels = [
            f"{row},{column}"
            for row, column in zip(sweeps["row"].values, sweeps["column"].values, strict=True)
        ]
        self._played: Counter[str] = Counter()

    def check(self, press: str) -> str:
        """The recorded press with its next repetition, as `PRESS #N`.

        press: as recorded, ROW,COLUMN, or `none`. Raises InputError if it was not recorded.
        """
        text = "".join(press.split())
        found = [
            number
            for number, names in enumerate(zip(self._presses, self._pixels, strict=True))
            if text in names
        ]
        if not found:
            raise InputError(
                f"press {press!r} was not recorded; recorded are "
                f"{', '.join(dict.fromkeys(self._presses))}"
            )
        number = found[self._played[text] % len(found)]
        self._played[text] += 1
        return f"{self._presses[number]} #{number}"

    def hold(self, press: str, now: float) -> str:
        """Same as `check`: the recording contains the foam's creep."""
        return self.check(press)

    def momentary(self, press: str, at: float) -> str:
        """The press: it does not depend on time."""
        return press

    def impedance(self, press: str, frequency: float) -> complex:
        """Z in ohm; |Z| and phase are interpolated over the logarithm of the frequency.

        press: as `check` gave it. frequency: Hz. Raises InputError outside the recorded ones.
        """
        low, high = self._frequency[[0, -1]] * (1 - 1e-4, 1 + 1e-4)
        if not low <= frequency <= high:
            raise InputError(f"frequency must be in {low:g}..{high:g} Hz, got {frequency:g}")
        known = np.log(self._Z[int(press.rpartition("#")[2])])
        along, at = np.log(self._frequency), np.log(frequency)
        size, phase = np.interp(at, along, known.real), np.interp(at, along, known.imag)
        return complex(np.exp(size + 1j * phase))

    def depths(self, press: str) -> str:
        """Empty: the press states the recorded forces."""
        return ""


def exact_readout(Z: complex, conditions: ReadingConditions) -> complex:
    """Readout without further errors: the recording contains the meter's."""
    return Z

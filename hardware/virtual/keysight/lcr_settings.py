"""Settings of the LCR meters E4980A, E4980AL and 4284A, with limits of each model."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from ....simulator.meters.accuracy_table import OUTPUT_RESISTANCE, AccuracyTable, ReadingConditions
from ..measurement import NORMAL, OVERFLOW, quantity
from .keysight_corrections import CorrectionSpot

RANGES = (0.1, 1.0, 10.0, 100.0, 300.0, 1e3, 3e3, 10e3, 30e3, 100e3)
"""Measurement ranges, ohm; source: record `FUNC:IMP:RANG?` of the EPICS support `Kse4980`."""
OVERLOAD_BELOW = 1 / 3
"""Share of a fixed range below which |Z| overloads it. Chosen here: a low |Z| drives too much
current through the range resistor, but the limit is in no manual that was at hand."""
SPEEDS = {"SHOR": "FAST", "MED": "MEDIUM", "LONG": "SLOW"}
"""Speed of an accuracy table for each aperture."""
DECADES = (20.0, 100.0, 1e3, 10e3, 100e3, 1e6, 2e6)
SECONDS = {
    "SHOR": (0.33, 0.1, 0.02, 7.7e-3, 5.7e-3, 5.6e-3, 5.6e-3),
    "MED": (0.38, 0.18, 0.11, 92e-3, 89e-3, 88e-3, 88e-3),
    "LONG": (0.48, 0.3, 0.24, 0.23, 0.22, 0.22, 0.22),
}
"""Times of a measurement at DECADES, s: typical values of the E4980A's data sheet."""
FUNCTIONS = {
    "CPD": ("CP", "DC"),
    "CPQ": ("CP", "QC"),
    "CPG": ("CP", "G"),
    "CPRP": ("CP", "RP"),
    "CSD": ("CS", "DC"),
    "CSQ": ("CS", "QC"),
    "CSRS": ("CS", "RS"),
    "LPD": ("LP", "D"),
    "LPQ": ("LP", "Q"),
    "LPG": ("LP", "G"),
    "LPRP": ("LP", "RP"),
    "LPRD": ("LP", "RDC"),
    "LSD": ("LS", "D"),
    "LSQ": ("LS", "Q"),
    "LSRS": ("LS", "RS"),
    "LSRD": ("LS", "RDC"),
    "RX": ("RS", "X"),
    "ZTD": ("Z", "PHASE"),
    "ZTR": ("Z", "RADIANS"),
    "GB": ("G", "B"),
    "YTD": ("Y", "YPHASE"),
    "YTR": ("Y", "YRADIANS"),
    "VDID": ("VDC", "IDC"),
}
"""Quantities of each function, as `shown_quantity` names them; RDC is not measured."""


@dataclass(frozen=True)
class LcrLimits:
    """Limits of a model. frequency: Hz. list_points: of a sweep. lengths: of the cable, m."""

    frequency: tuple[float, float]
    list_points: int
    lengths: tuple[int, ...] = (0, 1, 2, 4)
    voltage: tuple[float, float] = (0.0, 2.0)
    current: tuple[float, float] = (0.0, 20e-3)


@dataclass
class LcrSettings:
    """Settings after `*RST`, but continuous. voltage: V. current: A. range: ohm. delays: s.

    level: which of voltage and current was set last. list_values: of the sweep, in the unit of
    list_kind. references: of the deviations, in the unit of the quantity. length: of the cable, m.
    load_type: function of the reference values of the load.
    """

    frequency: float = 1e3
    level: str = "VOLT"
    voltage: float = 1.0
    current: float = 0.0
    function: str = "CPD"
    range: float = 100e3
    auto_range: bool = True
    aperture: str = "MED"
    averaging: int = 1
    trigger: str = "INT"
    delay: float = 0.0
    step_delay: float = 0.0
    continuous: bool = True
    page: str = "MEAS"
    list_mode: str = "SEQ"
    list_kind: str = "FREQ"
    list_values: tuple[float, ...] = ()
    deviation_1: str = "OFF"
    deviation_2: str = "OFF"
    references: tuple[float, float] = (0.0, 0.0)
    comparator: bool = False
    long_format: bool = False
    level_control: bool = False
    bias: bool = False
    bias_voltage: float = 0.0
    bias_current: float = 0.0
    bias_auto_range: bool = True
    high_power: bool = False
    display: bool = True
    open_correction: bool = False
    short_correction: bool = False
    load_correction: bool = False
    load_type: str = "CPD"
    length: int = 0
    method: str = "SING"
    spots: dict[int, CorrectionSpot] = field(default_factory=dict)

    def conditions(self, Z: complex, accuracy: AccuracyTable) -> ReadingConditions:
        """Conditions of a measurement of Z in ohm; range: 1 for 100 mohm to 10 for 100 kohm."""
        used = fitting_range(abs(Z)) if self.auto_range else self.range
        loop = abs(OUTPUT_RESISTANCE + Z)
        return ReadingConditions(
            self.frequency,
            RANGES.index(used) + 1,
            SPEEDS[self.aperture],
            self.averaging,
            self.voltage if self.level == "VOLT" else self.current * loop,
            int(self.length > 0),
        )

    def status(self, Z: complex, used: ReadingConditions, accuracy: AccuracyTable) -> int:
        """Overflow if |Z| overloads a fixed range."""
        overloaded = abs(Z) < OVERLOAD_BELOW * RANGES[used.range - 1]
        return OVERFLOW if overloaded and not self.auto_range else NORMAL

    @property
    def seconds(self) -> float:
        """Time of one measurement, s, without the trigger's delay."""
        at = math.log(min(max(self.frequency, DECADES[0]), DECADES[-1]))
        known = [math.log(each) for each in DECADES]
        n = min(bisect_right(known, at), len(known) - 1)
        low, high = SECONDS[self.aperture][n - 1 : n + 1]
        share = (at - known[n - 1]) / (known[n] - known[n - 1])
        return self.step_delay + self.averaging * (low + share * (high - low))

    def list_points(self) -> Sequence[LcrSettings]:
        """Settings at each point of the list."""
        if self.list_kind == "FREQ":
            return [replace(self, frequency=value) for value in self.list_values]
        bias = {"BVOL": "bias_voltage", "BCUR": "bias_current"}
        level = self.level if self.list_kind in bias else self.list_kind
        name = {"VOLT": "voltage", "CURR": "current", **bias}[self.list_kind]
        return [replace(self, level=level, **{name: value}) for value in self.list_values]


def fitting_range(ohms: float) -> float:
    """The highest range that does not exceed |Z|; the lowest one if none does."""
    return max((each for each in RANGES if each <= ohms * (1 + 1e-9)), default=RANGES[0])


def rounded_frequency(frequency: float) -> float:
    """Frequency that the meter sets: four digits, as its data sheet gives for the E4980A.

    The 4284A has 8610 frequencies of its own. Which ones is in no manual that was at hand, so that
    the virtual one takes these.
    """
    return float(f"{frequency:.3E}")


def shown_quantity(name: str, Z: complex, frequency: float) -> float:
    """Quantity by name from Z in ohm. D and Q of a capacitor are positive, angles in degrees."""
    if name in ("VDC", "IDC"):
        return 0.0
    if name in ("DC", "QC"):
        return -quantity(name[0], Z, frequency)
    if name.endswith("RADIANS"):
        name, factor = name.replace("RADIANS", "PHASE"), math.pi / 180
        return factor * shown_quantity(name, Z, frequency)
    return -quantity("PHASE", Z, frequency) if name == "YPHASE" else quantity(name, Z, frequency)

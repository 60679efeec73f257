"""Instruments of the tests of settings: how each is found, what is set, and what it is then."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from rcskin.hardware.meter.instruments import INSTRUMENTS
from rcskin.hardware.virtual.hioki.meter_state import PerRange, Settings
from rcskin.hardware.virtual.keysight.analyser_settings import AnalyserSettings, Segment
from rcskin.hardware.virtual.keysight.lcr_settings import LcrSettings


@dataclass(frozen=True)
class Case:
    """An instrument. found: settings as found. changes: values for the driver, in this order.

    acquired: open correction of the virtual meter after it was acquired. lost: settings that a
    power cut changes and no driver knows.
    """

    model: str
    found: Callable[[], Any]
    changes: Mapping[str, Any]
    acquired: Any = True
    lost: Mapping[str, Any] | None = None

    @property
    def driver(self) -> Any:
        """Class of the driver."""
        return INSTRUMENTS[self.model]


def hioki() -> Settings:
    """Settings that no command here leaves untouched, each range with its own."""
    each = {n: PerRange(("FAST", "SLOW")[n % 2], n, n / 10) for n in range(1, 11)}
    return Settings(
        header=True,
        mode="CONTINUOUS",
        frequency=2e3,
        level="CC",
        voltage=0.5,
        constant_voltage=0.25,
        constant_current=2e-3,
        range=7,
        auto_range=False,
        parameters=("CP", "D"),
        items=(1, 2),
        valid=2,
        each_range=each,
        load_correction=True,
        cable=1,
    )


def keysight(level: str = "VOLT") -> LcrSettings:
    """Settings that no command here leaves untouched."""
    return LcrSettings(
        frequency=2e3,
        level=level,
        voltage=0.5,
        current=2e-3,
        function="ZTD",
        range=1e3,
        auto_range=False,
        aperture="SHOR",
        averaging=3,
        trigger="INT",
        step_delay=0.5,
        continuous=False,
        page="LSET",
        list_mode="STEP",
        list_values=(1e3, 3e3),
        level_control=True,
        load_correction=True,
        length=1,
    )


IM3523 = Case(
    "IM3523",
    hioki,
    {
        "speed": "SLOW2",
        "cable": 0,
        "level": "V",
        "voltage": 1.0,
        "constant_voltage": 1.0,
        "constant_current": 1e-2,
        "auto_range": True,
        "averaging": 2,
        "trigger_delay": 0.0,
        "load_correction": False,
        "frequency": 5e3,
    },
    acquired="ALL",
    lost={"parameters": Settings().parameters},
)
CHANGES = {
    "speed": "LONG",
    "cable": 0,
    "amplitude": "1 V",
    "level": "V",
    "auto_range": True,
    "averaging": 2,
    "trigger_delay": 0.0,
    "load_correction": False,
    "frequency": 5e3,
}
LOST_LIST = {"list_mode": "SEQ", "list_values": ()}
E4980A = Case("E4980A", keysight, CHANGES, lost={**LOST_LIST, "current": 0.0})
HP4284A = Case(
    "4284A",
    lambda: keysight("CURR"),
    {**CHANGES, "amplitude": "0.005 A"},
    lost={**LOST_LIST, "voltage": 1.0},
)
E4990A = Case(
    "E4990A",
    lambda: AnalyserSettings(
        start=1e3,
        stop=1e6,
        sweep_type="LOG",
        segment_table=(7, 0, 0, 0, 0, 0, 0, 0, 1, 1e3, 2e3, 3),
        segments=(Segment(1e3, 2e3, 3),),
        parameters=("CP", "D", "Z", "Y"),
        level="CURR",
        voltage=0.25,
        current=1e-3,
        time=2,
        point_average=True,
        point_count=8,
        sweep_average=True,
        trigger="EXT",
        continuous=False,
        load_correction=True,
    ),
    {
        "speed": 3,
        "averaging": 1,
        "level": "V",
        "voltage": 0.5,
        "constant_current": 2e-3,
        "load_correction": False,
    },
    lost={
        "parameters": ("CP", "D"),
        "start": 20.0,
        "stop": 120e6,
        "sweep_type": "LIN",
        "segments": AnalyserSettings().segments,
        "segment_table": AnalyserSettings().segment_table,
    },
)
CASES = (IM3523, E4980A, HP4284A, E4990A)

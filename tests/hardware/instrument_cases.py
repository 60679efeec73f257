"""Instruments of the tests of settings: how each is found, what is set, and what it is then."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from rcskin.hardware.meter.instruments import INSTRUMENTS
from rcskin.hardware.virtual.hioki import HiokiSettings
from rcskin.hardware.virtual.keysight_analyser import AnalyserSettings, Segment
from rcskin.hardware.virtual.keysight_lcr import LcrSettings
from rcskin.tests.pages.reading import blocks

PAGE = "docs/how-to/add-a-meter.md"


@dataclass(frozen=True)
class Case:
    """An instrument. found: settings as found. changes: values for the driver, in this order.

    acquired: open correction of the virtual meter after it was acquired. lost: settings that a
    power cut changes and no driver knows. quantities: lines of another client that change what the
    numbers are. meddling: lines that change how they are measured or triggered.
    """

    model: str
    found: Callable[[], Any]
    changes: Mapping[str, Any]
    acquired: Any = "ON"
    lost: Mapping[str, Any] | None = None
    quantities: tuple[str, ...] = ()
    meddling: tuple[str, ...] = ()

    @property
    def driver(self) -> Any:
        """Class of the driver."""
        return INSTRUMENTS[self.model]


def hioki() -> HiokiSettings:
    """Settings that no command here leaves untouched, each range with its own."""
    return HiokiSettings(
        header=True,
        mode="CONTINUOUS",
        frequency=2e3,
        level="CC",
        voltage=0.5,
        constant_voltage=0.25,
        constant_current=2e-3,
        range=7,
        auto_range=False,
        parameter_1="CP",
        parameter_2="D",
        items=(1, 2),
        valid=2,
        speed=("SLOW", "FAST") * 5,
        averaging=tuple(range(1, 11)),
        trigger_delay=tuple(n / 10 for n in range(1, 11)),
        load_correction=True,
        cable=1,
    )


def keysight(level: str = "voltage", delay: str = "step_delay") -> LcrSettings:
    """Settings that no command here leaves untouched."""
    return LcrSettings(
        frequency=2e3,
        level=level,
        voltage=0.5,
        current=2e-3,
        function="ZTD",
        range=1e3,
        auto_range=False,
        aperture=("SHORT", 3),
        trigger="INTERNAL",
        continuous=False,
        page="LSET",
        list_mode="STEPPED",
        list_values=(1e3, 3e3),
        level_control=True,
        references=(5e3, -1e5),
        load_correction=True,
        cable=1,
        **{delay: 0.5},
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
    lost={"parameter_1": "Z", "parameter_2": "PHASE"},
    quantities=(
        ":MEASure:ITEM 5,2",
        ":MEASure:ITEM 24,2",
        ":MEASure:ITEM 0,26",
        ":MEASure:ITEM 32,12;VALid 2",
        ":FREQuency 2E3",
    ),
    meddling=(
        ":MEASure:VALid 31",
        ":HEADer ON",
        ":TRIGger INTernal",
        ":LEVel CV",
        ":LEVel:CCURrent 1E-2",
        ":CORRection:LOAD OFF",
        ":CORRection:CABLe 0",
        ":RANGe 9",
        ":RANGe:SYNC:SPEEd ALL,SLOW",
        ":RANGe:SYNC:AVERaging ALL,9",
        ":RANGe:SYNC:TRIGger:DELay ALL,1",
    ),
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
LOST_LIST = {"list_mode": "SEQUENCE", "list_values": (), "references": (0.0, 0.0)}
LCR_QUANTITIES = (
    ":FUNC:IMP ZTD",
    ":FUNC:IMP GB",
    ":FUNC:IMP CPRP",
    ":FUNC:DEV1:MODE ABS",
    ":FUNC:DEV2:MODE PERC",
    ":FREQ 7E3;:LIST:FREQ 1E3,4E3,2E4",
    ":DISP:PAGE BNUM",
)
LCR_MEDDLING = (
    ":LIST:MODE STEP",
    ":TRIG:SOUR INT",
    ":INIT:CONT OFF",
    ":TRIG:DEL 2",
    ":APER LONG,2",
    ":AMPL:ALC OFF",
    ":FUNC:IMP:RANG:AUTO ON",
    ":CORR:LENG 2",
    ":CORR:LOAD:STAT OFF",
)
E4980A = Case(
    "E4980A",
    keysight,
    CHANGES,
    lost={**LOST_LIST, "current": 0.0},
    quantities=LCR_QUANTITIES,
    meddling=(*LCR_MEDDLING, ":TRIG:TDEL 20", ":VOLT 0.1"),
)
HP4284A = Case(
    "4284A",
    lambda: keysight("current", "trigger_delay"),
    {**CHANGES, "amplitude": "0.005 A"},
    lost={**LOST_LIST, "voltage": 1.0},
    quantities=LCR_QUANTITIES,
    meddling=(*LCR_MEDDLING, ":CURR 1E-3"),
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
        source_mode="CURRENT",
        voltage=0.25,
        constant_current=1e-3,
        speed=2,
        averages=True,
        averaging_count=8,
        sweep_averages=True,
        trigger="EXTERNAL",
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
    quantities=(
        ":CALC1:PAR1:DEF Z",
        ":CALC1:PAR2:DEF TZ",
        ":CALC1:PAR1:DEF X;:CALC1:PAR2:DEF R",
        ":CALC1:PAR1:DEF RP",
        ":SENS1:SEGM:DATA 7,0,0,0,0,0,0,0,2,1000,4000,2,20000,20000,2",
        ":SENS1:SWE:TYPE LIN",
    ),
    meddling=(
        ":CALC1:PAR2:SEL",
        ":TRIG:SOUR INT",
        ":INIT1:CONT OFF",
        ":CALC1:AVER ON",
        ":SENS1:AVER:COUN 4;STAT ON",
        ":SENS1:APER 5",
        ":SENS1:SWE:DEL 20",
        ":SOUR1:MODE VOLT",
        ":SOUR1:VOLT 0.1",
        ":SENS1:CORR2:LOAD OFF",
    ),
)
CASES = (IM3523, E4980A, HP4284A, E4990A)


def of_the_page() -> tuple[Case, dict[str, Any]]:
    """The meter that the page of docs adds, and the names that its blocks define."""
    names: dict[str, Any] = {}
    for block in blocks(PAGE, "python"):
        exec(compile(block, PAGE, "exec"), names)
    found = {"frequency": 2e3, "voltage": 0.5, "speed": "FAST", "continuous": False}
    changes = {"speed": "SLOW", "voltage": 0.25, "frequency": 5e3}
    case = Case(
        "MODEL1",
        lambda: names["Model1Settings"](**found),
        changes,
        quantities=(":FUNC ZTD",),
        meddling=(":SPEE FAST", ":TRIG:SOUR INT"),
    )
    return case, names

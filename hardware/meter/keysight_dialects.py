"""Dialects of Keysight's meters: LCR meters E4980A, E4980AL and 4284A, analyser E4990A.

The E4980AL and the 4284A speak as the E4980A. The analyser's manual was not read.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from ...simulator.meters.accuracy_table import METER_BANDS
from .meter_reading import ReadingStatus
from .setting import (
    CHOSEN,
    FROM_MEMORY,
    ChoiceFormat,
    IntegerFormat,
    MeterProperty,
    NumberFormat,
    NumbersFormat,
    OnOffFormat,
    PartsFormat,
    Setting,
    StateFormat,
    TokenFormat,
    WordFormat,
)

GUIDE = 'user\'s guide E4980-90230, chapter "SCPI Command Reference"'
QCODES = "driver of QCoDeS, `keysight_e4980a.py`"
PYMEASURE = "driver of pymeasure, `agilentE4980.py`"
PYMEASURE_4284A = "driver of pymeasure, `agilent4284A.py`"
EOLALDE = "github.com/eolalde/E4980A"
TWO_PROGRAMS = "driver of pymeasure for the 4284A, and two public programs for the E4980A"
FOUR_PROGRAMS = "four public programs; github.com/eolalde/E4980A sends both delays"
THREE_PROGRAMS = "three public programs for the 4284A"
AS_E4980A = "as on the E4980A; in no source of this model"
RJOLLOS = "github.com/rjollos/e4990a"
TRCRENSHAW = "github.com/trcrenshaw/E4990A-ImpedanceAnalyzer"
MAGDYNLAB = "github.com/Vrekrer/magdynlab"
PROBE_STATION = "a public program of a probe station"

SPEEDS = ("SHORt", "MEDium", "LONG")
TABLE_SPEEDS = {"SHORT": "FAST", "MEDIUM": "MEDIUM", "LONG": "SLOW"}
"""Speeds in the words of an accuracy table."""
RANGES = (0.1, 1.0, 10.0, 100.0, 300.0, 1e3, 3e3, 10e3, 30e3, 100e3)
"""Measurement ranges, ohm; source: record `FUNC:IMP:RANG?` of the EPICS support `Kse4980`."""
STATUSES = {
    -1: ReadingStatus.NOT_MEASURED,
    0: ReadingStatus.NORMAL,
    1: ReadingStatus.OVERLOAD,
    2: ReadingStatus.CONVERTER,
    3: ReadingStatus.SOURCE_OVERLOAD,
    4: ReadingStatus.NOT_LEVELLED,
}
"""Status of a reading by the number in the answer of an LCR meter; from memory, but -1, 0 and 1."""
CORRECTING, SWEEPING, MEASURING = 1, 8, 16
"""Bits of the operation status register: user's guide E4980-90230, pages 272 to 274."""
FUNCTIONS = tuple(
    "CPD CPQ CPG CPRP CSD CSQ CSRS LPD LPQ LPG LPRP LPRD LSD LSQ LSRS LSRD RX ZTD ZTR GB YTD YTR "
    "VDID".split()
)
PAGES = tuple(
    "MEASurement BNUMber BCOunt LIST MSETup CSETup LTABle LSETup CATAlog SYSTem SELF MLARge".split()
)
ON_OFF = OnOffFormat()
DEVIATION = TokenFormat(("ABSolute", "PERCent", "OFF"))


def states_of(header: str, name: str) -> MeterProperty[str]:
    """Row of what is ON or OFF, which the driver reads and sets only to correct."""
    return MeterProperty(header, StateFormat(), name, "OFF")


def range_row(*numbers: float) -> Setting[float]:
    """Row of the measurement ranges of a model, ohm."""
    allowed = ChoiceFormat("ohm", numbers)
    header, meaning = ":FUNCtion:IMPedance:RANGe[:VALue]", "Range; ends automatic choice"
    return Setting(header, allowed, meaning, 100e3, moves="auto_range")


def frequency_row(model: str, digits: int) -> Setting[float]:
    """Row of the frequency of a model, which is sent with so many digits."""
    band = METER_BANDS[model]
    allowed, twin = (NumberFormat("Hz", *band, sent, resolution=4) for sent in (digits, 4))
    return Setting(":FREQuency[:CW]", allowed, "Frequency", 1e3, twin=twin)


def list_row(model: str, digits: int, points: int, clear: str = "") -> Setting[tuple[float, ...]]:
    """Row of the frequencies of a list sweep."""
    allowed = NumbersFormat(NumberFormat("Hz", *METER_BANDS[model], digits, resolution=4), points)
    meaning = "Frequencies of the list sweep"
    return Setting(":LIST:FREQuency", allowed, meaning, clear=clear)


class LcrDialect:
    """Rows of the E4980A, which the other two LCR meters share.

    acquire: commands that acquire a correction. clear_list: empties the list. max_points: of a
    list. condition: query of the operation status register. seconds_at: times of a measurement by
    speed, as pairs of a frequency in Hz and a time in s, between which logarithms are straight.
    """

    source: ClassVar[str] = GUIDE
    sources: ClassVar[Mapping[str, str]] = {
        QCODES: "frequency voltage current function range auto_range aperture bias bias_voltage "
        "bias_auto_range open_correction short_correction",
        EOLALDE: "deviation_1 deviation_2 level_control",
        PYMEASURE: "trigger continuous data_format page list_mode list_frequencies",
        FOUR_PROGRAMS: "trigger_delay step_delay",
        PYMEASURE_4284A: "high_power load_type bias_current",
        TWO_PROGRAMS: "load_correction cable",
    }
    facts: ClassVar[Mapping[str, str]] = {
        "`*TRG` answers the reading": "user's guide E4980-90230, pages 249 to 252",
        "form of a reading and of a list sweep": "user's guide E4980-90230, pages 261 to 269",
        "bits of the registers": "user's guide E4980-90230, pages 272 to 274",
        "`:ABORt`, `:LIST:CLEar:ALL`": EOLALDE,
        "`:CORRection:OPEN:EXECute`, `:SYSTem:ERRor?`": QCODES,
        "times of a measurement": "data sheet 5989-4435EN, typical values",
        "meaning of the statuses 2, 3 and 4 of a reading": FROM_MEMORY,
        "20 errors in the queue, 20 s to acquire a correction, overload of a fixed range below a "
        "third of it (the virtual meter)": CHOSEN,
    }
    acquire: ClassVar = {
        kind: f":CORRection:{word}(:EXECute)"
        for kind, word in (("open", "OPEN"), ("short", "SHORt"), ("load", "LOAD"))
    }
    clear_list: ClassVar = ":LIST:CLEar:ALL"
    max_points: ClassVar[int] = 201
    condition: ClassVar = ":STATus:OPERation:CONDition"
    seconds_at: ClassVar[Mapping[str, tuple[tuple[float, float], ...]]] = {
        "SHORT": ((20, 0.33), (100, 0.1), (1e3, 0.02), (1e4, 7.7e-3), (1e5, 5.7e-3), (2e6, 5.6e-3)),
        "MEDIUM": ((20, 0.38), (100, 0.18), (1e3, 0.11), (1e4, 0.092), (1e5, 0.089), (2e6, 0.088)),
        "LONG": ((20, 0.48), (100, 0.3), (1e3, 0.24), (1e4, 0.23), (1e5, 0.22), (2e6, 0.22)),
    }

    frequency = frequency_row("E4980A", 4)
    voltage = Setting(
        ":VOLTage[:LEVel]",
        NumberFormat("V", 0, 20, 4),
        "Voltage of the generator, rms; above 2 V with option 001",
        1.0,
        twin=NumberFormat("V", 0, 2, 4),
    )
    current = Setting(
        ":CURRent[:LEVel]",
        NumberFormat("A", 0, 0.1, 4),
        "Current of the generator, rms; above 20 mA with option 001",
        0.0,
        twin=NumberFormat("A", 0, 20e-3, 4),
    )
    function = Setting(
        ":FUNCtion:IMPedance[:TYPE]", TokenFormat(FUNCTIONS), "Quantities of a reading", "CPD"
    )
    range = range_row(*RANGES)
    auto_range = Setting(
        ":FUNCtion:IMPedance:RANGe:AUTO",
        ON_OFF,
        "True if the meter chooses the range",
        True,
        moves="range",
    )
    aperture = Setting(
        ":APERture",
        PartsFormat((WordFormat(SPEEDS), IntegerFormat(1, 256))),
        "Time of integration, and readings averaged",
        ("MEDIUM", 1),
    )
    deviation_1 = Setting(
        ":FUNCtion:DEV1:MODE", DEVIATION, "Deviation of the first quantity", "OFF"
    )
    deviation_2 = Setting(
        ":FUNCtion:DEV2:MODE", DEVIATION, "Deviation of the second quantity", "OFF"
    )
    trigger = Setting(
        ":TRIGger:SOURce",
        WordFormat(("INTernal", "HOLD", "EXTernal", "BUS")),
        "Source of the trigger: the meter itself, a key, a contact, or *TRG",
        "INTERNAL",
    )
    trigger_delay: ClassVar[Setting[float]] = Setting(
        ":TRIGger:TDELay", NumberFormat("s", 0, 999, 5), "Time from trigger to measurement", 0.0
    )
    step_delay = Setting(
        ":TRIGger:DELay", NumberFormat("s", 0, 999, 5), "Time before each measurement", 0.0
    )
    continuous = Setting(
        ":INITiate:CONTinuous", ON_OFF, "True if the meter waits for triggers by itself", True
    )
    comparator = Setting(":COMParator[:STATe]", ON_OFF, "True if readings have a bin", False)
    data_format = Setting(
        ":FORMat[:DATA]", TokenFormat(("ASCii", "REAL")), "Format of answers", "ASC,64"
    )
    long_format = Setting(":FORMat:ASCii:LONG", ON_OFF, "True for nine decimals", False)
    level_control = Setting(
        ":AMPLitude:ALC", ON_OFF, "True if the amplitude is controlled at the skin", False
    )
    bias = states_of(":BIAS:STATe", "DC bias")
    bias_voltage = Setting(":BIAS:VOLTage[:LEVel]", NumberFormat("V", -40, 40, 4), "DC bias", 0.0)
    bias_current = Setting(":BIAS:CURRent[:LEVel]", NumberFormat("A", -0.1, 0.1, 4), "DC bias", 0.0)
    bias_auto_range = Setting(":BIAS:RANGe:AUTO", ON_OFF, "True if automatic", True)
    high_power = Setting(":OUTPut:HPOWer", ON_OFF, "True with option 001", False)
    page = Setting(
        ":DISPlay:PAGE", TokenFormat(PAGES), "Page of the display, which decides on sweeps", "MEAS"
    )
    display = Setting(":DISPlay:ENABle", ON_OFF, "True if the display works", True)
    open_correction = states_of(":CORRection:OPEN:STATe", "Open correction")
    short_correction = states_of(":CORRection:SHORt:STATe", "Short correction")
    load_correction = Setting(
        ":CORRection:LOAD:STATe", ON_OFF, "True if load correction is applied", False
    )
    load_type = Setting(
        ":CORRection:LOAD:TYPE", TokenFormat(FUNCTIONS), "Quantities of the load", "CPD"
    )
    cable = Setting(
        ":CORRection:LENGth",
        IntegerFormat(0, 4),
        "Length of the cable, m",
        0,
        twin=ChoiceFormat("m", (0, 1, 2, 4)),
    )
    method = Setting(
        ":CORRection:METHod", TokenFormat(("SINGle", "MULTi")), "Method of correction", "SING"
    )
    list_mode = Setting(
        ":LIST:MODE",
        WordFormat(("SEQuence", "STEPped")),
        "Points of a list per trigger",
        "SEQUENCE",
    )
    list_frequencies = list_row("E4980A", 4, max_points, clear_list)


class E4980ALDialect(LcrDialect):
    """Up to 1 MHz, by its option."""

    frequency = frequency_row("E4980AL", 4)
    list_frequencies = list_row("E4980AL", 4, 201, LcrDialect.clear_list)


class HP4284ADialect(LcrDialect):
    """Up to 1 MHz, of which it has 8610 frequencies; one delay. Times: from memory, generous."""

    sources: ClassVar = {
        PYMEASURE_4284A: "frequency voltage current function range auto_range trigger "
        "trigger_delay bias open_correction short_correction load_correction cable list_mode "
        "list_frequencies page data_format continuous high_power load_type bias_voltage "
        "bias_current",
        THREE_PROGRAMS: "aperture level_control deviation_1 deviation_2",
    }
    source = AS_E4980A
    facts: ClassVar = {
        "`*TRG` answers the reading; form of a list sweep": PYMEASURE_4284A,
        "`:ABORt`, `:STATus:OPERation:CONDition?`, `:CORRection:OPEN:EXECute`": AS_E4980A,
        "times of a measurement; meaning of the statuses of a reading": FROM_MEMORY,
        "frequencies of four digits instead of its own 8610 (the virtual meter)": CHOSEN,
    }
    seconds_at: ClassVar = {
        "SHORT": ((20, 1.35), (100, 0.27), (1e3, 0.04), (1e4, 0.03), (1e6, 0.03)),
        "MEDIUM": ((20, 2.0), (100, 0.4), (1e3, 0.19), (1e4, 0.18), (1e6, 0.18)),
        "LONG": ((20, 5.2), (100, 1.04), (1e3, 0.83), (1e4, 0.82), (1e6, 0.82)),
    }

    frequency = frequency_row("4284A", 6)
    max_points = 10
    list_frequencies = list_row("4284A", 6, max_points)
    range = range_row(*RANGES[1:])
    voltage = LcrDialect.voltage.for_twin(NumberFormat("V", 5e-3, 2, 4))
    current = LcrDialect.current.for_twin(NumberFormat("A", 50e-6, 20e-3, 4))
    cable = LcrDialect.cable.for_twin(ChoiceFormat("m", (0, 1, 2)))
    trigger_delay = Setting(
        ":TRIGger:DELay", NumberFormat("s", 0, 60, 5), "Time from trigger to measurement", 0.0
    )
    step_delay = None  # pyright: ignore[reportAssignmentType]


class AnalyserDialect:
    """Rows of the E4990A.

    acquire: commands that acquire a compensation. typical_seconds: times of a point for measurement
    times 1 to 5, s, of the family. longest_seconds, periods: longest time of a point, s and in
    periods of its frequency: assumed, and generous, as a time-out follows from them. table_speeds:
    words of an accuracy table.
    """

    source: ClassVar[str] = RJOLLOS
    sources: ClassVar[Mapping[str, str]] = {
        MAGDYNLAB: "trace_count data_format",
        TRCRENSHAW: "trace_1 trace_2 constant_current",
        "programmer's guide of the E5061A, chapter 13": "points",
        PROBE_STATION: "sweep_delay",
        "the SCPI tree of the analyser's help, as public drivers use it": "bias average_trigger "
        "sweep_count fixture byte_order",
    }
    facts: ClassVar[Mapping[str, str]] = {
        "`:TRIGger:SINGle` and `*OPC?`": RJOLLOS,
        "`:CALCulate1:PARameter1:SELect`, then `:CALCulate1:DATA:FDATa?`; `:ABORt`": TRCRENSHAW,
        "trigger system, registers, 100 errors in the queue": "programmer's guide of the E5061A, "
        "chapter 13 and appendix B",
        "a number out of range becomes the nearest limit": "user's guide of the E4981A, page 209",
        "times of a point": FROM_MEMORY,
        "a trace, `FDATa`, is read after the fixture compensation": FROM_MEMORY,
    }
    acquire: ClassVar = {
        kind: f":SENSe#:CORRection2:COLLect:ACQuire:{word}"
        for kind, word in (("open", "OPEN"), ("short", "SHORt"), ("load", "LOAD"))
    }
    typical_seconds: ClassVar = (3e-3, 21e-3, 36e-3, 71e-3, 138e-3)
    longest_seconds: ClassVar = (5e-3, 0.03, 0.07, 0.14, 0.25)
    periods: ClassVar = (2, 4, 8, 16, 32)
    table_speeds: ClassVar = ("FAST", "MEDIUM", "SLOW", "SLOW", "SLOW2")

    trace_count = Setting(":CALCulate#:PARameter:COUNt", IntegerFormat(1, 4), "Number of traces")
    trace_1 = Setting(":CALCulate1:PARameter1:DEFine", TokenFormat(), "Quantity of trace 1")
    trace_2 = Setting(":CALCulate1:PARameter2:DEFine", TokenFormat(), "Quantity of trace 2")
    swept = MeterProperty(":SENSe#:FREQuency:DATA", NumbersFormat(), "Frequencies of the sweep")
    points = Setting(
        ":SENSe#:SWEep:POINts",
        IntegerFormat(2, 1601),
        "Points of a linear or logarithmic sweep",
        201,
    )
    sweep_type = Setting(
        ":SENSe#:SWEep:TYPE",
        TokenFormat(("LINear", "LOGarithmic", "SEGMent")),
        "Type of the sweep",
        "LIN",
    )
    sweep_delay = Setting(
        ":SENSe#:SWEep:DELay", NumberFormat("s", 0, 30, 5), "Time before each measurement", 0.0
    )
    segments = Setting(":SENSe#:SEGMent:DATA", NumbersFormat(), "Table of the segments")
    speed = Setting(
        ":SENSe#:APERture(:TIME)",
        IntegerFormat(1, 5),
        "Measurement time: 1 fastest, 5 most accurate",
        1,
    )
    averages = Setting(":SENSe#:AVERage(:STATe)", ON_OFF, "True if points are averaged", False)
    averaging_count = Setting(
        ":SENSe#:AVERage:COUNt", IntegerFormat(1, 999), "Readings of a point that are averaged", 1
    )
    sweep_averages = Setting(
        ":CALCulate#:AVERage(:STATe)", ON_OFF, "True if sweeps are averaged", False
    )
    sweep_count = Setting(
        ":CALCulate#:AVERage:COUNt", IntegerFormat(1, 999), "Sweeps that are averaged", 1
    )
    average_trigger = Setting(
        ":TRIGger[:SEQuence]:AVERage", ON_OFF, "True if one trigger starts them all", False
    )
    source_mode = Setting(
        ":SOURce#:MODE",
        WordFormat(("VOLTage", "CURRent")),
        "Kind of the oscillator's level",
        "VOLTAGE",
    )
    voltage = Setting(
        ":SOURce#:VOLTage[:LEVel]", NumberFormat("V", 5e-3, 1, 4), "Voltage, rms, level V", 0.5
    )
    constant_current = Setting(
        ":SOURce#:CURRent[:LEVel]",
        NumberFormat("A", 200e-6, 20e-3, 4),
        "Current, rms, level CC",
        200e-6,
    )
    bias = states_of(":SOURce#:BIAS:STATe", "DC bias")
    open_correction = states_of(":SENSe#:CORRection2:OPEN", "Open compensation of the fixture")
    short_correction = states_of(":SENSe#:CORRection2:SHORt", "Short compensation of the fixture")
    load_correction = Setting(
        ":SENSe#:CORRection2:LOAD", ON_OFF, "True if load compensation is applied", False
    )
    fixture_points = Setting(
        ":SENSe#:CORRection:COLLect:FPOints",
        TokenFormat(("FIXed", "USER")),
        "Frequencies of the compensation",
        "FIX",
    )
    fixture = Setting(
        ":SENSe#:FIXTure:SELect", TokenFormat(("NONE", "ARBitrary")), "Fixture", "NONE"
    )
    data_format = Setting(
        ":FORMat:DATA", TokenFormat(("ASCii", "REAL", "REAL32")), "Format of answers", "ASC"
    )
    byte_order = Setting(
        ":FORMat:BORDer", TokenFormat(("NORMal", "SWAPped")), "Order of bytes", "NORM"
    )
    trigger = Setting(
        ":TRIGger[:SEQuence]:SOURce",
        WordFormat(("INTernal", "EXTernal", "MANual", "BUS")),
        "Source of the trigger: the analyser itself, a contact, a key, or a command",
        "INTERNAL",
    )
    continuous = Setting(
        ":INITiate#:CONTinuous", ON_OFF, "True if the analyser waits for triggers by itself", True
    )

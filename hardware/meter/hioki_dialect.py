"""Dialects of Hioki's LCR meters IM3523, IM3533, IM3536 and IM3570, one command language."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from ...simulator.meters.accuracy_table import METER_BANDS, RANGES
from .setting import (
    CHOSEN,
    FROM_MEMORY,
    IntegerFormat,
    MeterProperty,
    NumberFormat,
    OnOffFormat,
    RegisterFormat,
    Setting,
    WordFormat,
)

ON_OFF = OnOffFormat()
SPEEDS = ("FAST", "MEDium", "SLOW", "SLOW2")
CORRECTIONS = ("OFF", "ALL", "SPOT")
ITEMS = (("Z", "Y", "PHASE", "CS", "CP", "D", "LS", "LP"), ("Q", "RS", "G", "RP", "X", "B", "RDC"))
"""Quantities of a reading by register and bit; an answer has them in this order."""
PARAMETERS = WordFormat(("OFF", *ITEMS[0], *ITEMS[1]))
CP_RS_X = 16, 18
"""Registers of a reading of Cp, Rs and X."""
STATUS_AND_VALUES = 18
"""Bits of `:MEASure:VALid`: the status, 16, and the values, 2."""
NAMED = "the IM3523's documentation, which names it as a command of other models"


def frequency_of(model: str) -> Setting[float]:
    """Row of the frequency of a model."""
    allowed = NumberFormat("Hz", *METER_BANDS[model], 5, 5, "eng5")
    return Setting(":FREQuency", allowed, "Frequency", 1e3)


def voltage_from(low: float, header: str, meaning: str) -> Setting[float]:
    """Row of a voltage from `low` to 5 V."""
    return Setting(header, NumberFormat("V", low, 5, 4, 4, ".3f"), meaning, 1.0)


class HiokiDialect:
    """Rows that the four models share. Speed, averaging and delay of the IM3523 exist per range."""

    source: ClassVar[str] = "Hioki's documentation of the IM3523's communication commands"
    sources: ClassVar[Mapping[str, str]] = {}
    facts: ClassVar[Mapping[str, str]] = {
        "`*TRG;:MEASure?`; form and statuses of a reading; bits of the registers": source,
        "times of a reading": FROM_MEMORY,
        "4 s to acquire a correction at all frequencies, 1 s at one (the virtual meter)": CHOSEN,
    }

    header = Setting(":HEADer", ON_OFF, "True if answers begin with the command's name", False)
    mode = Setting(":MODE", WordFormat(("LCR", "CONTinuous")), "Mode of measurement", "LCR")
    items = Setting(
        ":MEASure:ITEM", RegisterFormat((255, 127)), "Quantities of a reading", default=(0, 0)
    )
    valid = Setting(":MEASure:VALid", IntegerFormat(1, 31), "Parts of a reading", 31)
    parameter_1 = Setting(":PARameter1", PARAMETERS, "First quantity on the display", "Z")
    parameter_2 = Setting(":PARameter2", PARAMETERS, "Second quantity on the display", "PHASE")
    compatible = Setting(
        ":COMMand:COMPatible", ON_OFF, "True if commands of the 3522-50 are known", False
    )
    terminator = Setting(
        ":TRANsmit:TERMinator", IntegerFormat(0, 1), "End of an answer: CR+LF (0) or CR (1)", 0
    )
    level = Setting(
        ":LEVel",
        WordFormat(("V", "CV", "CC")),
        "Controlled quantity: the open voltage (V), the skin's voltage (CV) or its current (CC)",
        "V",
    )
    voltage = voltage_from(5e-3, ":LEVel:VOLTage", "Open voltage, rms, level V")
    constant_voltage = voltage_from(5e-3, ":LEVel:CVOLTage", "Voltage on the skin, rms, level CV")
    constant_current = Setting(
        ":LEVel:CCURRent",
        NumberFormat("A", 10e-6, 50e-3, 4, 4, "eng4"),
        "Current through the skin, rms, level CC",
        10e-3,
    )
    range = Setting(
        ":RANGe",
        IntegerFormat(1, 10),
        "Range, 100 mohm x 10^(range - 1) full scale; ends automatic choice",
        6,
        moves="auto_range",
    )
    auto_range = Setting(
        ":RANGe:AUTO", ON_OFF, "True if the meter chooses the range", True, moves="range"
    )
    trigger = Setting(
        ":TRIGger",
        WordFormat(("INTernal", "EXTernal")),
        "Source of the trigger: the meter itself, or *TRG",
        "INTERNAL",
    )
    cable = Setting(":CORRection:CABLe", IntegerFormat(0, 1), "Length of the cable, m", 0)
    load_correction = Setting(
        ":CORRection:LOAD", ON_OFF, "True if load correction is applied", False
    )
    open_correction = MeterProperty(
        ":CORRection:OPEN", WordFormat(CORRECTIONS), "Open correction in use", "OFF"
    )
    short_correction = MeterProperty(
        ":CORRection:SHORt", WordFormat(CORRECTIONS), "Short correction in use", "OFF"
    )
    frequency = frequency_of("IM3523")
    speed = Setting(
        ":RANGe:SYNC:SPEEd", WordFormat(SPEEDS), "Speed", ("MEDIUM",) * 10, each_range=RANGES
    )
    averaging = Setting(
        ":RANGe:SYNC:AVERaging",
        IntegerFormat(1, 256, "OFF"),
        "Readings averaged",
        (1,) * 10,
        each_range=RANGES,
    )
    trigger_delay = Setting(
        ":RANGe:SYNC:TRIGger:DELay",
        NumberFormat("s", 0, 9.9999, 5, answered=".4f"),
        "Time from trigger to measurement",
        (0.0,) * 10,
        each_range=RANGES,
    )


class HiokiSiblingDialect(HiokiDialect):
    """Rows of the IM3533, IM3536 and IM3570; the IM3523 knows them when it is `compatible`."""

    sources: ClassVar = {NAMED: "speed averaging trigger_delay"}

    speed = Setting(":SPEEd", HiokiDialect.speed.allowed, "Speed")
    averaging = Setting(":AVERaging", HiokiDialect.averaging.allowed, "Readings averaged")
    trigger_delay = Setting(
        ":TRIGger:DELay", HiokiDialect.trigger_delay.allowed, "Time from trigger to measurement"
    )

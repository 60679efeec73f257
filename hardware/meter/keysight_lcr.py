"""LCR meters E4980A and E4980AL by Keysight (once Agilent) and 4284A by Hewlett-Packard.

Sources: E4980A/E4980AL User's Guide (E4980-90230), chapters "SCPI Command Reference" and "Remote
Control"; 4284A Operation Manual (04284-90040), chapter "Command Reference"; public programs for
these meters. docs/reference/meter.md says which command rests on which.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np

from ...simulator.meters.accuracy_table import (
    METER_BANDS,
    OUTPUT_RESISTANCE,
    RANGES,
    AccuracyTable,
    ReadingConditions,
)
from ...simulator.sweeps import InputError
from .errors import FailedReadingError
from .keysight_meter import (
    CORRECTION_SECONDS,
    AmplitudeSetting,
    FrequencyListFormat,
    KeysightMeter,
    NumbersSetting,
    reading_of,
    state_of,
)
from .meter_reading import MeterReading, ReadingStatus
from .setting import (
    ChoiceFormat,
    IntegerFormat,
    NumberFormat,
    OnOffFormat,
    PartsFormat,
    Setting,
    SettingPart,
    TokenFormat,
    WordFormat,
)

SPEEDS = ("SHORt", "MEDium", "LONG")
TABLE_SPEEDS = {"SHORT": "FAST", "MEDIUM": "MEDIUM", "LONG": "SLOW"}
"""Speeds in the words of an accuracy table."""
MEASUREMENT_PAGE, LIST_PAGE = "MEAS", "LIST"
VALUES_OF_POINT = 4
"""Values of a point in the answer of a list sweep: R, X, status, comparison."""
CORRECTING = 1
"""Bit of the operation status register: correction data are being measured."""
STATUSES = {
    -1: ReadingStatus.NOT_MEASURED,
    0: ReadingStatus.NORMAL,
    1: ReadingStatus.OVERLOAD,
    2: ReadingStatus.CONVERTER,
    3: ReadingStatus.SOURCE_OVERLOAD,
    4: ReadingStatus.NOT_LEVELLED,
}
"""Status of a reading by the number in the meter's answer."""


class KeysightLcrMeter(KeysightMeter):
    """Common part of the three models."""

    needed: ClassVar = {
        "function": "RX",
        "deviation_1": "OFF",
        "deviation_2": "OFF",
        "continuous": True,
        "trigger": "BUS",
    }
    meaning = ("function", "deviation_1", "deviation_2")
    settable = (
        "level",
        "amplitude",
        "range",
        "auto_range",
        "speed",
        "averaging",
        "trigger_delay",
        "cable",
        "load_correction",
    )
    reported = ("open_correction", "short_correction", "bias")
    timing = ("frequency", "aperture", "trigger_delay")
    delays = ("trigger_delay",)
    restored_last = ("auto_range", "page", "continuous", "trigger")
    rounding = 6e-4
    correction_commands: ClassVar = {
        "open": ":CORRection:OPEN:EXECute",
        "short": ":CORRection:SHORt:EXECute",
    }
    correction_states: ClassVar = {
        "open": ":CORRection:OPEN:STATe",
        "short": ":CORRection:SHORt:STATe",
    }
    list_frequencies: ClassVar[NumbersSetting]
    _listed: tuple[float, ...] = ()
    seconds_at: ClassVar[Mapping[str, tuple[tuple[float, float], ...]]]

    data_format = Setting(":FORMat", TokenFormat(), "Format of answers")
    function = Setting(":FUNCtion:IMPedance", TokenFormat(), "Quantities of a reading")
    deviation_1 = Setting(":FUNCtion:DEV1:MODE", TokenFormat(), "Deviation of the first quantity")
    deviation_2 = Setting(":FUNCtion:DEV2:MODE", TokenFormat(), "Deviation of the second quantity")
    page = Setting(":DISPlay:PAGE", TokenFormat(), "Page of the display, which decides on sweeps")
    list_mode = Setting(
        ":LIST:MODE", WordFormat(("SEQuence", "STEPped")), "Points of a list per trigger"
    )
    continuous = Setting(
        ":INITiate:CONTinuous", OnOffFormat(), "True if the meter waits for triggers by itself"
    )
    trigger = Setting(
        ":TRIGger:SOURce",
        WordFormat(("INTernal", "EXTernal", "BUS", "HOLD")),
        "Source of the trigger: the meter itself, a contact, *TRG, or a key",
    )
    trigger_delay: ClassVar[Setting[float]]
    level_control = Setting(
        ":AMPLitude:ALC", OnOffFormat(), "True if the amplitude is controlled at the skin"
    )
    amplitude = AmplitudeSetting()
    auto_range = Setting(
        ":FUNCtion:IMPedance:RANGe:AUTO",
        OnOffFormat(),
        "True if the meter chooses the range",
        moves="range",
    )
    aperture = Setting(
        ":APERture", PartsFormat((WordFormat(SPEEDS), IntegerFormat(1, 256))), "Time of integration"
    )
    speed = SettingPart(aperture, 0, "Speed")
    averaging = SettingPart(aperture, 1, "Readings averaged")
    cable = Setting(":CORRection:LENGth", IntegerFormat(0, 4), "Length of the cable, m")
    load_correction = Setting(
        ":CORRection:LOAD:STATe", OnOffFormat(), "True if load correction is applied"
    )
    open_correction = state_of(":CORRection:OPEN:STATe", "Open correction")
    short_correction = state_of(":CORRection:SHORt:STATe", "Short correction")
    bias = state_of(":BIAS:STATe", "DC bias")

    @property
    def level(self) -> str:
        """Controlled quantity: the open voltage (V), the skin's voltage (CV) or current (CC)."""
        if not self.level_control:
            return "V"
        return "CV" if self.amplitude.endswith("V") else "CC"

    @level.setter
    def level(self, value: str) -> None:
        self.level_control = value != "V"

    def own_settings(self, requested: Mapping[str, Any]) -> dict[str, Any]:
        """Requested settings with the amplitude and its unit in one."""
        own = dict(requested)
        for name, unit in (("voltage", "V"), ("constant_voltage", "V"), ("constant_current", "A")):
            if name in own:
                own["amplitude"] = f"{own.pop(name):g} {unit}"
        level, amplitude = own.get("level"), own.get("amplitude", "")
        if level not in (None, "V", "CV", "CC"):
            raise InputError(f"`level` must be one of V, CV, CC, got {level}")
        if level == "CC" and not amplitude.endswith("A"):
            raise InputError("`level` CC needs an amplitude in A (--amplitude)")
        return own

    def set_up(self) -> None:
        """Set the meter up so that `*TRG` measures and answers R, X and the status."""
        super().set_up()
        self.data_format, self.page = "ASC", MEASUREMENT_PAGE

    def read_at(self, frequency: float) -> MeterReading:
        """Reading at a frequency in Hz, in two exchanges.

        The page is read back, because the trigger starts a list sweep on another one.
        """
        self._show(MEASUREMENT_PAGE)
        self.frequency = frequency

        def parsed(answer: str, found: dict[str, Any]) -> tuple[MeterReading, float]:
            R, X, status, *bin_number = answer.split(",")
            if len(bin_number) > 1 or not found["page"].startswith(MEASUREMENT_PAGE):
                raise ValueError(answer)
            return parse_point(R, X, status, frequency), found["frequency"]

        also = ("frequency", "page")
        reading, reported = self.measure("*TRG", parsed, self.max_seconds, also)
        self.check_frequencies([frequency], [reported])
        return reading

    def sweep_once(self, frequencies: Sequence[float]) -> list[MeterReading]:
        """Readings of one list sweep. The meter answers its list before them and after them."""
        setting, wanted = type(self).list_frequencies, tuple(frequencies)
        if self._listed != wanted:
            self.list_mode, self.list_frequencies = "SEQUENCE", wanted
            self._listed = wanted
        self._show(LIST_PAGE)

        def readings(answer: str, found: dict[str, Any]) -> list[MeterReading]:
            before, _, data = answer.partition(";")
            values = data.split(",")
            for listed in (setting.allowed.read(before), found[setting.name]):
                self.check_frequencies(frequencies, listed)
            if len(values) != VALUES_OF_POINT * len(frequencies):
                raise ValueError(answer)
            points = zip(wanted, values[0::4], values[1::4], values[2::4], strict=True)
            return [parse_point(R, X, status, frequency) for frequency, R, X, status in points]

        with self.sweeping(frequencies) as seconds:
            return self.measure(f"{setting.query};*TRG", readings, seconds, (setting.name,))

    def _show(self, page: str) -> None:
        if self.cached.get("page") != page:
            self.page = page

    @classmethod
    def reading_seconds(cls, timing: Mapping[str, Any]) -> float:
        """Approximate time of a reading, s: between the table's frequencies, straight in logs."""
        speed, averaging = timing["aperture"]
        frequency, seconds = np.log(np.array(cls.seconds_at[speed]).T)
        one = float(np.exp(np.interp(np.log(timing["frequency"]), frequency, seconds)))
        return one * averaging + timing["trigger_delay"] + timing.get("step_delay", 0.0)

    @classmethod
    def conditions(
        cls, settings: Mapping[str, Any], frequency: float, Z: complex, table: AccuracyTable
    ) -> ReadingConditions:
        """Conditions of a reading of Z [ohm] with the settings of a snapshot.

        A range is replaced by the table's nearest one.
        """
        number, _, unit = settings["amplitude"].partition(" ")
        loop = abs(OUTPUT_RESISTANCE + Z)
        voltage = float(number) * (loop if unit == "A" else 1.0)
        if settings["level"] == "CV":
            voltage *= loop / abs(Z) if Z else 1.0
        full_scale = settings.get("range")
        return ReadingConditions(
            frequency,
            _range_number(full_scale) if full_scale else table.fitting_range(Z),
            TABLE_SPEEDS[settings["speed"]],
            settings["averaging"],
            voltage,
            min(settings["cable"], 1),
        )

    def correction_done(self) -> bool:
        """True if the started correction has ended."""
        status = self.talk.query(":STATus:OPERation:CONDition?", int, seconds=CORRECTION_SECONDS)
        return not status & CORRECTING


def parse_point(R: str, X: str, status: str, frequency: float) -> MeterReading:
    """Reading in the meter's texts. frequency: Hz.

    Raises FailedReadingError if the status is a failure, ValueError if a text is no number.
    """
    code = int(status)
    meaning = STATUSES.get(code)
    where = f"the reading at {frequency:g} Hz failed with status {code}"
    if meaning is None:
        raise FailedReadingError(f"{where}, which has no known meaning")
    if not meaning.has_values:
        raise FailedReadingError(f"{where}: {meaning.meaning}")
    return reading_of(float(R), float(X), meaning)


def _range_number(full_scale: float) -> int:
    """Number of the range with the nearest full scale in ohm, see `accuracy_table.full_scale`."""
    return int(np.clip(round(np.log10(full_scale)) + 2, RANGES[0], RANGES[-1]))


def _list_setting(model: str, digits: int, points: int, clear: str = "") -> NumbersSetting:
    allowed = FrequencyListFormat(NumberFormat("Hz", *METER_BANDS[model], digits), points)
    return NumbersSetting(":LIST:FREQuency", allowed, "Frequencies of the list sweep", clear)


def _range_setting(*numbers: float) -> Setting[float]:
    return Setting(
        ":FUNCtion:IMPedance:RANGe",
        ChoiceFormat("ohm", numbers),
        "Range; ends automatic choice",
        moves="auto_range",
    )


class E4980A(KeysightLcrMeter):
    """20 Hz to 2 MHz, which it sets with four digits. Times: data sheet, measurement time."""

    model = "E4980A"
    max_points = 201
    settable = (*KeysightLcrMeter.settable, "step_delay")
    timing = (*KeysightLcrMeter.timing, "step_delay")
    delays = ("trigger_delay", "step_delay")
    trigger_delay = Setting(
        ":TRIGger:TDELay", NumberFormat("s", 0, 999, 5), "Time from trigger to measurement"
    )
    step_delay = Setting(
        ":TRIGger:DELay", NumberFormat("s", 0, 999, 5), "Time before each measurement"
    )
    frequency = Setting(":FREQuency", NumberFormat("Hz", *METER_BANDS["E4980A"], 4), "Frequency")
    list_frequencies = _list_setting("E4980A", 4, max_points, ":LIST:CLEar:ALL")
    range = _range_setting(0.1, 1, 10, 100, 300, 1e3, 3e3, 1e4, 3e4, 1e5)
    seconds_at: ClassVar = {
        "SHORT": ((20, 0.33), (100, 0.1), (1e3, 0.02), (1e4, 7.7e-3), (1e5, 5.7e-3), (2e6, 5.6e-3)),
        "MEDIUM": ((20, 0.38), (100, 0.18), (1e3, 0.11), (1e4, 0.092), (1e5, 0.089), (2e6, 0.088)),
        "LONG": ((20, 0.48), (100, 0.3), (1e3, 0.24), (1e4, 0.23), (1e5, 0.22), (2e6, 0.22)),
    }


class E4980AL(E4980A):
    """20 Hz to 300 kHz, 500 kHz or 1 MHz, by its option."""

    model = "E4980AL"
    frequency = Setting(":FREQuency", NumberFormat("Hz", *METER_BANDS["E4980AL"], 4), "Frequency")
    list_frequencies = _list_setting("E4980AL", 4, 201, ":LIST:CLEar:ALL")


class HP4284A(KeysightLcrMeter):
    """20 Hz to 1 MHz, of which it has 8610 frequencies. Times: from memory, generous."""

    model = "4284A"
    max_points = 10
    trigger_delay = Setting(
        ":TRIGger:DELay", NumberFormat("s", 0, 60, 5), "Time from trigger to measurement"
    )
    frequency = Setting(":FREQuency", NumberFormat("Hz", *METER_BANDS["4284A"], 6), "Frequency")
    list_frequencies = _list_setting("4284A", 6, max_points)
    range = _range_setting(1, 10, 100, 300, 1e3, 3e3, 1e4, 3e4, 1e5)
    seconds_at: ClassVar = {
        "SHORT": ((20, 1.35), (100, 0.27), (1e3, 0.04), (1e4, 0.03), (1e6, 0.03)),
        "MEDIUM": ((20, 2.0), (100, 0.4), (1e3, 0.19), (1e4, 0.18), (1e6, 0.18)),
        "LONG": ((20, 5.2), (100, 1.04), (1e3, 0.83), (1e4, 0.82), (1e6, 0.82)),
    }


KEYSIGHT_LCR = (E4980A, E4980AL, HP4284A)
"""Classes of the three models."""

"""LCR meters E4980A and E4980AL by Keysight (once Agilent) and 4284A by Hewlett-Packard."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np

from ...simulator.meters.accuracy_table import (
    OUTPUT_RESISTANCE,
    RANGES,
    AccuracyTable,
    ReadingConditions,
)
from ...simulator.sweeps import InputError
from .errors import FailedReadingError, RefusedError
from .keysight_dialects import (
    CORRECTING,
    STATUSES,
    TABLE_SPEEDS,
    E4980ALDialect,
    HP4284ADialect,
    LcrDialect,
)
from .keysight_meter import CORRECTION_SECONDS, KeysightMeter, reading_of
from .meter_reading import MeterReading
from .setting import Setting, SettingPart, SettingsOwner

MEASUREMENT_PAGE, LIST_PAGE = "MEAS", "LIST"
VALUES_OF_POINT = 4
"""Values of a point in the answer of a list sweep: R, X, status, comparison."""


class AmplitudeFormat:
    """Amplitude with its unit: `0.5 V` or `0.001 A`, rms."""

    rows: ClassVar[Mapping[str, Setting[float]]] = {
        "V": LcrDialect.voltage,
        "A": LcrDialect.current,
    }

    def __str__(self) -> str:
        return " or ".join(str(row.allowed) for row in self.rows.values())

    def write(self, value: Any) -> str | None:
        """The command with the number."""
        number, _, unit = str(value).partition(" ")
        if unit not in self.rows:
            return None
        try:
            text = self.rows[unit].allowed.write(float(number))
        except ValueError:
            return None
        return text and f"{self.rows[unit].command} {text}"

    def read(self, text: str) -> str:
        """The amplitude in a command."""
        command, _, number = text.partition(" ")
        unit = next(unit for unit, row in self.rows.items() if row.command == command)
        return f"{float(number):.4g} {unit}"


class AmplitudeSetting(Setting[str]):
    """Amplitude of the generator: a voltage or a current, whichever the meter controls.

    The query of the other one is an error and has no answer.
    """

    def __init__(self) -> None:
        super().__init__("", AmplitudeFormat(), "Amplitude of the generator, rms")
        self.command_text = ""

    def __get__(self, meter: Any, owner: type) -> Any:
        if meter is None:
            return self
        latest = str(meter.cached.get(self.name, "V"))[-1]
        first, second = sorted(AmplitudeFormat.rows, key=lambda unit: unit != latest)
        try:
            value = self._query(meter, first)
        except RefusedError:
            value = self._query(meter, second)
        meter.cached[self.name] = value
        return value

    def _query(self, meter: SettingsOwner, unit: str) -> str:
        command = AmplitudeFormat.rows[unit].command
        return meter.talk.query(f"{command}?", lambda text: self.allowed.read(f"{command} {text}"))


class KeysightLcrMeter(LcrDialect, KeysightMeter):
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
    sweeps = True
    amplitude = AmplitudeSetting()
    speed = SettingPart(LcrDialect.aperture, 0, "Speed")
    averaging = SettingPart(LcrDialect.aperture, 1, "Readings averaged")
    _listed: tuple[float, ...] = ()

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
        """Approximate time of a reading, s."""
        one = seconds_of(cls.seconds_at, timing["aperture"], timing["frequency"])
        return one + timing["trigger_delay"] + timing.get("step_delay", 0.0)

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
        status = self.talk.query(f"{self.condition}?", int, seconds=CORRECTION_SECONDS)
        return not status & CORRECTING


def seconds_of(
    seconds_at: Mapping[str, Sequence[tuple[float, float]]],
    aperture: tuple[str, int],
    frequency: float,
) -> float:
    """Time of a measurement, s. seconds_at: of a dialect. aperture: speed and averaging.

    The time at a frequency in Hz is straight in logarithms between those of the table.
    """
    known, seconds = np.log(np.array(seconds_at[aperture[0]]).T)
    return aperture[1] * float(np.exp(np.interp(np.log(frequency), known, seconds)))


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


class E4980A(KeysightLcrMeter):
    """20 Hz to 2 MHz, which it sets with four digits."""

    model = "E4980A"
    settable = (*KeysightLcrMeter.settable, "step_delay")
    timing = (*KeysightLcrMeter.timing, "step_delay")
    delays = ("trigger_delay", "step_delay")


class E4980AL(E4980ALDialect, E4980A):
    """20 Hz to 300 kHz, 500 kHz or 1 MHz, by its option."""

    model = "E4980AL"


class HP4284A(HP4284ADialect, KeysightLcrMeter):
    """20 Hz to 1 MHz, of which it has 8610 frequencies."""

    model = "4284A"


KEYSIGHT_LCR = (E4980A, E4980AL, HP4284A)
"""Classes of the three models."""

"""Hioki's LCR meters IM3523, IM3533, IM3536 and IM3570: dialects of one command language."""

from __future__ import annotations

import logging
from contextlib import suppress
from typing import Any, ClassVar, Self

from ...simulator.sweeps.meter_bands import METER_BANDS
from .accuracy_table import ReadingConditions
from .connection import Connection, connect
from .conversation import Conversation
from .errors import (
    GarbledError,
    LostConnectionError,
    MeterError,
    NoConnectionError,
    WrongMeterError,
)
from .meter_identity import MODELS, MeterIdentity, parse_identity
from .meter_reading import MeterReading, parse_reading
from .original_settings import SETTINGS_STORE, not_restored_message, restore_original
from .setting import (
    IntegerFormat,
    MeterProperty,
    NumberFormat,
    OnOffFormat,
    RegisterFormat,
    Setting,
    WordFormat,
)

SPEEDS = ("FAST", "MEDium", "SLOW", "SLOW2")
CORRECTIONS = ("OFF", "ALL", "SPOT")
CP_RS_X = 16, 18
STATUS_AND_VALUES = 18
READ = "*TRG;:MEASure?"
ROUNDING = 6e-5
"""Relative rounding of frequencies, which a meter sets with five digits."""
SEARCHES = 3
"""Measurements that one reading may take with automatic range."""
TIMING = ("frequency", "speed", "averaging", "trigger_delay")
LOG = logging.getLogger(__name__)


class HiokiMeter:
    """Common part of the four models. Each set is followed by a check of the event register.

    Setting a property raises InputError if the value is not allowed, RefusedError if the meter
    refuses it, RestartedError if the meter was switched off and on. Everything may raise
    MeterError.
    """

    model: ClassVar[str]
    frequency: ClassVar[Setting[float]]

    header = Setting(":HEADer", OnOffFormat(), "True if answers begin with the command's name")
    items = Setting(":MEASure:ITEM", RegisterFormat(2), "Quantities of a reading")
    valid = Setting(":MEASure:VALid", IntegerFormat(1, 31), "Parts of a reading")
    mode = Setting(":MODE", WordFormat(("LCR", "CONTinuous")), "Mode of measurement")
    level = Setting(
        ":LEVel",
        WordFormat(("V", "CV", "CC")),
        "Controlled quantity: the open voltage (V), the skin's voltage (CV) or its current (CC)",
    )
    voltage = Setting(":LEVel:VOLTage", NumberFormat("V", 5e-3, 5, 4), "Open voltage, rms, level V")
    constant_voltage = Setting(
        ":LEVel:CVOLTage", NumberFormat("V", 5e-3, 5, 4), "Voltage on the skin, rms, level CV"
    )
    constant_current = Setting(
        ":LEVel:CCURRent",
        NumberFormat("A", 10e-6, 50e-3, 4),
        "Current through the skin, rms, level CC",
    )
    range = Setting(
        ":RANGe",
        IntegerFormat(1, 10),
        "Range, 100 mohm x 10^(range - 1) full scale; ends automatic choice",
        moves="auto_range",
    )
    auto_range = Setting(
        ":RANGe:AUTO", OnOffFormat(), "True if the meter chooses the range", moves="range"
    )
    trigger = Setting(
        ":TRIGger",
        WordFormat(("INTernal", "EXTernal")),
        "Source of the trigger: the meter itself, or *TRG",
    )
    cable = Setting(":CORRection:CABLe", IntegerFormat(0, 1), "Length of the cable, m")
    load_correction = Setting(
        ":CORRection:LOAD", OnOffFormat(), "True if load correction is applied"
    )
    open_correction = MeterProperty(
        ":CORRection:OPEN?", WordFormat(CORRECTIONS), "Open correction in use"
    )
    short_correction = MeterProperty(
        ":CORRection:SHORt?", WordFormat(CORRECTIONS), "Short correction in use"
    )

    def __init__(self, connection: Connection, identity: MeterIdentity | None = None) -> None:
        self.talk = Conversation(connection)
        self.identity = identity or self.talk.query("*IDN?", parse_identity)
        self.original: dict[str, Any] | None = None
        self.cached: dict[str, Any] = {}
        self._store = SETTINGS_STORE.get()

    def save_original(self) -> None:
        """Save the original settings, if there is a store."""
        if self._store:
            self._store.save_original()

    def prepare(self) -> None:
        """Set the meter up so that each reading is new and holds status, Cp, Rs and X.

        From now on `original` collects the original value of each setting that changes. Range,
        level, speed and correction do not change. Raises MeterError.
        """
        if self.original is None:
            self.original = self._store.original_settings(self.identity) if self._store else {}
        self.talk.send("*CLS")
        self.header, self.mode, self.trigger = False, "LCR", "EXTERNAL"
        self.items, self.valid = CP_RS_X, STATUS_AND_VALUES

    def restore_original(self) -> None:
        """Restore all changed settings, see `original_settings`."""
        restore_original(self)

    def release(self) -> None:
        """Restore the settings, log those not confirmed, and close.

        A store restores them itself.
        """
        try:
            if self._store is None:
                with suppress(MeterError):
                    self.restore_original()
                if self.original:
                    LOG.warning("%s: %s", self.talk.resource, not_restored_message(self.original))
        finally:
            self.close()

    def read(self) -> MeterReading:
        """Reading that this call triggered, never an older one.

        After `prepare`, the time-out grows with speed, averaging and delay. Raises
        FailedReadingError if the meter reports a failure, RefusedError if the meter refused the
        trigger (its answer would be stale), RestartedError, or another MeterError.
        """
        return self.talk.query_checked(READ, parse_reading, self._max_seconds)

    def read_at(self, frequency: float) -> MeterReading:
        """Reading at a frequency in Hz, in two exchanges.

        The meter rounds a frequency to five digits, and reports it with the reading. Raises
        InputError if the model does not reach the frequency, GarbledError if the meter is at
        another one, and the errors of `read`.
        """
        self.frequency = frequency
        query = f"{READ};{type(self).frequency.query}"
        reading, reported = self.talk.query_checked(query, self._reading_at, self._max_seconds)
        if abs(reported / frequency - 1) > ROUNDING:
            raise GarbledError(
                f"{self.talk.resource}: the meter is at {reported:g} Hz instead of "
                f"{frequency:g} Hz; check that nothing else sets it"
            )
        return reading

    def _reading_at(self, answer: str) -> tuple[MeterReading, float]:
        reading, _, reported = answer.rpartition(";")
        return parse_reading(reading), type(self).frequency.allowed.read(reported.strip())

    @property
    def _max_seconds(self) -> float:
        """Longest time of a reading after `prepare`, s."""
        return 0.0 if self.original is None else SEARCHES * self.seconds

    @property
    def seconds(self) -> float:
        """Approximate time of a reading with the present settings, s."""
        for name in TIMING:
            if name not in self.cached:
                self.cached[name] = getattr(self, name)
        frequency, speed, averaging, delay = (self.cached[name] for name in TIMING)
        return ReadingConditions(frequency, 1, speed, averaging).seconds + delay

    def close(self) -> None:
        """Close the connection. Closing twice does no harm."""
        self.talk.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.release()


class IM3523(HiokiMeter):
    """40 Hz to 200 kHz. Speed, averaging and delay exist per range and are set equally."""

    model = "IM3523"
    frequency = Setting(":FREQuency", NumberFormat("Hz", *METER_BANDS["IM3523"], 5), "Frequency")
    speed = Setting(":RANGe:SYNC:SPEEd", WordFormat(SPEEDS), "Speed", each_range=True)
    averaging = Setting(
        ":RANGe:SYNC:AVERaging", IntegerFormat(1, 256, "OFF"), "Readings averaged", each_range=True
    )
    trigger_delay = Setting(
        ":RANGe:SYNC:TRIGger:DELay",
        NumberFormat("s", 0, 9.9999, 5),
        "Time from trigger to measurement",
        each_range=True,
    )


class _Sibling(HiokiMeter):
    speed = Setting(":SPEEd", WordFormat(SPEEDS), "Speed")
    averaging = Setting(":AVERaging", IntegerFormat(1, 256, "OFF"), "Readings averaged")
    trigger_delay = Setting(
        ":TRIGger:DELay", NumberFormat("s", 0, 9.9999, 5), "Time from trigger to measurement"
    )


class IM3533(_Sibling):
    """1 mHz to 200 kHz."""

    model = "IM3533"
    frequency = Setting(":FREQuency", NumberFormat("Hz", *METER_BANDS["IM3533"], 5), "Frequency")


class IM3536(_Sibling):
    """4 Hz to 8 MHz, from 10 mV."""

    model = "IM3536"
    frequency = Setting(":FREQuency", NumberFormat("Hz", *METER_BANDS["IM3536"], 5), "Frequency")
    voltage = Setting(
        ":LEVel:VOLTage", NumberFormat("V", 10e-3, 5, 4), "Open voltage, rms, level V"
    )
    constant_voltage = Setting(
        ":LEVel:CVOLTage", NumberFormat("V", 10e-3, 5, 4), "Voltage on the skin, rms, level CV"
    )


class IM3570(_Sibling):
    """4 Hz to 5 MHz."""

    model = "IM3570"
    frequency = Setting(":FREQuency", NumberFormat("Hz", *METER_BANDS["IM3570"], 5), "Frequency")


Meter = IM3523 | IM3533 | IM3536 | IM3570
DIALECTS: dict[str, type[Meter]] = {
    dialect.model: dialect for dialect in (IM3523, IM3533, IM3536, IM3570)
}


def open_meter(resource: str, timeout: float = 5.0, baud_rate: int = 9600) -> Meter:
    """Meter at a VISA resource, of the model that it reports, set up for readings.

    timeout: longest time of an answer, s. Raises InputError if the name is no resource,
    NoConnectionError if nothing answers, WrongMeterError if another instrument answers.
    """
    return start(connect(resource, timeout, baud_rate))


def start(connection: Connection) -> Meter:
    """Meter of a connection, in its dialect and set up. On failure the connection is closed.

    Raises the errors of `open_meter`.
    """
    try:
        identity = identify(connection)
        if not identity.model:
            raise WrongMeterError(
                f"{connection.resource}: {identity.text!r} answers and is none of "
                f"{', '.join(MODELS)}; check the address"
            )
        meter = DIALECTS[identity.model](connection, identity)
    except BaseException:
        connection.close()
        raise
    try:
        meter.prepare()
    except BaseException:
        meter.release()
        raise
    return meter


def identify(connection: Connection) -> MeterIdentity:
    """Identity of the instrument at the other end. Raises NoConnectionError or MeterError."""
    try:
        return Conversation(connection).query("*IDN?", parse_identity)
    except LostConnectionError as error:
        raise NoConnectionError(str(error).replace("is lost", "cannot be made")) from error

"""Registry of instruments: each is known by its model in the answer to `*IDN?`, and found by it."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from itertools import chain

from .conversation import Connection, Conversation, connect, resource_manager
from .errors import LostConnectionError, MeterError, NoConnectionError, WrongMeterError
from .hioki import HIOKI
from .keysight_analyser import E4990A
from .keysight_lcr import KEYSIGHT_LCR
from .lcr_meter import LcrMeter
from .meter_reading import MeterIdentity, parse_identity

INSTRUMENTS: dict[str, type[LcrMeter]] = {
    each.model: each for each in (*HIOKI, *KEYSIGHT_LCR, E4990A)
}
"""Class of each model."""


def open_meter(resource: str, timeout: float = 5.0, baud_rate: int = 9600) -> LcrMeter:
    """Meter at a VISA resource, of the model that it reports, set up for readings.

    timeout: longest time of an answer, s. Raises InputError if the name is no resource,
    NoConnectionError if nothing answers, WrongMeterError if another instrument answers.
    """
    return start(connect(resource, timeout, baud_rate))


def start(connection: Connection) -> LcrMeter:
    """Meter of a connection, of the model that it reports and set up.

    On failure the connection is closed. Raises the errors of `open_meter`.
    """
    try:
        identity = identify(connection)
        if identity.model not in INSTRUMENTS:
            raise WrongMeterError(
                f"{connection.resource}: {identity.text!r} answers and is none of "
                f"{', '.join(INSTRUMENTS)}; check the address"
            )
        meter = INSTRUMENTS[identity.model](connection, identity)
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


def instrument_of(text: str) -> type[LcrMeter]:
    """Class of the instrument that gave this answer to `*IDN?`. Raises WrongMeterError."""
    model = parse_identity(text).model if text.strip(", ") else ""
    if model not in INSTRUMENTS:
        raise WrongMeterError(f"{text!r} is none of {', '.join(INSTRUMENTS)}")
    return INSTRUMENTS[model]


@dataclass(frozen=True)
class ProbeResult:
    """Result of a probe: the identity, or why there is none."""

    identity: MeterIdentity | None
    failure: str = ""


def find_resources() -> list[str]:
    """VISA resources that PyVISA lists: serial ports, GP-IB, and some on the LAN."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        of_backends = [
            resource_manager(each).list_resources("?*::INSTR") for each in ("TCPIP", "GPIB")
        ]
    return sorted({*chain(*of_backends)})


def probe(resource: str, timeout: float, baud_rate: int) -> ProbeResult:
    """Identity of the meter at a resource. Raises InputError if the name is no resource."""
    try:
        connection = connect(resource, timeout, baud_rate)
    except MeterError as error:
        return ProbeResult(None, str(error))
    try:
        return ProbeResult(identify(connection))
    except MeterError as error:
        return ProbeResult(None, str(error))
    finally:
        connection.close()

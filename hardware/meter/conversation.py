"""Conversation with a meter over a VISA resource: every answer belongs to the query before it."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from enum import IntFlag
from time import monotonic
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from ...simulator.sweeps import InputError
from .errors import (
    GarbledError,
    LostConnectionError,
    MeterError,
    NoAnswerError,
    NoConnectionError,
    RefusedError,
    RestartedError,
)
from .meter_reading import MAKERS
from .termination import raise_pending_signal

if TYPE_CHECKING:
    from pyvisa import ResourceManager
    from pyvisa.resources import MessageBasedResource

TERMINATION = "\r\n"
LONGEST_ANSWER = 65536
"""Bytes. A sweep of 402 points has some 16,000."""
PIECE = 128
"""Bytes that are read at a time: the time-out of PyVISA-py begins anew with each byte."""
BAUD_RATES = (9600, 19200, 38400, 57600)
EXAMPLES = (
    "TCPIP0::192.168.1.1::3500::SOCKET, ASRL/dev/ttyACM0::INSTR (Windows: ASRL3::INSTR for COM3), "
    "GPIB0::1::INSTR"
)


class Connection(Protocol):
    """A channel for lines of text to a meter and back."""

    @property
    def resource(self) -> str:
        """Name of the resource, for errors."""
        ...

    def write(self, message: str) -> None:
        """Send one line. Raises LostConnectionError."""
        ...

    def read(self, seconds: float = 0.0) -> str:
        """One line, without its end. seconds: how long it may take beyond the time-out.

        Raises NoAnswerError, GarbledError, LostConnectionError.
        """
        ...

    def close(self) -> None:
        """Close the connection. Closing twice does no harm."""
        ...


CLOSED_ERRORS = (OSError, ValueError, TypeError, AttributeError)
"""Exceptions of a backend whose connection another thread closes at that moment."""


PYVISA_PY_INTERFACES = {"TCPIP", "ASRL"}
"""Interfaces that pyvisa-py opens on every system: sockets and serial ports."""


def resource_manager(interface: str = "") -> ResourceManager:
    """PyVISA's manager with a backend for this interface: pyvisa-py for PYVISA_PY_INTERFACES.

    For other interfaces PyVISA chooses: a vendor's library such as NI-VISA if one is installed,
    else pyvisa-py. PYVISA_LIBRARY of the user overrides both. Raises ValueError or OSError if there
    is no such backend.
    """
    from pyvisa import ResourceManager

    own = interface in PYVISA_PY_INTERFACES and "PYVISA_LIBRARY" not in os.environ
    return ResourceManager("@py" if own else "")


class VisaConnection:
    """A connection through PyVISA."""

    def __init__(self, resource: str, timeout: float, opened: MessageBasedResource) -> None:
        """timeout: longest time of an answer, s."""
        self.resource, self._timeout, self._opened = resource, timeout, opened
        self._waits = 0

    def write(self, message: str) -> None:
        """Send one line. Raises LostConnectionError."""
        from pyvisa.errors import Error

        try:
            self._opened.write(message)
        except (Error, *CLOSED_ERRORS) as error:
            raise self._lost(error) from error

    def read(self, seconds: float = 0.0) -> str:
        """One line, without its end. seconds: how long it may take beyond the time-out.

        Raises NoAnswerError if no whole line comes within the time-out, because the device is
        silent or sends without end, GarbledError if the line is no text, LostConnectionError if the
        connection is lost.
        """
        from pyvisa.constants import StatusCode
        from pyvisa.errors import Error, VisaIOError

        try:
            self._wait(max(1, round(1000 * (self._timeout + seconds))))
            raw, end = b"", monotonic() + self._timeout + seconds
            while not raw.endswith(b"\n"):
                if raw and (monotonic() > end or len(raw) > LONGEST_ANSWER):
                    raise self._endless(self._timeout + seconds)
                raw += self._opened.read_bytes(PIECE, chunk_size=PIECE, break_on_termchar=True)
        except VisaIOError as error:
            if error.error_code != StatusCode.error_timeout:
                raise self._lost(error) from error
            raise self._silent(self._timeout + seconds) from error
        except (Error, *CLOSED_ERRORS) as error:
            raise self._lost(error) from error
        return _text(raw, self.resource)

    def close(self) -> None:
        """Close the connection. Closing twice does no harm."""
        self._opened.close()

    def _wait(self, milliseconds: int) -> None:
        """Set the time-out of the backend, unless it has this value already."""
        if milliseconds != self._waits:
            self._opened.timeout, self._waits = milliseconds, milliseconds

    def _endless(self, waited: float) -> NoAnswerError:
        return NoAnswerError(
            f"{self.resource}: no whole answer within {waited:.3g} s: the device sends without end "
            "and ends no line; check that it is the meter, the baud rate, that its answers end "
            "with LF, and that the time-out is long enough for a long answer"
        )

    def _silent(self, waited: float) -> NoAnswerError:
        return NoAnswerError(
            f"{self.resource}: no whole answer within {waited:.3g} s; check that the meter "
            "is on, that the cable and the port are right, that its answers end with LF, and that "
            "the time-out is long enough for a slow measurement"
        )

    def _lost(self, error: Exception) -> LostConnectionError:
        return LostConnectionError(
            f"{self.resource}: the connection is lost ({error}); check the cable, the meter's "
            "power, and that no other program has the meter"
        )


def connect(resource: str, timeout: float = 5.0, baud_rate: int = 9600) -> VisaConnection:
    """Connection to `resource`, with the meter's terminators in both directions.

    timeout: longest time of an answer, s. baud_rate: for a serial port, one of BAUD_RATES. Raises
    InputError if the name is no VISA resource or a number is out of range, and NoConnectionError if
    the resource cannot be opened.
    """
    interface = _checked_interface(resource, timeout, baud_rate)
    serial: dict[str, Any] = {"baud_rate": baud_rate, "data_bits": 8} if interface == "ASRL" else {}
    milliseconds = max(1, round(1000 * timeout))
    try:
        opened = resource_manager(interface).open_resource(
            resource,
            open_timeout=milliseconds,
            timeout=milliseconds,
            read_termination=TERMINATION,
            write_termination=TERMINATION,
            **serial,
        )
    except Exception as error:
        raise NoConnectionError(
            f"{resource}: cannot be opened ({error}); check the address, the cable, the meter's "
            f"power, and that no other program has the meter{_library_of(interface)}"
        ) from error
    return VisaConnection(resource, timeout, opened)  # pyright: ignore[reportArgumentType]


def _checked_interface(resource: str, timeout: float, baud_rate: int) -> str:
    from pyvisa.rname import InvalidResourceName, parse_resource_name

    if not 0 < timeout <= 3600:
        raise InputError(f"`timeout` must be in (0, 3600] s, got {timeout:g}")
    if baud_rate not in BAUD_RATES:
        allowed = ", ".join(map(str, BAUD_RATES))
        raise InputError(f"`baud` must be one of {allowed}, got {baud_rate}")
    try:
        return parse_resource_name(resource).interface_type
    except InvalidResourceName as error:
        raise InputError(f"{resource!r} is no VISA resource; examples: {EXAMPLES}") from error


def _library_of(interface: str) -> str:
    if interface in PYVISA_PY_INTERFACES:
        return ""
    return f"; {interface} needs NI-VISA or another vendor's library, see `pyvisa-info`"


def _text(raw: bytes, resource: str) -> str:
    try:
        text = raw.decode("ascii")
    except UnicodeDecodeError:
        text = "\0"
    if not (text.endswith("\n") and text.rstrip("\r\n").isprintable()):
        raise GarbledError(
            f"{resource}: the answer is no line of text; check the baud rate, the cable, and that "
            "the port is the meter's"
        )
    return text.rstrip("\r\n")


Answer = TypeVar("Answer")
SYNCHRONIZED = re.compile(rf"\s*\+?(\d{{1,3}});.*\b({'|'.join(MAKERS)})\b.*", re.IGNORECASE)
LATE_ANSWERS = 16
ERRORS = 20
"""Longest queue of errors."""


class Event(IntFlag):
    """Bits of the standard event register `*ESR?`."""

    POWER_ON = 128
    COMMAND = 32
    EXECUTION = 16
    DEVICE = 8
    QUERY = 4
    COMPLETE = 1


REFUSALS = {
    Event.COMMAND: "unknown to this model, or misspelt",
    Event.EXECUTION: "not possible in its present state, or out of range",
    Event.DEVICE: "failed inside the meter",
    Event.QUERY: "its answer was lost",
}


@dataclass
class AnswerTimes:
    """Time of the latest answer (s of `monotonic`) and longest delay of an answer (s).

    The delay does not contain the expected time of a reading.
    """

    at: float = 0.0
    longest: float = 0.0


ANSWER_TIMES = AnswerTimes()
"""Shared by all connections, because a command works with one meter."""


class Conversation:
    """Messages over one connection. After a failure it is resynchronized or closed."""

    def __init__(self, connection: Connection, error_query: str = "") -> None:
        """error_query: takes the oldest error from the meter's queue; empty if it has none."""
        self._connection, self._closed, self._error_query = connection, False, error_query
        self._pending: float | None = None

    @property
    def resource(self) -> str:
        """Name of the meter's resource."""
        return self._connection.resource

    def send(self, message: str, seconds: float = 0.0) -> None:
        """Send a message without an answer, and check that the meter accepted it.

        seconds: time allowed beyond the time-out. Raises RefusedError, RestartedError, or
        MeterError if the connection fails.
        """
        self._check_register(f"{message};*ESR?", message, seconds)

    def check_events(self, message: str) -> None:
        """Raises RefusedError or RestartedError if the event register holds such an event."""
        self._check_register("*ESR?", message)

    def query(
        self, message: str, parse: Callable[[str], Answer], about: str = "", seconds: float = 0.0
    ) -> Answer:
        """Answer to a message, parsed by `parse`, which raises ValueError at nonsense.

        about: name of the message in errors. seconds: time allowed beyond the time-out. Raises
        RefusedError or RestartedError if the event register explains a missing answer (an unknown
        message has none), otherwise NoAnswerError or GarbledError, and LostConnectionError if the
        conversation cannot be resynchronized. An earlier answer that a signal interrupted is never
        taken for this one.
        """
        raise_pending_signal()
        self._require_open()
        if self._pending is not None:
            self._resynchronize(self._pending)
        try:
            answer = self._exchange(message, seconds)
            return self._parsed(message, answer, parse)
        except (NoAnswerError, GarbledError) as failure:
            raise self._failure(self._resynchronize(), about or message) or failure from None
        except LostConnectionError:
            self.close()
            raise

    def query_checked(
        self, message: str, parse: Callable[[str], Answer], seconds: float = 0.0
    ) -> Answer:
        """Like `query`, and checks the event register in the same exchange.

        Raises RefusedError or RestartedError before the answer is parsed, if the register holds
        such an event.
        """

        def checked(answer: str) -> Answer:
            text, _, register = answer.rpartition(";")
            failure = self._failure(_events(register), message)
            if failure:
                raise failure
            return parse(text)

        return self.query(f"{message};*ESR?", checked, message, seconds)

    def close(self) -> None:
        """Close the connection. Closing twice does no harm."""
        if not self._closed:
            self._closed = True
            self._connection.close()

    def _check_register(self, query_text: str, about: str, seconds: float = 0.0) -> None:
        failure = self._failure(self.query(query_text, _events, about, seconds), about)
        if failure:
            raise failure

    def _exchange(self, message: str, seconds: float) -> str:
        begun, self._pending = monotonic(), seconds
        self._connection.write(message)
        answer = self._connection.read(seconds)
        self._pending, ANSWER_TIMES.at = None, monotonic()
        ANSWER_TIMES.longest = max(ANSWER_TIMES.longest, ANSWER_TIMES.at - begun - seconds)
        return answer

    def _parsed(self, message: str, answer: str, parse: Callable[[str], Answer]) -> Answer:
        try:
            return parse(answer)
        except ValueError as error:
            raise GarbledError(
                f"{self.resource}: the answer to {message} was {answer[:60]!r}; check the line, "
                "and that no other program uses the meter"
            ) from error

    def _resynchronize(self, seconds: float = 0.0) -> Event:
        """Event register, read by a query whose answer no earlier query can have.

        seconds: time that the pending answer may take beyond the time-out.
        """
        self._pending = seconds
        try:
            self._connection.write("*ESR?;*IDN?")
            for _ in range(LATE_ANSWERS):
                match = SYNCHRONIZED.fullmatch(self._any_answer(seconds))
                if match:
                    self._pending, ANSWER_TIMES.at = None, monotonic()
                    return _events(match[1])
        except MeterError as failure:
            self.close()
            raise failure from None
        self.close()
        raise LostConnectionError(
            f"{self.resource}: {LATE_ANSWERS} lines came and none is the answer to *ESR?;*IDN?; "
            "the connection was closed: check that the device sends no lines by itself, and that "
            "no other program uses the meter, then connect again"
        )

    def _any_answer(self, seconds: float) -> str:
        try:
            return self._connection.read(seconds)
        except GarbledError:
            return ""

    def _failure(self, found: Event, message: str) -> MeterError | None:
        if Event.POWER_ON in found:
            return RestartedError(
                f"{self.resource}: the meter was switched off and on before {message}; its "
                "settings and corrections are lost; check its power, then set it up again"
            )
        reasons = [reason for event, reason in REFUSALS.items() if event in found]
        if not reasons:
            return None
        reasons += self._queued_errors()
        return RefusedError(
            f"{self.resource}: the meter refused {message} ({'; '.join(reasons)}); check the "
            "value and the model's command list"
        )

    def _queued_errors(self) -> list[str]:
        """Errors in the meter's queue, which is then empty."""
        found: list[str] = []
        if not self._error_query:
            return found
        with suppress(NoAnswerError, GarbledError, ValueError):
            while len(found) < ERRORS:
                error = self._exchange(self._error_query, 0.0).strip()
                if int(error.split(",")[0]) == 0:
                    break
                found.append(error)
        return found

    def _require_open(self) -> None:
        if self._closed:
            raise LostConnectionError(
                f"{self.resource}: the connection was closed after an earlier failure; connect "
                "again"
            )


def _events(text: str) -> Event:
    return Event(int(text) & 0xFF)

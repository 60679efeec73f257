"""Connection to a VISA resource: TCP socket, serial port (USB or RS-232) or GP-IB."""

from __future__ import annotations

import os
from time import monotonic
from typing import TYPE_CHECKING, Any, Protocol

from ....simulator.sweeps import InputError
from ..errors import GarbledError, LostConnectionError, NoAnswerError, NoConnectionError

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

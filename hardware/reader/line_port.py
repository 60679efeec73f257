"""Port of a reader: a serial port or a TCP socket, read in a thread and cut into lines."""

from __future__ import annotations

import re
import selectors
import socket
import time
from collections import deque
from contextlib import suppress
from dataclasses import dataclass
from math import inf
from threading import Condition, Thread
from typing import Protocol

from ...simulator.sweeps import InputError
from ..meter.errors import LostConnectionError, NoConnectionError

SERIAL, TCP = "serial:", "tcp:"
MAX_LINE = 65_536
"""Longest line, bytes: a sweep of 1000 frequencies at several terminals."""
KEPT_LINES = 10_000
"""Lines that wait at most; the oldest are dropped."""
POLL = 0.05
"""Seconds after which a waiting thread looks whether the port was closed."""
ADDRESS = re.compile(r"(?P<host>\[[^\]]+\]|[^:\[\]]+):(?P<port>\d{1,5})")


class _Stream(Protocol):
    """Bytes of a device. `read` gives b"" if none came in POLL seconds, and raises at the end.

    empty: latest moment at which no byte waited, s (perf_counter): what was read later came later.
    """

    empty: float

    def read(self) -> bytes: ...
    def write(self, sent: bytes) -> None: ...
    def close(self) -> None: ...


@dataclass(frozen=True)
class ReceivedLine:
    """One line. text: None if it was too long. Its end came after `since` and before `ended`.

    Both are s (perf_counter). They differ while lines wait in buffers of the system.
    """

    text: str | None
    since: float
    ended: float


def is_line_resource(resource: str) -> bool:
    """True for `serial:PORT` and `tcp:HOST:PORT`."""
    return resource.startswith((SERIAL, TCP))


class LineCutter:
    """Cuts received bytes into lines. Bytes that are no text of ASCII appear as `?`."""

    def __init__(self) -> None:
        self._rest, self._overlong = b"", False

    def feed(self, received: bytes, since: float, ended: float) -> list[ReceivedLine]:
        """Lines that these bytes end, but no empty one. They came between these moments, s."""
        found = []
        *ends, rest = re.split(rb"[\r\n]+", received)
        for part in ends:
            found += [ReceivedLine(text, since, ended) for text in self._texts(self._rest + part)]
            self._rest, self._overlong = b"", False
        self._rest += rest
        if len(self._rest) > MAX_LINE:
            self._rest, self._overlong = b"", True
        return found

    def _texts(self, raw: bytes) -> list[str | None]:
        """The text of a line, as far as it has one."""
        if self._overlong or len(raw) > MAX_LINE:
            return [None]
        text = "".join(chr(byte) if 32 <= byte < 127 else "?" for byte in raw).strip()
        return [text] if text else []


class LinePort:
    """An open port. A thread reads it all the time, so that no line waits in a buffer."""

    def __init__(self, resource: str, stream: _Stream) -> None:
        self.resource, self._stream = resource, stream
        self._lines: deque[ReceivedLine] = deque(maxlen=KEPT_LINES)
        self._arrival, self._failure, self._closed = Condition(), "", False
        self._thread = Thread(target=self._pump, name=f"reader {resource}", daemon=True)
        self._thread.start()

    def next_line(self, deadline: float) -> ReceivedLine | None:
        """The oldest line that waits; None if none comes before the deadline (s, perf_counter).

        Raises LostConnectionError if the port failed.
        """
        with self._arrival:
            while not self._lines:
                self._check_open()
                left = deadline - time.perf_counter()
                if left <= 0:
                    return None
                self._arrival.wait(min(left, 1.0))
            return self._lines.popleft()

    def write(self, text: str) -> None:
        """Send a line. Raises LostConnectionError."""
        try:
            self._stream.write(f"{text}\n".encode("ascii"))
        except Exception as error:  # pyserial's, the system's, and termios.error
            raise self._lost(error) from error

    def close(self) -> None:
        """Close the port. Closing twice does no harm."""
        self._closed = True
        self._thread.join(1.0)
        with suppress(Exception):
            self._stream.close()

    def _pump(self) -> None:
        cutter = LineCutter()
        while not self._closed:
            try:
                received = self._stream.read()
            except Exception as error:  # pyserial's, the system's, and termios.error
                with self._arrival:
                    now = time.perf_counter()
                    self._lines.extend(cutter.feed(b"\n", self._stream.empty, now))
                    self._failure = str(error) or type(error).__name__
                    self._arrival.notify_all()
                return
            if received:
                with self._arrival:
                    now = time.perf_counter()
                    self._lines.extend(cutter.feed(received, self._stream.empty, now))
                    self._arrival.notify_all()

    def _check_open(self) -> None:
        if self._failure or self._closed:
            raise self._lost(self._failure or "it was closed")

    def _lost(self, error: object) -> LostConnectionError:
        return LostConnectionError(
            f"{self.resource}: the connection is lost ({error}); check the cable, the reader's "
            "power, and that no other program has the port"
        )


def open_line_port(resource: str, baud: int, timeout: float) -> LinePort:
    """Port of a resource `serial:PORT` or `tcp:HOST:PORT`. timeout: of connecting, writing, s.

    Raises InputError if the name is no such resource, NoConnectionError if it cannot be opened.
    """
    check_line_resource(resource)
    try:
        if resource.startswith(SERIAL):
            stream: _Stream = _SerialStream(resource.removeprefix(SERIAL), baud, timeout)
        else:
            stream = _TcpStream(*_address(resource), timeout)
    except Exception as error:  # pyserial's, the system's, and termios.error
        raise NoConnectionError(
            f"{resource}: cannot be opened ({error}); check the port or the address, the cable, "
            "the reader's power, and that no other program has the port"
        ) from error
    return LinePort(resource, stream)


def check_line_resource(resource: str) -> None:
    """Raises InputError unless a name that begins with `serial:` or `tcp:` is complete."""
    if resource.startswith(SERIAL):
        if not resource.removeprefix(SERIAL):
            raise InputError(
                f"{resource!r} names no port; examples: serial:/dev/ttyACM0, serial:COM3"
            )
        return
    match = ADDRESS.fullmatch(resource.removeprefix(TCP))
    if not match or not 1 <= int(match["port"]) <= 65535:
        raise InputError(
            f"{resource!r} must be tcp:HOST:PORT with a port in 1..65535; example: "
            "tcp:192.168.1.7:9000"
        )


def _address(resource: str) -> tuple[str, int]:
    host, _, port = resource.removeprefix(TCP).rpartition(":")
    return host.strip("[]"), int(port)


class _SerialStream:
    """A serial port by pyserial."""

    def __init__(self, port: str, baud: int, timeout: float) -> None:
        from serial import Serial

        self._opened = Serial(port, baud, timeout=POLL, write_timeout=timeout)
        self.empty = -inf

    def read(self) -> bytes:
        looked, waiting = time.perf_counter(), self._opened.in_waiting
        if not waiting:
            self.empty = looked
        return self._opened.read(max(1, waiting))

    def write(self, sent: bytes) -> None:
        self._opened.write(sent)

    def close(self) -> None:
        self._opened.close()


class _TcpStream:
    """A TCP connection."""

    def __init__(self, host: str, port: int, timeout: float) -> None:
        self._opened = socket.create_connection((host, port), timeout)
        self._arrivals = selectors.DefaultSelector()
        self._arrivals.register(self._opened, selectors.EVENT_READ)
        self.empty = -inf

    def read(self) -> bytes:
        looked = time.perf_counter()
        if not self._arrivals.select(0):
            self.empty = looked
            if not self._arrivals.select(POLL):
                return b""
        received = self._opened.recv(65_536)
        if not received:
            raise ConnectionError("the reader closed it")
        return received

    def write(self, sent: bytes) -> None:
        self._opened.sendall(sent)

    def close(self) -> None:
        self._arrivals.close()
        self._opened.close()

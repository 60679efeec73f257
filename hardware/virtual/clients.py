"""Clients of a port: lines in, answers out, and a limited number of them."""

from __future__ import annotations

import asyncio
import re
import time
from collections.abc import AsyncIterator, Callable, Coroutine
from contextlib import AsyncExitStack
from dataclasses import dataclass, field
from typing import Any

from ...simulator.sweeps import InputError
from ..event_counter import Report
from ..page.page_connection import WORD

MAX_LINE = 8192
"""Longest line, bytes. A list of 201 frequencies or segments fits."""
END = re.compile(rb"[\r\n]")
METHODS = rb"GET|HEAD|POST|PUT|DELETE|CONNECT|OPTIONS|TRACE|PATCH"
WEB = re.compile(
    rb"(?:\A|[\r\n])[ \t]*"
    rb"(?:\x16\x03|(?:%b)[ \t]|%b:[ \t]|%b[ \t]+(?:/|\*|[a-z]+://|\S*[ \t]HTTP/))"
    % (METHODS, WORD, WORD),
    re.IGNORECASE,
)
"""Start of lines of HTTP (requests by any method, headers) and TLS; never of SCPI or JSON.

Any page in a browser can send such requests to ports of this computer, with lines of its own in
their body (RFC 9112, sections 3 and 5; RFC 8446, section 5.1).
"""


class WebError(Exception):
    """The client speaks HTTP or TLS, so its data is not meant for this port."""


class LineReader:
    """Turns received bytes into whole lines; a line that is too long becomes None."""

    def __init__(self, longest: int = MAX_LINE) -> None:
        self._longest, self._kept, self._overlong = longest, b"", False

    def is_web(self, received: bytes) -> bool:
        """True if these bytes belong to a line of HTTP or TLS, see `WEB`."""
        return WEB.search(self._kept + received) is not None

    def feed(self, received: bytes) -> list[str | None]:
        """Lines that these bytes complete, without empty ones; None for each refused line."""
        *whole, rest = END.split(self._kept + received)
        lines = [self._line(line) for line in whole]
        self._kept = rest
        if len(rest) > self._longest:
            self._kept, self._overlong = b"", True
        return [line for line in lines if line != ""]

    def _line(self, line: bytes) -> str | None:
        refused, self._overlong = self._overlong or len(line) > self._longest, False
        return None if refused else line.decode("ascii", errors="replace").strip()


MAX_CLIENTS = 32
"""Clients of one port. Three such ports stay below 256, the limit of files on macOS."""
BACKLOG = 16
"""Connections that wait to be accepted."""
PATIENCE = 10.0


@dataclass(eq=False)
class Client:
    """One connection. answered: True if it ever took an answer. heard: time of its last data."""

    reader: asyncio.StreamReader
    writer: asyncio.StreamWriter
    answered: bool = False
    heard: float = field(default_factory=time.monotonic)

    def __post_init__(self) -> None:
        self.writer.transport.set_write_buffer_limits(0)  # `say` ends once the system has all bytes

    async def lines(self) -> AsyncIterator[str | None]:
        """Whole lines; None for each that is too long.

        After each line other clients are served. Raises WebError at a line of HTTP or TLS.
        """
        kept = LineReader()
        while received := await self.reader.read(4096):
            self.heard = time.monotonic()
            if kept.is_web(received):
                raise WebError
            for line in kept.feed(received):
                yield line
                await asyncio.sleep(0)

    async def say(self, said: bytes) -> None:
        """Send bytes. Raises OSError or TimeoutError if the client does not take them."""
        self.writer.write(said)
        if self.writer.is_closing() or self.writer.transport.get_write_buffer_size():
            await asyncio.wait_for(self.writer.drain(), PATIENCE)
        self.answered = True

    def leave(self) -> None:
        """End the connection at once."""
        self.writer.transport.abort()


@dataclass
class Clients:
    """Clients of one port, limited in number.

    Beyond MAX_CLIENTS, a client that took no answer or else the longest idle one is disconnected.

    name: of the port. report: takes faults of clients.
    """

    serve: Callable[[Client], Coroutine[Any, Any, None]]
    name: str
    report: Report
    present: list[Client] = field(default_factory=list)

    async def __call__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Serve one client until it leaves or fails."""
        client = Client(reader, writer)
        self._make_room()
        self.present.append(client)
        try:
            await self.serve(client)
        except WebError:
            self.report(
                "clients of HTTP or TLS disconnected",
                f"{self.name}: disconnected a client that speaks HTTP or TLS, such as a page in a "
                "browser",
            )
        except (OSError, TimeoutError, asyncio.CancelledError):
            client.leave()
        finally:
            self.present.remove(client)
            writer.close()

    def close(self) -> None:
        """Disconnect all clients."""
        for client in self.present:
            client.leave()

    def _make_room(self) -> None:
        if len(self.present) >= MAX_CLIENTS:
            min(self.present, key=lambda client: (client.answered, client.heard)).leave()


async def open_port(stack: AsyncExitStack, clients: Clients, host: str, port: int) -> int:
    """Listen until the stack unwinds; returns the port. Raises InputError if it is taken."""
    try:
        server = await asyncio.start_server(clients, host, port, backlog=BACKLOG)
    except (OSError, OverflowError) as error:
        raise InputError(f"port {port} of {host} is not available: {error}") from error
    stack.callback(clients.close)
    stack.callback(server.close)
    return server.sockets[0].getsockname()[1]

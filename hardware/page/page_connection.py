"""Connections to a page's port: limited in number, and accepted only with valid HTTP/1.1."""

from __future__ import annotations

import asyncio
import re
from http import HTTPStatus
from typing import Any

from websockets.asyncio.server import ServerConnection

MAX_HEAD = 8192
"""Bytes of request line and headers. Browsers send under 2 kB without cookies."""
METHODS = (b"GET", b"HEAD")
WORD = rb"[!#$%&'*+.^_`|~0-9A-Za-z-]+"
REQUEST = re.compile(rb"(%b) ([\x21-\x7e]+) HTTP/([0-9])\.([0-9])" % WORD)
HEADER = re.compile(rb"(%b):[ \t]*([\x20-\x7e\x80-\xff\t]*)" % WORD)
LINE, END = b"\r\n", b"\r\n\r\n"
BARE = re.compile(rb"(?<!\r)\n")


def is_decidable(received: bytes) -> bool:
    """True if these first bytes of a connection are a complete head, or surely an invalid one."""
    line, ended, _ = received.partition(LINE)
    return (
        END in received
        or len(received) > MAX_HEAD
        or BARE.search(received) is not None
        or (ended != b"" and _request_refusal(line) is not None)
    )


def refusal_status(head: bytes) -> HTTPStatus | None:
    """Status that refuses a head (up to its empty line); None if the head is accepted.

    Accepted are GET and HEAD without a body, in HTTP/1.1, with one Host (RFC 9112, sections 2 to
    6).
    """
    line, *headers = head.removesuffix(END).split(LINE)
    if len(head) > MAX_HEAD:
        return HTTPStatus.REQUEST_HEADER_FIELDS_TOO_LARGE
    sound = head.endswith(END) and _headers_are_valid(headers)
    return _request_refusal(line) or (None if sound else HTTPStatus.BAD_REQUEST)


def _request_refusal(line: bytes) -> HTTPStatus | None:
    request = REQUEST.fullmatch(line)
    if request is None:
        return HTTPStatus.BAD_REQUEST
    if request[1] not in METHODS:
        return HTTPStatus.METHOD_NOT_ALLOWED
    if (request[3], request[4]) != (b"1", b"1"):
        return HTTPStatus.HTTP_VERSION_NOT_SUPPORTED
    return None if request[2].startswith(b"/") else HTTPStatus.BAD_REQUEST


def _headers_are_valid(lines: list[bytes]) -> bool:
    """True if header lines are well-formed, name one host, and announce no body."""
    matches = [HEADER.fullmatch(line) for line in lines]
    if not all(matches):
        return False
    fields = [(match[1].lower(), match[2].strip()) for match in matches if match]
    bodies = ("transfer-encoding", "content-length")
    promised = {value for name, value in fields if name.decode() in bodies}
    return [name for name, _ in fields].count(b"host") == 1 and promised <= {b"0"}


MAX_CONNECTIONS, MAX_VIEWERS = 32, 16
"""Together with the virtual meter's connections below 256, the limit of files on macOS."""
HEAD_SECONDS = 5.0
"""Longest time until the whole head is there. A browser sends it at once."""
SUBSTITUTE_HEAD = b"GET / HTTP/1.1" + END
"""Replaces a refused head, because the library answers only valid requests with a status."""


class PageConnection(ServerConnection):
    """One connection, counted by a `ConnectionLimit` from its first byte to its last.

    refused: status that refuses its request, or None. bodiless: True for a HEAD request.
    """

    def __init__(self, *given: Any, limit: ConnectionLimit, **named: Any) -> None:
        super().__init__(*given, **named)
        self._limit, self._received = limit, b""
        self._decided = self._ended = self._answered = False
        self.refused: HTTPStatus | None = None
        self.bodiless = False

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Count the connection, and start the time-out of its head."""
        super().connection_made(transport)
        self._limit.admit(self)
        self.loop.call_later(HEAD_SECONDS, self._decide, HTTPStatus.REQUEST_TIMEOUT)

    def connection_lost(self, exc: Exception | None) -> None:
        """Remove the connection from the count."""
        self._limit.remove(self)
        self._decided = True
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Collect the head until it is complete. Data after a refused head is dropped."""
        if not self._decided:
            self._received += data
            if is_decidable(self._received):
                head, end, _ = self._received.partition(END)
                self._decide(refusal_status(head + end))
        elif self.refused is None:
            super().data_received(data)

    def eof_received(self) -> bool | None:
        """Keep the connection open until a pending response is sent."""
        if self._received and not self._decided:
            self._decide(HTTPStatus.BAD_REQUEST)
        if self._decided and not self._answered:
            self._ended = True
            return True
        return super().eof_received()

    def note_answered(self) -> None:
        """Note that the response is being sent; close if the client has sent all."""
        self._answered = True
        if self._ended:
            self.loop.call_soon(self.transport.close)

    def _decide(self, refused: HTTPStatus | None) -> None:
        if self._decided:
            return
        self._decided, self.refused = True, refused
        self.bodiless = self._received.startswith(b"HEAD ")
        request = self._received.removeprefix(b"HEAD").removeprefix(b"GET")
        super().data_received(SUBSTITUTE_HEAD if refused else b"GET" + request)


class ConnectionLimit:
    """Limit of connections. If there are too many, the oldest that is no viewer is closed."""

    def __init__(self) -> None:
        self.connections: dict[PageConnection, None] = {}
        self.viewers: set[ServerConnection] = set()

    @property
    def full(self) -> bool:
        """True if there is no room for another viewer."""
        return len(self.viewers) >= MAX_VIEWERS

    def admit(self, connection: PageConnection) -> None:
        """Count a connection, and close the oldest one if there are too many."""
        if len(self.connections) >= MAX_CONNECTIONS:
            first = next(each for each in self.connections if each not in self.viewers)
            self.remove(first)
            first.transport.abort()
        self.connections[connection] = None

    def remove(self, connection: PageConnection) -> None:
        """Remove a connection from the count."""
        self.connections.pop(connection, None)

    def abort_all(self) -> None:
        """Close all connections at once."""
        for guest in self.connections:
            guest.transport.abort()

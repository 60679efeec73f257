"""Connections to a page's port, never too many: only what is good HTTP/1.1 is heard."""

from __future__ import annotations

import asyncio
from http import HTTPStatus
from typing import Any

from websockets.asyncio.server import ServerConnection

from .request_head import END, is_decidable, refusal_status

MAX_CONNECTIONS, MAX_VIEWERS = 32, 16
"""With those of the virtual meter below the 256 files of a process on macOS."""
HEAD_SECONDS = 5.0
"""In which the whole head must come: a browser sends it at once."""
STAND_IN = b"GET / HTTP/1.1" + END
"""What the library is given for a head that is refused: it answers nothing else by a status."""


class PageConnection(ServerConnection):
    """A connection that the door knows of from its first byte to its last.

    refused: why its request is; None where it is not. bodiless: whether it asked by HEAD.
    """

    def __init__(self, *given: Any, door: ConnectionLimit, **named: Any) -> None:
        super().__init__(*given, **named)
        self._door, self._received = door, b""
        self._decided = self._ended = self._answered = False
        self.refused: HTTPStatus | None = None
        self.bodiless = False

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Has the door make room."""
        super().connection_made(transport)
        self._door.admit(self)
        self.loop.call_later(HEAD_SECONDS, self._decide, HTTPStatus.REQUEST_TIMEOUT)

    def connection_lost(self, exc: Exception | None) -> None:
        """Tells the door."""
        self._door.remove(self)
        self._decided = True
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Keeps the head until it is whole; what follows a refused one is not heard."""
        if not self._decided:
            self._received += data
            if is_decidable(self._received):
                head, end, _ = self._received.partition(END)
                self._decide(refusal_status(head + end))
        elif self.refused is None:
            super().data_received(data)

    def eof_received(self) -> bool | None:
        """Stays open for the answer to a request that is still to be given."""
        if self._received and not self._decided:
            self._decide(HTTPStatus.BAD_REQUEST)
        if self._decided and not self._answered:
            self._ended = True
            return True
        return super().eof_received()

    def note_answered(self) -> None:
        """The answer is being written: where the client said all, nothing else is waited for."""
        self._answered = True
        if self._ended:
            self.loop.call_soon(self.transport.close)

    def _decide(self, refused: HTTPStatus | None) -> None:
        if self._decided:
            return
        self._decided, self.refused = True, refused
        self.bodiless = self._received.startswith(b"HEAD ")
        request = self._received.removeprefix(b"HEAD").removeprefix(b"GET")
        super().data_received(STAND_IN if refused else b"GET" + request)


class ConnectionLimit:
    """Who is there: of too many, the one is put out that is no viewer and came first."""

    def __init__(self) -> None:
        self.connections: dict[PageConnection, None] = {}
        self.viewers: set[ServerConnection] = set()

    @property
    def full(self) -> bool:
        """Whether there are as many viewers as there may be."""
        return len(self.viewers) >= MAX_VIEWERS

    def admit(self, guest: PageConnection) -> None:
        """One more; see the class."""
        if len(self.connections) >= MAX_CONNECTIONS:
            first = next(each for each in self.connections if each not in self.viewers)
            self.remove(first)
            first.transport.abort()
        self.connections[guest] = None

    def remove(self, guest: PageConnection) -> None:
        """One less."""
        self.connections.pop(guest, None)

    def abort_all(self) -> None:
        """Put out everyone, at once."""
        for guest in self.connections:
            guest.transport.abort()

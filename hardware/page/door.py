"""Connections to a page's port, never too many of them, whoever knocks."""

from __future__ import annotations

import asyncio
from typing import Any

from websockets.asyncio.server import ServerConnection

MOST_CONNECTIONS, MOST_VIEWERS = 64, 16


class Door:
    """Who is there: of too many, the one is put out that is no viewer and came first."""

    def __init__(self) -> None:
        self.guests: dict[Guest, None] = {}
        self.viewers: set[ServerConnection] = set()

    @property
    def full(self) -> bool:
        """Whether there are as many viewers as there may be."""
        return len(self.viewers) >= MOST_VIEWERS

    def enter(self, guest: Guest) -> None:
        """One more; see the class."""
        if len(self.guests) >= MOST_CONNECTIONS:
            first = next(each for each in self.guests if each not in self.viewers)
            self.leave(first)
            first.transport.abort()
        self.guests[guest] = None

    def leave(self, guest: Guest) -> None:
        """One less."""
        self.guests.pop(guest, None)

    def clear(self) -> None:
        """Put out everyone, at once."""
        for guest in self.guests:
            guest.transport.abort()


class Guest(ServerConnection):
    """A connection that the door knows of from its first byte to its last."""

    def __init__(self, *given: Any, door: Door, **named: Any) -> None:
        super().__init__(*given, **named)
        self._door = door

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Has the door make room."""
        super().connection_made(transport)
        self._door.enter(self)

    def connection_lost(self, exc: Exception | None) -> None:
        """Tells the door."""
        self._door.leave(self)
        super().connection_lost(exc)

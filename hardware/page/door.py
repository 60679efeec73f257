"""Connections to a page's port, never too many of them, whoever knocks."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from websockets.asyncio.server import ServerConnection

    from .guest import Guest

MOST_CONNECTIONS, MOST_VIEWERS = 32, 16
"""With those of the virtual meter below the 256 files of a process on macOS."""


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

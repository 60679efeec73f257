"""One viewer of a page: it gets the latest frame after each drawn one, and sends presses."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Awaitable, Callable
from typing import TYPE_CHECKING

from ...simulator.sweeps import InputError
from .latest_state import LatestState
from .messages import FrameDrawn, PressRequest, read_message

if TYPE_CHECKING:
    from websockets.asyncio.server import ServerConnection

PressSkin = Callable[[str], Awaitable[str]]
"""Presses a skin and returns the press in its full form. Raises InputError if it is invalid."""
POLICY_VIOLATION = 1008


class Viewer:
    """A viewer's connection, which gets a frame only after it has drawn the one before.

    So a slow viewer skips frames, and no frames pile up. press: None if the page presses nothing.
    """

    def __init__(
        self, socket: ServerConnection, latest: LatestState, press: PressSkin | None
    ) -> None:
        self._socket, self._latest, self._press = socket, latest, press
        self._sent, self._drawn = 0, asyncio.Event()

    async def serve_frames(self) -> None:
        """Send frames until the viewer leaves or sends an invalid message."""
        pushing = asyncio.create_task(self._push())
        try:
            async for said in self._socket:
                await self._handle(read_message(said))
        except ValueError:
            await self._socket.close(POLICY_VIOLATION, "unknown message")
        finally:
            pushing.cancel()
            await asyncio.gather(pushing, return_exceptions=True)

    async def _push(self) -> None:
        while True:
            await self._latest.newer(self._sent)
            self._drawn.clear()
            self._sent, frame = self._latest.number, self._latest.frame
            await self._socket.send(frame)
            await self._drawn.wait()

    async def _handle(self, message: FrameDrawn | PressRequest) -> None:
        if isinstance(message, FrameDrawn):
            if message.frame == self._sent:
                self._drawn.set()
            return
        if self._press is None:
            raise ValueError("this page presses nothing")
        try:
            answer = {"do": "pressed", "press": await self._press(message.press)}
        except InputError as error:
            answer = {"do": "refused", "why": str(error)}
        await self._socket.send(json.dumps(answer))

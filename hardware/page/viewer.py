"""One viewer of a page: the newest frame each time it has drawn the one before, presses back."""

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
"""Presses a skin; the press in its full form. Raises InputError where it is none on it."""
POLICY_VIOLATION = 1008


class Viewer:
    """A connection that is never sent a second frame before it has drawn the first.

    So a slow viewer is left out frames, and none wait for it. press: None where nothing is pressed.
    """

    def __init__(
        self, socket: ServerConnection, board: LatestState, press: PressSkin | None
    ) -> None:
        self._socket, self._board, self._press = socket, board, press
        self._sent, self._drawn = 0, asyncio.Event()

    async def serve_frames(self) -> None:
        """Until the viewer leaves, or says what is no message."""
        pushing = asyncio.create_task(self._push())
        try:
            async for said in self._socket:
                await self._handle(read_message(said))
        except ValueError:
            await self._socket.close(POLICY_VIOLATION, "no message that is known")
        finally:
            pushing.cancel()
            await asyncio.gather(pushing, return_exceptions=True)

    async def _push(self) -> None:
        while True:
            await self._board.newer(self._sent)
            self._drawn.clear()
            self._sent, frame = self._board.number, self._board.frame
            await self._socket.send(frame)
            await self._drawn.wait()

    async def _handle(self, message: FrameDrawn | PressRequest) -> None:
        if isinstance(message, FrameDrawn):
            if message.frame == self._sent:
                self._drawn.set()
            return
        if self._press is None:
            raise ValueError("nothing is pressed here")
        try:
            answer = {"do": "pressed", "press": await self._press(message.press)}
        except InputError as error:
            answer = {"do": "refused", "why": str(error)}
        await self._socket.send(json.dumps(answer))

"""One viewer of a page: it gets the latest frame after each drawn one, and sends presses."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Awaitable, Callable
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter

from ...simulator.sweeps import InputError
from .latest_state import LatestState

if TYPE_CHECKING:
    from websockets.asyncio.server import ServerConnection

MAX_MESSAGE = 1024
"""Longest message, bytes."""


class _Message(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class FrameDrawn(_Message):
    """The viewer has drawn a frame and is ready for the next."""

    do: Literal["seen"]
    frame: Annotated[int, Field(ge=0, le=2**53)]


class PressRequest(_Message):
    """Request to press the skin until the next press."""

    do: Literal["press"]
    press: Annotated[str, Field(max_length=400, pattern=r"^[a-z0-9,:.+() -]+$")]


_MESSAGES: TypeAdapter[FrameDrawn | PressRequest] = TypeAdapter(
    Annotated[FrameDrawn | PressRequest, Field(discriminator="do")]
)


def read_message(text: str | bytes) -> FrameDrawn | PressRequest:
    """Message in a text. Raises ValueError if it is none."""
    if isinstance(text, bytes):
        raise ValueError("a message must be text")
    return _MESSAGES.validate_json(text)


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

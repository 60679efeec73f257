"""Server of a page on the loopback: its document, and a WebSocket for each viewer.

A viewer gets the latest frame after each drawn one, and sends presses.
"""

from __future__ import annotations

import asyncio
import json
import logging
import threading
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator, Mapping
from contextlib import AsyncExitStack, asynccontextmanager, contextmanager
from dataclasses import dataclass, field
from functools import partial
from http import HTTPStatus
from typing import Annotated, Any, Literal
from urllib.parse import urlsplit

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter
from websockets.asyncio.server import Server, ServerConnection, serve
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from ...simulator.sweeps import InputError
from .page_connection import ConnectionLimit, PageConnection
from .page_document import LINK, LOOPBACK, PageAddress, PageDocument


def state_json(state: Mapping[str, Any]) -> str:
    """A state in JSON. Raises ValueError if a number is not finite."""
    return json.dumps(state, separators=(",", ":"), allow_nan=False)


@dataclass
class LatestState:
    """Latest frame, read and written in one event loop. number: from 1; 0 before the first."""

    number: int = 0
    state: str = ""
    _changed: asyncio.Event = field(default_factory=asyncio.Event)

    def post(self, state: str) -> None:
        """Replace the frame. state: in JSON, see `state_json`."""
        self.number, self.state = self.number + 1, state
        changed, self._changed = self._changed, asyncio.Event()
        changed.set()

    @property
    def frame(self) -> str:
        """The frame as sent: its number and state."""
        return f'{{"frame":{self.number},"state":{self.state}}}'

    async def newer(self, number: int) -> None:
        """Wait for a frame after this number."""
        while self.number <= number:
            await self._changed.wait()


INTERVAL = 0.1
"""Seconds between two updates."""


def post_if_changed(latest: LatestState, state: Mapping[str, Any]) -> None:
    """Post a state if it differs from the latest one."""
    text = state_json(state)
    if text != latest.state:
        latest.post(text)


async def keep_updated(latest: LatestState, state: Callable[[], Mapping[str, Any]]) -> None:
    """Keep the latest state up to date until cancelled."""
    while True:
        post_if_changed(latest, state())
        await asyncio.sleep(INTERVAL)


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


BACKLOG = 16
"""Connections that wait to be accepted."""
SENDING_TIMEOUT = 60.0
"""Longest time to send the document of 3 MB, s; a tunnel may be slow."""
CLOSING_TIMEOUT = 0.3
"""Time for viewers to close their connection, s."""
COMMON_HEADERS = {
    "Cache-Control": "no-store",
    "Connection": "close",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
}


class PageServer:
    """One page at one address. press: presses the skin, see `Viewer`."""

    def __init__(
        self, document: PageDocument, latest: LatestState, press: PressSkin | None = None
    ) -> None:
        self._document, self._latest, self._press = document, latest, press
        self._limit, self._address = ConnectionLimit(), PageAddress(0)

    @asynccontextmanager
    async def served(self, port: int = 0) -> AsyncIterator[PageAddress]:
        """Serve while the block runs. Port 0 takes any free port.

        Raises InputError if the port is not available.
        """
        server = await self._listening(port)
        self._address = PageAddress(next(iter(server.sockets)).getsockname()[1])
        try:
            yield self._address
        finally:
            server.close()
            await asyncio.wait(
                [asyncio.ensure_future(server.wait_closed())], timeout=CLOSING_TIMEOUT
            )
            self._limit.abort_all()
            await server.wait_closed()

    async def _listening(self, port: int) -> Server:
        try:
            return await serve(
                self._serve_viewer,
                LOOPBACK,
                port,
                process_request=self._process_request,
                compression=None,
                server_header=None,
                max_size=MAX_MESSAGE,
                max_queue=2,
                open_timeout=SENDING_TIMEOUT,
                backlog=BACKLOG,
                logger=_disabled_logger(),
                create_connection=partial(PageConnection, limit=self._limit),  # type: ignore[arg-type]
            )
        except (OSError, OverflowError) as error:
            raise InputError(f"port {port} of {LOOPBACK} is not available: {error}") from error

    def _process_request(self, connection: ServerConnection, request: Request) -> Response | None:
        """Response to a request; None opens a WebSocket."""
        assert isinstance(connection, PageConnection)
        connection.note_answered()
        response = self._response(connection, request)
        if response is not None and connection.bodiless:
            response.body = b""
        return response

    def _response(self, connection: PageConnection, request: Request) -> Response | None:
        headers = request.headers
        refusal = connection.refused or self._address.refusal_status(
            request.path, headers.get_all("Host"), headers.get_all("Origin")
        )
        link = urlsplit(request.path).path == LINK if refusal is None else False
        if link and connection.bodiless:
            refusal = HTTPStatus.METHOD_NOT_ALLOWED
        elif link and self._limit.full:
            refusal = HTTPStatus.SERVICE_UNAVAILABLE
        if refusal is not None:
            return _response(refusal)
        return None if link else _response(HTTPStatus.OK, *self._document.sent())

    async def _serve_viewer(self, connection: ServerConnection) -> None:
        self._limit.viewers.add(connection)
        try:
            await Viewer(connection, self._latest, self._press).serve_frames()
        finally:
            self._limit.viewers.discard(connection)


def _response(
    status: HTTPStatus, headers: Mapping[str, str] | None = None, body: bytes | None = None
) -> Response:
    text = f"{status} {status.phrase}\n".encode() if body is None else body
    plain = {"Content-Type": "text/plain; charset=utf-8"}
    if status == HTTPStatus.METHOD_NOT_ALLOWED:
        plain["Allow"] = "GET, HEAD"
    named = {"Content-Length": str(len(text)), **COMMON_HEADERS, **(headers or plain)}
    return Response(status, status.phrase, Headers(named), text)


def _disabled_logger() -> logging.Logger:
    """Logger without output: faults of clients are not shown."""
    logger = logging.getLogger("rcskin.page")
    logger.disabled = True
    return logger


Post = Callable[[Mapping[str, Any]], None]


@contextmanager
def serve_in_thread(document: PageDocument, port: int = 0) -> Iterator[tuple[PageAddress, Post]]:
    """Serve a page in a thread while the block runs. Gives its address and a function for states.

    Raises InputError if the port is not available.
    """
    loop, stack = asyncio.new_event_loop(), AsyncExitStack()
    thread = threading.Thread(target=loop.run_forever, name="page", daemon=True)
    thread.start()
    board = LatestState()

    def post(state: Mapping[str, Any]) -> None:
        loop.call_soon_threadsafe(board.post, state_json(state))

    try:
        entered = stack.enter_async_context(PageServer(document, board).served(port))
        yield asyncio.run_coroutine_threadsafe(entered, loop).result(), post
    finally:
        asyncio.run_coroutine_threadsafe(stack.aclose(), loop).result()
        loop.call_soon_threadsafe(loop.stop)
        thread.join()
        loop.close()

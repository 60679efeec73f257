"""Server of a page on the loopback: its document, and a WebSocket for each viewer."""

from __future__ import annotations

import asyncio
import logging
import threading
from collections.abc import AsyncIterator, Callable, Iterator, Mapping
from contextlib import AsyncExitStack, asynccontextmanager, contextmanager
from functools import partial
from http import HTTPStatus
from typing import Any
from urllib.parse import urlsplit

from websockets.asyncio.server import Server, ServerConnection, serve
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from ...simulator.sweeps import InputError
from .latest_state import LatestState, state_json
from .page_address import LINK, LOOPBACK, PageAddress
from .page_connection import ConnectionLimit, PageConnection
from .page_document import PageDocument
from .viewer import MAX_MESSAGE, PressSkin, Viewer

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

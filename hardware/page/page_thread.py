"""Serving of a page in a separate thread."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import AsyncExitStack, contextmanager
from typing import Any

from .latest_state import LatestState, state_json
from .page_address import PageAddress
from .page_document import PageDocument
from .page_server import PageServer

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

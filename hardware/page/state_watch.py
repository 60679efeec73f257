"""A state that changes by itself, looked at now and then."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from typing import Any

from .latest_state import Board, written

EVERY = 0.1
"""Seconds from one look to the next."""


def posted(board: Board, state: Mapping[str, Any]) -> None:
    """Put a state on the board, if it is another one."""
    text = written(state)
    if text != board.state:
        board.post(text)


async def watching(board: Board, state: Callable[[], Mapping[str, Any]]) -> None:
    """Keep the board as the state is, until cancelled."""
    while True:
        posted(board, state())
        await asyncio.sleep(EVERY)

"""A state that changes by itself, looked at now and then."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from typing import Any

from .latest_state import LatestState, state_json

INTERVAL = 0.1
"""Seconds from one look to the next."""


def post_if_changed(board: LatestState, state: Mapping[str, Any]) -> None:
    """Put a state on the board, if it is another one."""
    text = state_json(state)
    if text != board.state:
        board.post(text)


async def keep_updated(board: LatestState, state: Callable[[], Mapping[str, Any]]) -> None:
    """Keep the board as the state is, until cancelled."""
    while True:
        post_if_changed(board, state())
        await asyncio.sleep(INTERVAL)

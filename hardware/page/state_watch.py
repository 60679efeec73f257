"""Regular updates of a page by a state that changes by itself."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Mapping
from typing import Any

from .latest_state import LatestState, state_json

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

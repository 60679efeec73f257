"""Latest state of a page: one frame, which a newer one replaces."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any


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

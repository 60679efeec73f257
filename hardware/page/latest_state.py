"""The newest state of what is shown: one frame, which a newer one replaces."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any


def state_json(state: Mapping[str, Any]) -> str:
    """A state in JSON. Raises ValueError where a number is none."""
    return json.dumps(state, separators=(",", ":"), allow_nan=False)


@dataclass
class LatestState:
    """Read and written in one event loop. number: of the frame, counted from 1; 0 before any."""

    number: int = 0
    state: str = ""
    _changed: asyncio.Event = field(default_factory=asyncio.Event)

    def post(self, state: str) -> None:
        """Replace the frame by one of a state that is written out, see `written`."""
        self.number, self.state = self.number + 1, state
        changed, self._changed = self._changed, asyncio.Event()
        changed.set()

    @property
    def frame(self) -> str:
        """The state with its number, as it is sent."""
        return f'{{"frame":{self.number},"state":{self.state}}}'

    async def newer(self, number: int) -> None:
        """Wait for a frame beyond that of a number."""
        while self.number <= number:
            await self._changed.wait()

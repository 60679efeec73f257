"""Viewers of a served page, as fast and as slow as they like, and what they were sent."""

from __future__ import annotations

import json
import time
from dataclasses import dataclass, field
from threading import Event, Thread

from websockets.sync.client import connect

from .hostile import Target

NEVER = float("inf")
PATIENCE = 10.0
"""Seconds that a viewer may wait for its first frame."""


@dataclass
class Viewer:
    """Draws each frame in so many s. frames: numbers, by when they came (s)."""

    url: str
    slowness: float
    frames: dict[int, float] = field(default_factory=dict)
    longest: float = 0.0
    """s from one frame to the next."""

    def watch(self, stop: Event) -> None:
        """Until it is told to stop."""
        target = Target(self.url)
        with connect(target.link, origin=target.origin, compression=None) as socket:
            latest = time.monotonic()
            while not stop.is_set():
                try:
                    frame = json.loads(socket.recv(timeout=0.2))["frame"]
                except TimeoutError:
                    continue
                now = time.monotonic()
                self.longest, latest = max(self.longest, now - latest), now
                self.frames[frame] = now
                stop.wait(min(self.slowness, 3600))
                socket.send(json.dumps({"do": "seen", "frame": frame}))

    def age(self, other: Viewer) -> float:
        """By how much frames came later than to another viewer, s, at most."""
        both = self.frames.keys() & other.frames.keys()
        return max((self.frames[n] - other.frames[n] for n in both), default=0.0)


class Watching:
    """Viewers in threads of their own while the block runs, from their first frame on."""

    def __init__(self, url: str, *slowness: float) -> None:
        self.viewers = [Viewer(url, each) for each in slowness]
        self._stop = Event()
        self._threads = [
            Thread(target=viewer.watch, args=(self._stop,), daemon=True) for viewer in self.viewers
        ]

    def __enter__(self) -> list[Viewer]:
        for thread in self._threads:
            thread.start()
        end = time.monotonic() + PATIENCE
        while not all(viewer.frames for viewer in self.viewers):
            if time.monotonic() > end:
                raise RuntimeError(f"a viewer was sent no frame in {PATIENCE:g} s")
            time.sleep(0.01)
        return self.viewers

    def __exit__(self, *error: object) -> None:
        self._stop.set()
        for thread in self._threads:
            thread.join()

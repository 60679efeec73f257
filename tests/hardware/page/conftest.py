"""A page that is served, its viewers, and the hostile clients of the benchmark."""

import asyncio
import json
from contextlib import asynccontextmanager

import pytest
from rcskin.benchmarks.live import hostile_clients as hostile
from rcskin.hardware.page.page_document import PageDocument
from rcskin.hardware.page.page_server import LatestState, PageServer, state_json
from rcskin.simulator.sweeps import InputError
from websockets.asyncio.client import connect

DOCUMENT = PageDocument('<title>skin</title><script nonce="STAND-IN">1;</script>', "STAND-IN")


class Served:
    """A page, a board to post on, and what was pressed."""

    def __init__(self):
        self.board, self.pressed, self.address = LatestState(), [], None

    async def press(self, text):
        """1,1 alone is on the skin."""
        if text != "1,1":
            raise InputError(f"press {text!r}: must be 1,1")
        self.pressed.append(text)
        return "1,1:2.0"

    def post(self, **state):
        self.board.post(state_json(state))

    @property
    def target(self):
        return hostile.Target(self.address.url)

    def viewer(self, **more):
        link = self.address.url.replace("http", "ws").replace("/?", "/link?")
        return connect(link, **{"origin": f"http://127.0.0.1:{self.address.port}", **more})


@pytest.fixture
def served():
    """A function that runs a coroutine function of a page that is served meanwhile."""

    @asynccontextmanager
    async def serving(pressable):
        page = Served()
        site = PageServer(DOCUMENT, page.board, page.press if pressable else None)
        async with site.served() as page.address:
            yield page

    def served(act, pressable=True):
        async def run():
            async with serving(pressable) as page:
                return await asyncio.wait_for(act(page), 60)

        return asyncio.run(run())

    return served


async def frame(viewer, *, seen=True):
    """The next frame, told to be drawn."""
    got = json.loads(await viewer.recv())
    if seen:
        await viewer.send(json.dumps({"do": "seen", "frame": got["frame"]}))
    return got


async def said(viewer, message):
    """What a message is answered by, past frames."""
    await viewer.send(json.dumps(message))
    while "frame" in (got := json.loads(await viewer.recv())):
        pass
    return got


@pytest.fixture(name="frame")
def frame_():
    return frame


@pytest.fixture(name="said")
def said_():
    return said

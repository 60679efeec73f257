"""Clients that mean a served page no good, and messages that are none.

Each is drawn from a seed. They know the page's port, and some its token.
"""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable, Iterator
from urllib.parse import parse_qs, urlsplit

import numpy as np
from websockets.asyncio.client import connect
from websockets.exceptions import ConnectionClosed, InvalidHandshake

AT_ONCE = 100
FUZZERS = 4
WAIT = 0.02
"""Seconds that a client stays after its harm is done."""


class Target:
    """A page by its address."""

    def __init__(self, url: str) -> None:
        parts = urlsplit(url)
        assert parts.port is not None
        self.port, self.token = parts.port, parse_qs(parts.query)["token"][0]

    @property
    def origin(self) -> str:
        """Of the page itself."""
        return f"http://127.0.0.1:{self.port}"

    @property
    def link(self) -> str:
        """Where its viewers are linked."""
        return f"ws://127.0.0.1:{self.port}/link?token={self.token}"


def heads(target: Target, random: np.random.Generator) -> Iterator[bytes]:
    """Beginnings of a conversation that are no good ones."""
    host = f"127.0.0.1:{target.port}"
    good = f"GET /link?token={target.token} HTTP/1.1\r\nHost: {host}\r\n"
    upgrade = (
        "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
        "Sec-WebSocket-Key: MDEyMzQ1Njc4OWFiY2RlZg==\r\n"
    )
    while True:
        yield b""
        yield random.bytes(int(random.integers(1, 4096)))
        yield good.encode()[: int(random.integers(1, len(good)))]
        yield b"GET /" + b"a" * 100_000
        yield (good + "X: y\r\n" * 1000).encode()
        yield f"POST /?token={target.token} HTTP/1.1\r\nHost: {host}\r\n\r\n".encode()
        yield f"GET /?token={random.integers(10**9)} HTTP/1.1\r\nHost: {host}\r\n\r\n".encode()
        yield f"GET /?token={target.token} HTTP/1.1\r\nHost: evil.example\r\n\r\n".encode()
        yield f"{good}{upgrade}Origin: http://evil.example\r\n\r\n".encode()
        yield f"{good}{upgrade}\r\n".encode()
        own = f"{good}{upgrade}Origin: {target.origin}\r\n\r\n".encode()
        yield own + random.bytes(500)
        yield own + b"\x81\xff" + (2**62).to_bytes(8, "big") + b"mask"


async def besieged(target: Target, clients: int, random: np.random.Generator) -> None:
    """So many hostile clients, AT_ONCE at a time."""
    drawn = heads(target, random)
    for begun in range(0, clients, AT_ONCE):
        count = min(AT_ONCE, clients - begun)
        await asyncio.gather(*(_knock(target.port, next(drawn)) for _ in range(count)))


async def _knock(port: int, said: bytes) -> None:
    try:
        _, writer = await asyncio.open_connection("127.0.0.1", port)
    except OSError:
        return
    try:
        writer.write(said)
        await asyncio.wait_for(writer.drain(), 10 * WAIT)
        await asyncio.sleep(WAIT)
    except (OSError, TimeoutError):
        pass
    finally:
        writer.transport.abort()


def _text(random: np.random.Generator) -> str:
    return "".join(map(chr, random.integers(32, 0xD7FF, random.integers(1, 200))))


def _cut(random: np.random.Generator) -> str:
    whole = json.dumps({"do": "press", "press": "1,1"})
    return whole[: int(random.integers(len(whole)))]


def _with_more(random: np.random.Generator) -> str:
    return json.dumps({"do": "press", "press": "1,1", _text(random): 1})


def _of_other_kind(random: np.random.Generator) -> str:
    others = [1, None, True, ["1,1"], {"1,1": 1}, 1e308, "", "none;", "1,1\n", "\x00", "1,1" * 400]
    return json.dumps({"do": "press", "press": others[random.integers(len(others))]})


def _not_on_the_skin(random: np.random.Generator) -> str:
    row, column = random.integers(50, 10**6, 2)
    presses = [f"{row},{column}", f"-{row},1", f"{row}", f"disc({row},{column},1)", "rect(", "+++"]
    return json.dumps({"do": "press", "press": presses[random.integers(len(presses))]})


def _no_frame(random: np.random.Generator) -> str:
    others = [-1, 2**60, "1", 1.5, None, [1]]
    return json.dumps({"do": "seen", "frame": others[random.integers(len(others))]})


def _deep(random: np.random.Generator) -> str:
    return "[" * int(random.integers(1, 1000))


def _other(random: np.random.Generator) -> str:
    what = ["select", "misbehave", "quit", "", "__class__", 7][random.integers(6)]
    return json.dumps({"do": what, "press": "1,1", "frame": 1})


def _long(random: np.random.Generator) -> str:
    return "x" * int(random.integers(1025, 20_000))


MESSAGES: tuple[Callable[[np.random.Generator], str | bytes], ...] = (
    _text,
    _cut,
    _with_more,
    _of_other_kind,
    _not_on_the_skin,
    _no_frame,
    _deep,
    _other,
    _long,
    lambda random: random.bytes(int(random.integers(1, 300))),
)


async def fuzzed(target: Target, messages: int, random: np.random.Generator) -> None:
    """So many messages that are none, or press what is not on the skin."""
    drawn = (MESSAGES[random.integers(len(MESSAGES))](random) for _ in range(messages))
    await asyncio.gather(*(_fuzz(target, drawn) for _ in range(FUZZERS)))


async def _fuzz(target: Target, messages: Iterator[str | bytes]) -> None:
    """Says one after the other, on a new line wherever the one before was hung up."""
    socket = None
    for message in messages:
        try:
            socket = socket or await connect(target.link, origin=target.origin, compression=None)
            await socket.send(message)
            while "frame" in json.loads(await socket.recv()):
                pass
        except (ConnectionClosed, InvalidHandshake, OSError):
            socket = None
    if socket is not None:
        await socket.close()

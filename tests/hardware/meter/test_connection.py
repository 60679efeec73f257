"""A line that is let go while somebody waits for an answer."""

import socket
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from threading import Event, Thread

import pytest
from rcskin.hardware.meter.conversation import Conversation, connect
from rcskin.hardware.meter.errors import LostConnectionError, NoAnswerError

SOON, LATE = 0.3, 5.0
"""s."""


@pytest.fixture
def line():
    """To a port that takes calls and never says anything."""
    with socket.create_server(("127.0.0.1", 0)) as silent:
        yield connect(f"TCPIP0::127.0.0.1::{silent.getsockname()[1]}::SOCKET", LATE)


def test_a_reading_while_another_thread_closes_finds_the_line_lost(line):
    with ThreadPoolExecutor(1) as threads:
        reading = threads.submit(line.read)
        time.sleep(SOON)
        line.close()
        with pytest.raises(LostConnectionError, match="the connection is lost"):
            reading.result(LATE + SOON)


def test_a_line_that_was_let_go_is_lost_to_whoever_reads_or_writes(line):
    line.close()
    with pytest.raises(LostConnectionError):
        line.write("*IDN?")
    with pytest.raises(LostConnectionError):
        line.read()


@pytest.fixture
def device():
    """A function that serves a device which sends pieces, a pause before each, until it ends."""
    ended, threads = Event(), []

    def device(piece, pause):
        server = socket.create_server(("127.0.0.1", 0))

        def send():
            with server, server.accept()[0] as line, suppress(OSError):
                while not ended.wait(pause):
                    line.sendall(piece)

        threads.append(Thread(target=send, daemon=True))
        threads[-1].start()
        return connect(f"TCPIP0::127.0.0.1::{server.getsockname()[1]}::SOCKET", SOON)

    yield device
    ended.set()


@pytest.mark.parametrize(
    ("piece", "pause", "error", "text"),
    [
        (b"", 0.1, NoAnswerError, "check that the meter is on"),
        (b"x" * 4096, 0, NoAnswerError, "sends without end and ends no line"),
        (b"\xff\x00", 0.005, NoAnswerError, "sends without end and ends no line"),
        (b"boot\r\n", 0.01, LostConnectionError, "16 lines came and none is the answer"),
    ],
    ids=["silent", "floods", "sends on slowly", "sends lines by itself"],
)
def test_a_device_that_floods_is_told_from_one_that_is_silent(device, piece, pause, error, text):
    line = device(piece, pause)
    with pytest.raises(error, match=text):
        Conversation(line).query(":FREQuency?", float)

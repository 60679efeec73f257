"""A line that is let go while somebody waits for an answer."""

import socket
import time
from concurrent.futures import ThreadPoolExecutor

import pytest
from rcskin.hardware.meter.errors import LostConnectionError
from rcskin.hardware.meter.link.connection import connect

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

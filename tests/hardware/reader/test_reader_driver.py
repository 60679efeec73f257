"""The driver of a reader at sockets and serial lines, whose devices write lines by hand."""

import json
import os
import socket
import sys
import threading
import time
from contextlib import contextmanager

import numpy as np
import pytest
from rcskin.hardware.meter.errors import (
    GarbledError,
    LostConnectionError,
    MeterError,
    NoAnswerError,
    NoConnectionError,
)
from rcskin.hardware.meter.meter_reading import sweep_origin
from rcskin.hardware.reader import line_format, line_port
from rcskin.hardware.reader.line_format import LineFormat
from rcskin.hardware.reader.line_port import check_line_resource, is_line_resource
from rcskin.hardware.reader.reader_driver import ReaderDriver, ReaderTerminals
from rcskin.simulator.sweeps import InputError, inputs
from rcskin.tests.hardware.reader.reader_files import (
    COUNTED,
    FREQUENCIES,
    counted_lines,
    true_value,
)

FORMAT = LineFormat.model_validate(inputs.tables(COUNTED))


class Bench:
    """A device that sends sweeps of the value `sweep`, and keeps what it is sent."""

    def __init__(self, spoil=lambda lines: lines, wait_for_start=False):
        self.sweep, self.spoil, self.received, self.count = 0, spoil, b"", 0
        self.wait_for_start, self.stopped = wait_for_start, threading.Event()

    def run(self, read, write):
        """Send until stopped. read: bytes that wait; write: takes bytes."""
        while not self.stopped.is_set():
            self.received += read()
            if self.wait_for_start and b"go\n" not in self.received:
                time.sleep(0.005)
                continue
            lines = counted_lines(self.sweep, self.count)
            self.count += len(lines)
            for line in self.spoil(lines):
                write(line if isinstance(line, bytes) else f"{line}\r\n".encode())
                time.sleep(0.0005)


@contextmanager
def on_tcp(bench):
    """The resource of a device on TCP; it serves one client after the other."""
    server = socket.create_server(("127.0.0.1", 0))

    def serve():
        while not bench.stopped.is_set():
            try:
                client, _ = server.accept()
            except OSError:
                return
            client.setblocking(False)

            def read(client=client):
                try:
                    return client.recv(4096)
                except BlockingIOError:
                    return b""

            with client:
                try:
                    bench.run(read, client.sendall)
                except OSError:
                    pass

    thread = threading.Thread(target=serve, daemon=True)
    thread.start()
    try:
        yield f"tcp:127.0.0.1:{server.getsockname()[1]}"
    finally:
        bench.stopped.set()
        server.close()


@contextmanager
def on_serial(bench):
    """The resource of a device on a pseudo-terminal."""
    pty, tty = pytest.importorskip("pty"), pytest.importorskip("tty")
    device, port = pty.openpty()
    tty.setraw(port)
    os.set_blocking(device, False)

    def read():
        try:
            return os.read(device, 4096)
        except BlockingIOError:
            return b""

    def write(sent):
        try:
            os.write(device, sent)
        except BlockingIOError:
            pass  # a serial device waits for nobody

    thread = threading.Thread(target=bench.run, args=(read, write), daemon=True)
    thread.start()
    try:
        yield f"serial:{os.ttyname(port)}"
    finally:
        bench.stopped.set()
        thread.join()
        os.close(device)
        os.close(port)


LINES = {"tcp": on_tcp, "serial": on_serial}


@contextmanager
def opened(bench, line="tcp", **more):
    """Reader of a device, its terminals and what it reported."""
    reports, terminals = [], ReaderTerminals(list(FREQUENCIES))
    changed = {name: more.pop(name) for name in list(more) if name in LineFormat.model_fields}
    line_format = FORMAT.model_copy(update=changed)
    with LINES[line](bench) as resource:
        reader = ReaderDriver(
            resource,
            line_format,
            FREQUENCIES,
            terminals,
            **{
                "timeout": 0.5,
                "report": lambda kind, text: reports.append(kind),
                **more,
            },
        )
        try:
            yield reader, terminals, reports
        finally:
            reader.close()


def swept(reader, terminals):
    """Z at both interfaces, ohm."""
    found = {}
    for name, frequencies in FREQUENCIES.items():
        terminals.select(name)
        found[name] = [each.value for each in reader.read_sweep(frequencies)]
    return found


def truth(sweep):
    return {name: [true_value(name, f, sweep) for f in own] for name, own in FREQUENCIES.items()}


@pytest.mark.parametrize("line", LINES)
def test_every_sweep_is_newer_than_its_request(line):
    if line == "serial" and sys.platform == "win32":
        pytest.skip("Windows has no pseudo-terminals")
    bench = Bench()
    with opened(bench, line) as (reader, terminals, reports):
        for number in (0, 3, 7):
            bench.sweep = number
            time.sleep(0.03)  # lines of the press before wait in the buffers
            found = swept(reader, terminals)
            for name, Z in truth(number).items():
                np.testing.assert_allclose(found[name], Z, rtol=1e-12)
    assert reports == []


@pytest.mark.parametrize("line", LINES)
def test_lines_that_waited_in_the_system_are_older_than_the_request(line, monkeypatch):
    """A busy computer reads them late: their arrival is not known, so they are not used."""
    if line == "serial" and sys.platform == "win32":
        pytest.skip("Windows has no pseudo-terminals")
    stream = getattr(line_port, {"tcp": "_TcpStream", "serial": "_SerialStream"}[line])
    idle, read = threading.Event(), stream.read
    monkeypatch.setattr(stream, "read", lambda self: idle.wait() and read(self))
    idle.set()
    bench = Bench()
    with opened(bench, line) as (reader, terminals, _):
        idle.clear()
        time.sleep(0.06)  # lines of the press before wait unread
        bench.sweep = 5
        threading.Timer(0.02, idle.set).start()
        np.testing.assert_allclose(swept(reader, terminals)["left"], truth(5)["left"], rtol=1e-12)


def test_a_live_session_uses_every_sweep():
    """A sweep may begin where the one before ended: nothing is skipped between two requests."""
    bench = Bench()
    seen = []

    def numbered(lines):
        bench.sweep += 1
        return lines

    bench.spoil = numbered
    with opened(bench, follows=True, rate=10) as (reader, terminals, reports):
        for _ in range(6):
            seen.append(swept(reader, terminals)["left"][0].real)
            time.sleep(0.002)
    assert np.diff(seen).tolist() == [10] * 5


def test_start_and_stop_commands_are_sent():
    bench = Bench(wait_for_start=True)
    with opened(bench, start="go", stop="halt") as (reader, terminals, _):
        swept(reader, terminals)
        reader.restore_original()
        time.sleep(0.1)
    assert bench.received == b"go\nhalt\n"


@pytest.mark.parametrize("pause", [0.0, 0.05])
def test_a_device_that_restarts_is_started_again(pause, monkeypatch):
    """Within a sweep, or while nothing was requested."""
    monkeypatch.setattr("rcskin.hardware.reader.reader_driver.START_INTERVAL", 0.0)
    bench = Bench(wait_for_start=True)

    def restart(lines):
        bench.received, bench.count, bench.spoil = b"", 0, lambda lines: lines
        return [*lines[:3], lines[3][:7], "rst: READY"]

    with opened(bench, start="go") as (reader, terminals, reports):
        swept(reader, terminals)
        bench.spoil = restart
        time.sleep(pause)
        np.testing.assert_allclose(swept(reader, terminals)["left"], truth(0)["left"])
        np.testing.assert_allclose(swept(reader, terminals)["left"], truth(0)["left"])
    assert "restarts of the device" in reports and bench.received == b"go\n"


FAILURES = {
    "silent": (lambda lines: [], NoAnswerError, "the reader sends no line"),
    "wrong terminal": (
        lambda lines: [line.replace(",B,", ",C,") for line in lines],
        GarbledError,
        "lines of an unknown terminal; for example: terminal 'C' is none of A, B",
    ),
    "a frequency less": (
        lambda lines: lines[:-1],
        GarbledError,
        "gaps in the count|a sweep lacks 4000 Hz at bottom",
    ),
    "other text": (lambda lines: ["hello"], GarbledError, "'hello' has 1 columns instead of 6"),
    "no line end": (lambda lines: [b"x" * 4096], NoAnswerError, "the reader sends no line"),
    "wrong baud rate": (lambda lines: [b"\xf3\x80\x0a" * 9], GarbledError, "are no readings"),
}


@pytest.mark.parametrize("name", FAILURES)
def test_a_device_that_never_sends_a_sweep_is_one_line_with_what_to_check(name):
    spoil, error, message = FAILURES[name]
    bench = Bench()
    with opened(bench) as (reader, terminals, _):
        bench.spoil = spoil
        time.sleep(0.02)
        with pytest.raises(error, match=message) as failed:
            swept(reader, terminals)
    assert "check" in str(failed.value) and "\n" not in str(failed.value)


def test_a_lost_connection_is_reported():
    bench = Bench()
    with opened(bench) as (reader, terminals, _):
        bench.stopped.set()
        time.sleep(0.05)
        with pytest.raises(LostConnectionError, match="the connection is lost"):
            swept(reader, terminals)


@pytest.mark.parametrize("line", LINES)
@pytest.mark.parametrize("checksum", ["", "crc32"])
def test_the_last_sweep_of_a_device_that_stops_is_read_if_it_has_a_checksum(checksum, line):
    """Nothing follows its last line, so that a number of CSV alone may be cut there."""
    if line == "serial" and sys.platform == "win32":
        pytest.skip("Windows has no pseudo-terminals")
    bench = Bench()

    def signed(lines):
        data = [(each, line_format.checksum(each, checksum)) for each in lines] if checksum else []
        return [f"{each}*{total:08X}" for each, total in data] or lines

    def last(lines):
        bench.spoil = lambda lines: []
        return ["# the next line was measured after this one", *signed(lines)]

    bench.spoil = signed
    with opened(bench, line, checksum=checksum, timeout=1.0) as (reader, terminals, reports):
        bench.spoil = lambda lines: []
        time.sleep(0.05)
        bench.sweep = 3
        threading.Timer(0.25, lambda: setattr(bench, "spoil", last)).start()
        if checksum:
            np.testing.assert_allclose(swept(reader, terminals)["left"], truth(3)["left"])
        else:
            with pytest.raises(NoAnswerError, match="sends no line"):
                swept(reader, terminals)
            assert reports == ["sweeps whose last line no other followed"]


def test_a_port_that_is_not_there_is_reported():
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    for resource in (f"tcp:127.0.0.1:{port}", "serial:/dev/no-such-port"):
        with pytest.raises(NoConnectionError, match="cannot be opened"):
            ReaderDriver(resource, FORMAT, FREQUENCIES)


def test_a_device_that_is_silent_from_the_start_is_reported():
    with pytest.raises(NoAnswerError, match="needs a `start` command"):
        with opened(Bench(wait_for_start=True)):
            pass


@pytest.mark.parametrize(
    "resource", ["serial:", "tcp:", "tcp:host", "tcp:host:0", "tcp:host:70000", "tcp::9000"]
)
def test_an_incomplete_resource_is_refused(resource):
    assert is_line_resource(resource)
    with pytest.raises(InputError):
        check_line_resource(resource)


def test_a_reader_takes_no_settings_and_no_single_frequency():
    with opened(Bench()) as (reader, _, _):
        reader.apply_settings({})
        reader.apply_settings(json.loads(json.dumps(reader.snapshot())))
        with pytest.raises(InputError, match="`rate` of the reader's file is 2000"):
            reader.apply_settings({**reader.snapshot(), "rate": "3"})
        with pytest.raises(MeterError, match="without --adaptive"):
            reader.read_at(1e3)
        assert sweep_origin(reader.identity.text) == "measured"


def test_an_interface_that_the_file_lacks_is_refused():
    with pytest.raises(InputError, match="lacks the interface top"):
        ReaderDriver("tcp:127.0.0.1:9", FORMAT, {"top": (1e3,)})

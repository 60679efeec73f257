"""Access to the virtual meter's ports: crowds, browsers, tokens, and what is reported of them."""

import json
import logging
import os
import socket
import struct

import pytest
from rcskin.hardware.control_client import send_request
from rcskin.hardware.event_counter import counted_events
from rcskin.hardware.meter.instruments import open_meter
from rcskin.hardware.tokens import read_token, token_file
from rcskin.hardware.virtual.clients import MAX_CLIENTS
from rcskin.hardware.virtual.meter_server import run_in_thread
from rcskin.simulator.sweeps import InputError

RESET_ON_CLOSE = struct.pack("ii", 1, 0)
IDENTITY = b"HIOKI,IM3523,000000000,V1.00\r\n"


def control(ports):
    return f"127.0.0.1:{ports.control}"


@pytest.fixture
def crowd(ports):
    """A function that has so many clients say something to the meter, and stay."""
    lines = []

    def crowd(count, *said):
        for _ in range(count):
            line = socket.create_connection(("127.0.0.1", ports.meter))
            lines.append(line)
            for each in said:
                line.sendall(each)
                line.recv(64)

    yield crowd
    for line in lines:
        line.close()


@pytest.mark.parametrize("said", [(), (b"*IDN?\r\n",)], ids=["silent", "once"])
def test_a_crowd_of_idle_clients_does_not_push_out_the_one_at_work(ports, crowd, said):
    with open_meter(ports.resource, 2) as meter:
        for _ in range(4):
            crowd(MAX_CLIENTS // 3, *said)
            assert meter.read().value.real == pytest.approx(10e3)


@pytest.mark.parametrize("text", ["[" * 2040, '{"a":' * 400])
def test_what_is_nested_too_deeply_is_no_request(ports, raw, text):
    request = {"do": "press", "press": "1,1", "token": read_token(ports.control)}
    answer = raw(ports.control, text.encode() + b"\n", json.dumps(request).encode() + b"\n")
    assert b"unknown request" in answer and answer.endswith(b'{"ok": "1,1"}\n')


WITHOUT = b'{"do": "press", "press": "1,1"}\n*RST\n*IDN?\n'
HEADS = [
    b"POST / HTTP/1.1\r\nHost: 127.0.0.1:3501\r\nContent-Type: text/plain\r\n\r\n",
    b"post /x http/1.0\n\n",
    b"\r\nPUT /%0a HTTP/1.1\r\n\r\n",
    b"BREW  http://127.0.0.1:3501/ HTTP/1.1\r\n\r\n",
    b"CONNECT 127.0.0.1:3501 HTTP/1.1\r\n\r\n",
    b"OPTIONS * HTTP/1.1\r\n\r\n",
    b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n",
    b"GET /" + b"a" * 5000 + b" HTTP/1.1\r\n\r\n",
    b"A" * 5000 + b" / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n",
    b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03\n",
]


@pytest.mark.parametrize("which", ["meter", "control"])
@pytest.mark.parametrize("head", HEADS)
def test_what_begins_like_a_page_in_a_browser_is_hung_up(ports, instrument, raw, which, head):
    known = json.dumps({"do": "press", "press": "1,1", "token": read_token(ports.control)})
    instrument.settings.frequency = 2e3
    for pieces in ((head + WITHOUT + known.encode() + b"\n",), (head, WITHOUT)):
        try:
            assert raw(getattr(ports, which), *pieces) == b""
        except OSError:
            pass
    assert (instrument.press, instrument.settings.frequency) == ("none", 2e3)


@pytest.mark.parametrize("token", ["", "x", None, 7, ["x"], "\ud800", "x" * 1000])
@pytest.mark.parametrize("do", ["press", "misbehave", "select", "state"])
def test_a_request_without_the_token_is_refused_and_hung_up(ports, instrument, raw, token, do):
    given = {"press": {"press": "1,1"}, "misbehave": {"kind": "drop"}, "select": {"interface": ""}}
    line = json.dumps({"do": do, "token": token, **given.get(do, {})}).encode() + b"\n"
    answer = raw(ports.control, 2 * line)
    assert b"is not the virtual meter's" in answer and answer.count(b"\n") == 1
    assert instrument.press == "none" and not instrument.faults.waiting


def test_the_token_is_in_a_file_that_only_the_user_reads_while_it_is_served(instrument):
    with run_in_thread(instrument) as ports:
        path = token_file(ports.control)
        assert os.name == "nt" or path.stat().st_mode & 0o077 == 0
        named = f"{path.read_text()}@{control(ports)}"
        path.unlink()
        assert send_request(named, "state")["press"] == "none"
        with pytest.raises(InputError, match="TOKEN@HOST:PORT"):
            send_request(control(ports), "state")
    assert not path.exists()


def test_a_token_that_cannot_be_kept_is_reported_to_the_operator(
    make_instrument, monkeypatch, tmp_path
):
    (tmp_path / "rcskin").touch()
    for name in ("XDG_STATE_HOME", "LOCALAPPDATA"):
        monkeypatch.setenv(name, str(tmp_path))
    said = []
    with run_in_thread(make_instrument(report=lambda kind, text: said.append(text))):
        told = said[0].split("need --control ")[1]
        assert send_request(told, "state")["press"] == "none"


def test_what_clients_cause_is_counted_in_a_line_a_minute(monkeypatch):
    lines, now = [], [0.0]
    monkeypatch.setattr("rcskin.hardware.event_counter.time.monotonic", lambda: now[0])
    with counted_events(lines.append) as report:
        for number in range(1000):
            now[0] = number * 0.1
            report("of a kind", f"number {number}")
        for _ in range(50):
            logging.getLogger("asyncio").error("no more files\nmuch more", exc_info=OSError(24))
    assert lines[:2] == ["number 0", "number 600 (599 more of a kind before)"]
    assert lines[2].startswith("no more files: OSError(24)")
    assert lines[3:] == ["399 more of a kind", "49 more faults of connections"]

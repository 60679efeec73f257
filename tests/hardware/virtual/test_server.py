"""The virtual meter on TCP: hostile clients, bounded lines, its control port, presses in time."""

import random
import socket
import struct

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rcskin.hardware.control_client import send_request
from rcskin.hardware.meter.errors import PressError
from rcskin.hardware.meter.instruments import open_meter
from rcskin.hardware.virtual.clients import MAX_CLIENTS, MAX_LINE, LineReader
from rcskin.hardware.virtual.meter_server import run_in_thread
from rcskin.hardware.virtual.served_skin import VIRTUAL_MODELS
from rcskin.hardware.virtual.serving import press_at_random, press_by_script, read_script
from rcskin.simulator.sweeps import InputError

RESET_ON_CLOSE = struct.pack("ii", 1, 0)
IDENTITY = b"HIOKI,IM3523,000000000,V1.00\r\n"


def control(ports):
    return f"127.0.0.1:{ports.control}"


@pytest.fixture(params=VIRTUAL_MODELS)
def served(request, make_instrument, serve):
    """A virtual instrument of each dialect, and its ports."""
    instrument = make_instrument(kind=VIRTUAL_MODELS[request.param])
    with serve(instrument) as ports:
        yield instrument, ports


def answers(instrument, *said):
    """Bytes of answers of an instrument."""
    return "".join(f"{each}{instrument.line_end}" for each in said).encode()


@pytest.mark.parametrize("end", [b"\r", b"\n", b"\r\n"])
def test_lines_end_with_either_mark_or_both(served, raw, end):
    instrument, ports = served
    sent = b"*IDN?" + end + b"*ESE?" + end
    assert raw(ports.meter, sent) == answers(instrument, instrument.identity, 0)


def test_answers_may_end_with_a_carriage_return_alone(ports, raw):
    assert raw(ports.meter, b":TRANsmit:TERMinator 1\r*ESE?\r") == b"0\r"


def test_a_line_may_come_in_pieces(ports, raw):
    assert raw(ports.meter, b"*I", b"DN", b"?\r", b"\n") == IDENTITY


def test_what_has_no_end_is_no_message(ports, raw):
    assert raw(ports.meter, b"*IDN?") == b""


def test_a_line_that_is_too_long_is_refused_whole_and_the_next_one_heard(served, raw):
    instrument, ports = served
    sent = (b"*CLS\n", b"*IDN?;" * 100_000, b"\n", b"*ESR?\n*IDN?\n")
    assert raw(ports.meter, *sent) == answers(instrument, 32, instrument.identity)


def test_bytes_that_are_no_text_are_a_command_error(served, raw):
    instrument, ports = served
    sent = b"*CLS\n\xff\xfe\x00:FREQ?\n*ESR?\n"
    assert raw(ports.meter, sent) == answers(instrument, 32)


@given(st.lists(st.binary(max_size=40) | st.just(b"\r\n"), max_size=20))
def test_lines_do_not_depend_on_how_they_are_cut(pieces):
    whole, cut = LineReader(30), LineReader(30)
    expected = whole.feed(b"".join(pieces))
    assert [line for piece in pieces for line in cut.feed(piece)] == expected
    assert all(line is None or 0 < len(line) <= 30 for line in expected)


@given(st.lists(st.binary(min_size=1, max_size=5000), max_size=8))
def test_what_is_kept_of_a_line_is_bounded(pieces):
    lines = LineReader()
    for piece in pieces:
        lines.feed(piece)
        assert len(lines._kept) <= MAX_LINE


def _hostile(port, kind, noise):
    with socket.create_connection(("127.0.0.1", port), timeout=5) as line:
        if kind == "rude":
            line.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, RESET_ON_CLOSE)
        sent = {
            "mute": b"",
            "half": b"*TRG;:MEAS",
            "noise": noise,
            "endless": b"A" * 20_000,
            "deaf": b"*IDN?\n" * 50,
            "rude": b":MEASure?\n*OPC?\n",
            "web": b"GET / HTTP/1.1\r\nHost: x\r\n\r\n",
            "wrong": b";;:::\n*TRG?\n:FREQ ,,\n",
        }[kind]
        line.sendall(sent)
        if kind != "rude":
            line.shutdown(socket.SHUT_WR)
            while line.recv(65536):
                pass


KINDS = ("mute", "half", "noise", "endless", "deaf", "rude", "web", "wrong")


def test_a_thousand_bad_clients_do_not_stop_it(ports, meter, pillow):
    dice = random.Random(1)
    for number in range(1000):
        _hostile(ports.meter, KINDS[number % len(KINDS)], dice.randbytes(300))
    meter.prepare()
    meter.frequency = 2e3
    assert meter.read().value.imag == pytest.approx(pillow.impedance("none", 2e3).imag, rel=1e-5)


def test_the_state_of_each_dialect_is_shown(served):
    _, ports = served
    state = send_request(control(ports), "state")
    assert state["frequency"] > 0 and state["trigger"] in ("INT", "INTERNAL") and state["range"]


def test_bad_clients_stop_no_dialect(served, raw):
    instrument, ports = served
    dice = random.Random(1)
    for kind in KINDS * 5:
        _hostile(ports.meter, kind, dice.randbytes(300))
    assert raw(ports.meter, b"*CLS;*IDN?\n") == answers(instrument, instrument.identity)


def test_more_clients_than_it_holds_push_out_the_oldest(ports):
    lines = [socket.create_connection(("127.0.0.1", ports.meter)) for _ in range(MAX_CLIENTS + 9)]
    try:
        lines[-1].settimeout(5)
        lines[-1].sendall(b"*IDN?\n")
        assert lines[-1].recv(100) == IDENTITY
        lines[0].settimeout(5)
        with pytest.raises(ConnectionError):
            if lines[0].recv(100) == b"":
                raise ConnectionError
    finally:
        for line in lines:
            line.close()


def test_bad_clients_of_the_side_door_are_answered_or_ignored(ports, raw):
    for bad in (b"{}\n", b"[1]\n", b"\xff\n", b'{"do": "sing"}\n', b'{"do": "press", "x": 1}\n'):
        assert b'"error"' in raw(ports.control, bad)
    assert b'"error"' in raw(ports.control, b"x" * 100_000 + b"\n")
    assert send_request(control(ports), "state")["press"] == "none"


def test_the_skin_is_pressed_while_it_runs(ports, meter):
    at_rest = meter.read()
    assert send_request(control(ports), "press", press="9,1") == "9,1"
    assert meter.read().shown["Cp"] > at_rest.shown["Cp"]
    send_request(control(ports), "press", press="none")
    assert meter.read() == at_rest


def test_a_press_that_is_none_is_refused_in_one_line(ports):
    with pytest.raises(InputError, match="press 'hard': must be ROW,COLUMN"):
        send_request(control(ports), "press", press="hard")


@pytest.mark.parametrize("address", ["nowhere", "127.0.0.1", "127.0.0.1:99999", ":1"])
def test_addresses_that_are_none_are_refused(address):
    with pytest.raises(InputError, match="`control` must be HOST:PORT"):
        send_request(address, "state")


def test_an_absent_virtual_meter_is_reported_with_what_to_check():
    with pytest.raises(PressError, match="check that `rcskin meter serve` runs"):
        send_request("127.0.0.1:1", "state")


def test_a_script_presses_at_its_times(tmp_path, make_instrument, serve, pillow):
    path = tmp_path / "presses.txt"
    path.write_text("0 none  # at rest\n\n0.02 3,1\n0.04 8,2\n")
    meter = make_instrument()
    with serve(meter, press_by_script(read_script(path, pillow))) as ports:
        seen = _states_until(ports, lambda seen: "8,2" in seen)
    assert [press for press in dict.fromkeys(seen) if press != "none"][-1] == "8,2"


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("1 2,3\n0.5 none", r"line 2: times must ascend from 0 to 1e\+06 s, got 0.5"),
        ("inf 1,1", r"line 1: times must ascend from 0 to 1e\+06 s, got inf"),
        ("1 1,1\n1e308 none", r"line 2: times must ascend from 0 to 1e\+06 s, got 1e308"),
        ("-1 none", "line 1: times must ascend"),
        ("nan none", "line 1: times must ascend"),
        ("soon none", "line 1: must be SECONDS PRESS"),
        ("1", "line 1: must be SECONDS PRESS"),
        ("1 hard", "line 1: press 'hard'"),
    ],
)
def test_a_bad_script_is_reported_by_line(tmp_path, pillow, text, told):
    path = tmp_path / "presses.txt"
    path.write_text(text)
    with pytest.raises(InputError, match=told):
        read_script(path, pillow)


def test_random_presses_are_drawn_from_all_pixels(make_instrument, serve):
    pressing = press_at_random(["1,1", "1,2", "2,1", "2,2"], 0.001, np.random.default_rng(1))
    every = {"none", "1,1", "1,2", "2,1", "2,2"}
    with serve(make_instrument(), pressing) as ports:
        seen = _states_until(ports, lambda seen: set(seen) == every)
    assert set(seen) == every


def _states_until(ports, enough):
    seen = []
    for _ in range(5000):
        seen.append(send_request(control(ports), "state")["press"])
        if enough(seen):
            break
    return seen


def test_a_port_that_is_taken_is_reported(instrument, ports, make_instrument):
    with pytest.raises(InputError, match=f"port {ports.meter} of 127.0.0.1 is not available"):
        with run_in_thread(make_instrument(), port=ports.meter):
            pass


def test_it_listens_on_the_loopback_interface_alone(ports):
    assert ports.host == "127.0.0.1"
    with open_meter(ports.resource, 1) as meter:
        assert meter.model == "IM3523"


@pytest.mark.parametrize("host", ["127.0.0.1", "0.0.0.0"])
def test_only_the_port_of_the_meter_listens_where_it_is_asked_to(
    make_instrument, monkeypatch, host
):
    """Its control port stays on the loopback interface."""
    asked, bind = [], socket.socket.bind

    def bind_here(self, address):
        asked.append(address[0])
        bind(self, ("127.0.0.1", address[1]))

    monkeypatch.setattr(socket.socket, "bind", bind_here)
    with run_in_thread(make_instrument(), host=host):
        assert sorted(asked) == sorted([host, "127.0.0.1"])

"""A served page: who is let in, what viewers are sent, and what they may say."""

import asyncio
import json
import re
import socket
from http import HTTPStatus

import pytest
from rcskin.hardware.page.page_connection import MAX_VIEWERS
from rcskin.hardware.page.page_document import PageAddress
from rcskin.hardware.page.page_server import LatestState, PageServer, state_json
from rcskin.simulator.sweeps import InputError
from websockets.exceptions import ConnectionClosed, InvalidStatus

OWN = {"hosts": ["127.0.0.1:8000"], "origins": ["http://127.0.0.1:8000"]}
LATER = 100


async def sent(page, *pieces, end=False):
    """Status and all that the page's port answers to bytes."""
    reader, writer = await asyncio.open_connection("127.0.0.1", page.address.port)
    for piece in pieces:
        writer.write(piece)
        await asyncio.sleep(0.005)
    if end:
        writer.write_eof()
    answer = await asyncio.wait_for(reader.read(), 5)
    writer.close()
    return int(answer.split(b" ", 2)[1]), answer


async def got(page, target=None, **headers):
    """Status, headers and body that the page's port answers to a request."""
    reader, writer = await asyncio.open_connection("127.0.0.1", page.address.port)
    named = {"Host": f"127.0.0.1:{page.address.port}", **headers}
    lines = [f"GET {target or f'/?token={page.address.token}'} HTTP/1.1"]
    lines += [f"{name}: {value}" for name, value in named.items()]
    writer.write(("\r\n".join(lines) + "\r\n\r\n").encode())
    head, _, body = (await reader.read()).decode().partition("\r\n\r\n")
    writer.close()
    status, *fields = head.split("\r\n")
    return int(status.split()[1]), dict(each.split(": ", 1) for each in fields), body


@pytest.mark.parametrize(
    ("target", "changed", "status"),
    [
        ("/?token=T", {}, None),
        ("/link?token=T", {}, None),
        ("/?token=T", {"origins": []}, None),
        ("/?token=T", {"hosts": ["localhost:8000"]}, None),
        ("/link?token=T", {"origins": []}, HTTPStatus.FORBIDDEN),
        ("/link?token=T", {"origins": ["null"]}, HTTPStatus.FORBIDDEN),
        ("/link?token=T", {"origins": ["http://127.0.0.1:8001"]}, HTTPStatus.FORBIDDEN),
        ("/link?token=T", {"origins": 2 * OWN["origins"]}, HTTPStatus.FORBIDDEN),
        ("/?token=T", {"hosts": ["evil.example:8000"]}, HTTPStatus.FORBIDDEN),
        ("/?token=T", {"hosts": []}, HTTPStatus.FORBIDDEN),
        ("/?token=T", {"hosts": 2 * OWN["hosts"]}, HTTPStatus.FORBIDDEN),
        ("/", {}, HTTPStatus.FORBIDDEN),
        ("/?token=t", {}, HTTPStatus.FORBIDDEN),
        ("/?token=T&token=T", {}, HTTPStatus.FORBIDDEN),
        ("/?token=%ff%00%f0", {}, HTTPStatus.FORBIDDEN),
        ("//[/?token=T", {}, HTTPStatus.BAD_REQUEST),
        ("/etc/passwd?token=T", {}, HTTPStatus.NOT_FOUND),
    ],
)
def test_who_is_refused(target, changed, status):
    assert PageAddress(8000, "T").refusal_status(target, **{**OWN, **changed}) == status


@pytest.mark.parametrize(
    ("request_", "status"),
    [
        ("GET {good} HTTP/1.1|{host}||", 200),
        ("HEAD {good} HTTP/1.1|{host}||", 200),
        ("GET {good} HTTP/1.1|{host}|Content-Length: 0||", 200),
        ("HEAD {link} HTTP/1.1|{host}|Origin: {origin}||", 405),
        *((f"{method} {{good}} HTTP/1.1|{{host}}||", 405) for method in ("POST", "get", "BREW")),
        ("POST {good} HTTP/1.1|{host}|Content-Length: 9||{{press}}", 405),
        ("OPTIONS * HTTP/1.1|{host}||", 405),
        ("CONNECT a:1 HTTP/1.1|{host}||", 405),
        *((f"GET {{good}} HTTP/{number}|{{host}}||", 505) for number in ("1.0", "0.9", "2.0")),
        ("GET {good}||", 400),
        ("GET {good} HTTP/1.1 x|{host}||", 400),
        ("GET  {good} HTTP/1.1|{host}||", 400),
        ("GET {good}\0 HTTP/1.1|{host}||", 400),
        ("GET {good}\xe9 HTTP/1.1|{host}||", 400),
        ("GET x{good} HTTP/1.1|{host}||", 400),
        ("GET {good} HTTP/1.1\n{host}\n\n", 400),
        ("GET {good} HTTP/1.1|{host}|no header||", 400),
        ("GET {good} HTTP/1.1|{host}| folded: x||", 400),
        ("GET {good} HTTP/1.1|Host : x|{host}||", 400),
        ("GET {good} HTTP/1.1|X: \1|{host}||", 400),
        ("GET {good} HTTP/1.1||", 400),
        ("GET {good} HTTP/1.1|{host}|{host}||", 400),
        ("GET {good} HTTP/1.1|{host}|Content-Length: 5||hello", 400),
        ("GET {good} HTTP/1.1|{host}|Transfer-Encoding: chunked||", 400),
        ("GET {good} HTTP/1.1|Host: evil.example:80||", 403),
        ("GET {good} HTTP/1.1|{host}|Origin: http://evil.example||", 403),
        ("GET {good} HTTP/1.1|{host}|X: " + "x" * 9000 + "||", 431),
        ("GET {good}" + "x" * 9000, 431),
        ("GET {link} HTTP/1.1|{host}|Origin: {origin}||", 426),
    ],
)
@pytest.mark.parametrize("how", ["whole", "in pieces", "half-closed"])
def test_get_and_head_of_http_1_1_are_answered(served, request_, status, how):
    async def act(page):
        at = f"127.0.0.1:{page.address.port}"
        good = f"/?token={page.address.token}"
        names = {"good": good, "link": f"/link{good[1:]}", "host": f"Host: {at}"}
        text = request_.format(**names, origin=f"http://{at}").replace("|", "\r\n")
        data = text.encode("latin-1")
        pieces = [data[:9], data[9:40], data[40:]] if how == "in pieces" else [data]
        return await sent(page, *pieces, end=how == "half-closed")

    answered, answer = served(act)
    assert answered == status
    head, _, body = answer.partition(b"\r\n\r\n")
    assert (b"<title>" in body) == (status == 200 and request_.startswith("GET"))
    assert (b"Allow: GET, HEAD" in head) == (status == 405)
    assert not request_.startswith("HEAD") or (body == b"" and b"Content-Length: " in head)


def test_a_head_that_comes_slowly_is_not_waited_for(served, monkeypatch):
    monkeypatch.setattr("rcskin.hardware.page.page_connection.HEAD_SECONDS", 0.05)

    async def act(page):
        return await sent(page, b"GET / HTTP/1.1\r\n")

    assert served(act)[0] == 408


def test_every_run_has_a_token_that_is_not_guessed():
    tokens = {PageAddress(1).token for _ in range(100)}
    assert len(tokens) == 100 and min(map(len, tokens)) >= 32
    assert all(token not in repr(PageAddress(1, token)) for token in tokens)


def test_the_document_is_sent_under_a_policy_of_its_own(served):
    async def act(page):
        return await got(page), await got(page)

    nonces = set()
    for status, headers, body in served(act):
        policy = headers["Content-Security-Policy"]
        nonce = re.search(r"script-src 'nonce-([\w-]{20,})'", policy)[1]
        assert status == 200 and "<title>skin</title>" in body
        assert f'<script nonce="{nonce}">' in body
        assert "default-src 'none'" in policy and "unsafe" not in policy
        assert headers["Cache-Control"] == "no-store"
        assert headers["Referrer-Policy"] == "no-referrer"
        nonces.add(nonce)
    assert len(nonces) == 2


def test_without_the_token_nothing_is_reported(served):
    async def act(page):
        answers = [await got(page, "/?token=wrong"), await got(page, Host="evil.example")]
        for more in ({"origin": "http://evil.example"}, {"origin": None}):
            with pytest.raises(InvalidStatus, match="403"):
                await page.viewer(**more)
        return answers

    for status, _, body in served(act):
        assert status == 403 and "skin" not in body


def test_viewers_see_each_state_and_a_late_one_the_newest(served, frame):
    async def act(page):
        async with page.viewer() as first, page.viewer() as second:
            page.post(why="one")
            shown = [await frame(first), await frame(second)]
            page.post(why="two")
            shown += [await frame(first), await frame(second)]
        async with page.viewer() as reloaded:
            return [*shown, await frame(reloaded)]

    shown = [(each["frame"], each["state"]["why"]) for each in served(act)]
    assert shown == [(1, "one"), (1, "one"), (2, "two"), (2, "two"), (2, "two")]


def test_a_slow_viewer_is_left_out_frames_and_then_sees_the_newest(served, frame):
    async def act(page):
        async with page.viewer() as slow, page.viewer() as quick:
            numbers = []
            for number in range(1, LATER + 1):
                page.post(number=number)
                numbers.append((await frame(quick))["frame"])
            first = await frame(slow, seen=False)
            with pytest.raises(TimeoutError):
                await asyncio.wait_for(slow.recv(), 0.05)
            await slow.send(json.dumps({"do": "seen", "frame": first["frame"]}))
            return numbers, first["frame"], (await frame(slow))["state"]["number"]

    numbers, first, then = served(act)
    assert numbers == list(range(1, LATER + 1))
    assert first == 1 and then == LATER


def test_a_press_is_answered(served, said):
    async def act(page):
        async with page.viewer() as viewer:
            fine = await said(viewer, {"do": "press", "press": "1,1"})
            none = await said(viewer, {"do": "press", "press": "9,9"})
        return fine, none, page.pressed

    fine, none, pressed = served(act)
    assert fine == {"do": "pressed", "press": "1,1:2.0"} and pressed == ["1,1"]
    assert none == {"do": "refused", "why": "press '9,9': must be 1,1"}


@pytest.mark.parametrize(
    "message",
    [
        "",
        "{}",
        b'{"do":"seen","frame":1}',
        '{"do":"seen","frame":true}',
        '{"do":"seen","frame":1,"more":1}',
        '{"do":"press","press":"<b>"}',
        '{"do":"press","press":"' + "1" * 500 + '"}',
        '{"do":"press","press":"' + "1" * 5000 + '"}',
    ],
)
def test_whoever_says_what_is_no_message_is_hung_up(served, message):
    async def act(page):
        async with page.viewer() as viewer:
            await viewer.send(message)
            with pytest.raises(ConnectionClosed) as closed:
                await viewer.recv()
        return closed.value.rcvd.code, page.pressed

    code, pressed = served(act)
    assert code == (1009 if len(message) > 1024 else 1008) and not pressed


def test_a_page_that_only_shows_takes_no_press(served):
    async def act(page):
        async with page.viewer() as viewer:
            await viewer.send('{"do":"press","press":"1,1"}')
            with pytest.raises(ConnectionClosed, match="1008"):
                await viewer.recv()

    served(act, pressable=False)


def test_no_more_viewers_than_there_is_room_for(served, frame):
    async def act(page):
        viewers = [await page.viewer() for _ in range(MAX_VIEWERS)]
        with pytest.raises(InvalidStatus, match="503"):
            await page.viewer()
        await viewers.pop().close()
        page.post(why="room")
        async with page.viewer() as viewer:
            shown = await frame(viewer)
        for each in viewers:
            await each.close()
        return shown

    assert served(act)["state"] == {"why": "room"}


def test_a_port_in_use_is_reported(served):
    async def act(page):
        async with PageServer(None, LatestState()).served(page.address.port):
            raise AssertionError("the port was had twice")

    with pytest.raises(InputError, match=r"port \d+ of 127\.0\.0\.1 is not available"):
        served(act)


def test_a_state_without_a_number_is_never_sent():
    with pytest.raises(ValueError, match="JSON"):
        state_json({"Z": float("nan")})


def test_it_ends_though_clients_hang_on(served):
    async def act(page):
        there = "127.0.0.1", page.address.port
        silent = [socket.create_connection(there) for _ in range(3)]
        silent[0].sendall(b"GET / HTTP/1.1\r\n")
        await asyncio.sleep(0.05)
        return silent

    for each in served(act):
        with each:
            assert each.recv(1) == b""
